/// Moving pictures as YUV4MPEG2, which ffmpeg, mpv and others play: a line of text, then frames of raw
/// planes.
///
/// Greys are stored as they are (Cmono). Colours become Y'CbCr by Rec. 601 in its limited range, one sample a
/// pixel (C444), which rounds them by up to about 2 of 255.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/screen.h"

namespace thimble::host {

/// What stands at the front of a file of such pictures: `frames` of them in so many seconds.
std::string y4m_header(std::int32_t width_px, std::int32_t height_px, bool gray, int frames, int seconds = 1);
/// A frame, for a header with `gray`: `levels` has a byte a pixel.
std::string y4m_gray_frame(const std::vector<std::uint8_t>& levels);
/// A frame, for a header without.
std::string y4m_color_frame(const Picture& picture);

}  // namespace thimble::host
