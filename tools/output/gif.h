/// Films as GIF89a: one palette for all frames, which repeat without end.
///
/// The bytes, after the CompuServe specification of 1990: header and screen (13 bytes), the palette (256 times
/// r, g, b), the NETSCAPE2.0 extension that repeats; for each frame its delay (a graphic control extension),
/// an image descriptor and its pixels, one byte an index, by LZW in blocks of at most 255 bytes; at the end
/// 0x3B. LZW: codes from 9 to 12 bits, lowest bit first; 256 clears the table, 257 ends the frame, new words
/// count from 258; a full table is cleared.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "thimble/picture/pixel.h"

namespace thimble::tools {

using GifPalette = std::array<Rgb8, 256>;

/// What stands in front of the frames. Sides of 1 .. 65,535 pixels.
std::string gif_header(std::int32_t width_px, std::int32_t height_px, const GifPalette& palette);
/// A frame: a palette index for each pixel, row by row from the top; shown for so many hundredths of a second.
std::string gif_frame(std::int32_t width_px, std::int32_t height_px, const std::vector<std::uint8_t>& indices,
                      int hundredths);
/// What stands behind them.
std::string gif_end();

}  // namespace thimble::tools
