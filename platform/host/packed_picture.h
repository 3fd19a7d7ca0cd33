/// A picture in a display's own pixel format, as the display holds it, and what its pixels are in 8 bits.
#pragma once

#include <cstdint>
#include <vector>

#include "thimble/picture/pixel.h"

namespace thimble::host {

/// Rows (or pages) from the top, without gaps, row_bytes(format, width_px) each.
struct PackedPicture {
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
  PixelFormat format = PixelFormat::kRgb888;
  std::vector<std::uint8_t> bytes;
};

/// r, g, b of every pixel, 8 bits each: `load_pixel`.
std::vector<std::uint8_t> expand_rgb(const PackedPicture& picture);
/// The same as greys, a byte a pixel, for the formats that are `is_gray`.
std::vector<std::uint8_t> expand_gray(const PackedPicture& picture);

}  // namespace thimble::host
