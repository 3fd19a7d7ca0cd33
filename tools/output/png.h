/// Pictures as PNG (ISO/IEC 15948), 8 bits a channel, and as JPEG (ISO/IEC 10918-1).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace thimble::tools {

/// A whole file. `pixels`: rows from the top without gaps, `channels` bytes a pixel: 3 (r, g, b) or 4 (and
/// alpha). Sides are 1 or more. Throws std::bad_alloc.
std::vector<unsigned char> png_file(std::int32_t width_px, std::int32_t height_px, int channels,
                                    std::span<const std::uint8_t> pixels);

/// The same for a baseline JPEG of 3 channels with a quality of 1 to 100; up to 90 colours have half the resolution.
std::vector<unsigned char> jpeg_file(std::int32_t width_px, std::int32_t height_px,
                                     std::span<const std::uint8_t> pixels, int quality = 90);

}  // namespace thimble::tools
