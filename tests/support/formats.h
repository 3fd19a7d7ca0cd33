// The pixel formats that every build has.
#pragma once

#include "thimble/picture/pixel.h"

namespace thimble::testing {

inline constexpr PixelFormat kFormats[] = {PixelFormat::kMono1, PixelFormat::kGray4, PixelFormat::kGray8,
                                           PixelFormat::kRgb565, PixelFormat::kRgb888};

}  // namespace thimble::testing
