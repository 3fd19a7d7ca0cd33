// Where across a face a ray lands. Internal to src/.
#pragma once

#include <stdint.h>

namespace thimble::bricks {
namespace {

// The integer part of `dividend / divisor`, below 256, with the core's divider or without. The divisor is a direction
// along its longest axis, which is not 0.
template <bool kByDivider>
[[gnu::always_inline]] inline uint32_t fraction_of(uint32_t dividend, uint32_t divisor) {
  if (kByDivider) {
    return dividend / divisor;  // NOLINT(clang-analyzer-core.DivideZero)
  }
  uint32_t result = 0;
  divisor <<= 7;
  for (int i = 0; i < 8; ++i) {
    result <<= 1;
    if (dividend >= divisor) {
      dividend -= divisor;
      ++result;
    }
    dividend <<= 1;
  }
  return result;
}

// The place `in / speed` of a voxel's 256, rounded down in the world's own direction: on an axis that is mirrored
// (`flipped`) 256 less the quotient rounded up. `in` is at most 256 * speed, and less on other axes.
template <bool kByDivider>
[[gnu::always_inline]] inline int32_t place_across(uint32_t in, uint32_t speed, bool flipped) {
  if (!flipped) {
    return static_cast<int32_t>(fraction_of<kByDivider>(in, speed));
  }
  return in == 0 ? 256 : 255 - static_cast<int32_t>(fraction_of<kByDivider>(in - 1, speed));
}

}  // namespace
}  // namespace thimble::bricks
