/// Pictures from files: their pixels, and one to compare another with.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "output/image.h"

namespace thimble::tools {

/// Width and height by the header of a PNG, JPEG, PPM or PGM; both 0 where `encoded` is none of them.
std::array<int, 2> picture_size(std::span<const std::uint8_t> encoded);

/// The pixels of such a picture, `channels` bytes each: 3 are r, g, b, and 4 have alpha, too.
/// Decoding takes at most 5 bytes for each byte of four channels, 3 for each of `encoded`, and 1 MB.
/// @param place  what errors call the picture, and a blank; may be empty
/// @throws InputError  it is damaged, or decoding takes more
std::shared_ptr<std::uint8_t> decode_picture(std::span<const std::uint8_t> encoded, int channels,
                                             const std::string& place = "");

/// A PNG, JPEG, PPM or PGM as r, g, b, whatever its name. Throws InputError when it is none of them, or when it is
/// not `width_px` x `height_px`: what is not to be compared is not decoded.
Image read_picture(const std::string& path, std::int32_t width_px, std::int32_t height_px);

}  // namespace thimble::tools
