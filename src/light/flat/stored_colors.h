// Colours as they are stored, and the dither. Internal to src/.
#pragma once

#include "../../picture/panels.h"
#include "../exposure.h"
#include "thimble/picture/pixel.h"

namespace thimble::lit {
namespace {

// How a colour becomes a format's pixel.
enum class Storing : uint8_t { kGrays, kHalfwords, kBytes, kAny };

Storing storing_of(PixelFormat format) {
  if (format == PixelFormat::kMono1 || format == PixelFormat::kGray4) {
    return Storing::kGrays;
  }
  return format == PixelFormat::kRgb565 || is_format<PixelFormat::kRgb565Be>(format) ||
                 is_format<PixelFormat::kBgr565>(format)
             ? Storing::kHalfwords
         : format == PixelFormat::kGray8 || format == PixelFormat::kRgb888 ? Storing::kBytes
                                                                           : Storing::kAny;
}

// By a pixel's place in the dither: the least rest of a channel, out of kWhite, at which the next step is stored.
struct Thresholds {
  uint16_t at[64];
};
constexpr Thresholds thresholds() {
  Thresholds result{};
  for (int32_t i = 0; i < 64; ++i) {
    result.at[i] = static_cast<uint16_t>(kWhite - (128 - (2 * bayer_rank(i & 7, i >> 3) + 1)) * kWhite / 128);
  }
  return result;
}
constexpr Thresholds kDither = thresholds();
constexpr uint32_t kNoDither = kWhite - 64 * kWhite / 128;

// A colour as it is stored. kGrays: the step below it, and the rest, out of kWhite. kHalfwords: the pixel of the steps
// below it, and each channel's rest. kBytes: the pixel. kAny: the colour itself.
struct FlatInk {
  uint32_t low;
  uint16_t rest[3];
  uint16_t key;
};

}  // namespace
}  // namespace thimble::lit
