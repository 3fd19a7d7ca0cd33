/// @file picture.h
/// A picture from a file, to compare another one with.
#ifndef THIMBLE_TOOLS_READERS_PICTURE_H
#define THIMBLE_TOOLS_READERS_PICTURE_H

#include <string>

#include "output/image.h"

namespace thimble::tools {

/// A PNG, PPM or PGM as r, g, b, whatever its name. Throws InputError when it is none of them, or when it is
/// not `width_px` x `height_px`: what is not to be compared is not decoded.
Image read_picture(const std::string& path, std::int32_t width_px, std::int32_t height_px);

}  // namespace thimble::tools

#endif
