/// The cotangent of half a field of view, in integers.
///
/// cot x = cos x / (x * (sin x / x)). Both series are even, converge fast for x up to 60 degrees, and stay
/// between 1/2 and 1, so that fixed point loses nothing; the pole at 0 is in the division by x alone, where x
/// is an exact integer. Taylor's series up to x^12: the first term left out is below 2^-43.
#pragma once

#include <stdint.h>

#include "../base/wide_arithmetic.h"
#include "thimble/base/vec.h"

namespace thimble {

/// cot(fov / 2) in 1/2^39 for 1 .. 120 degrees: 0.577 to 114.6, relative error below 2^-28 (tested).
/// Cost: 14 multiplications, two divisions of at most 64 steps.
constexpr uint64_t half_angle_cotangent_q39(Q16 fov_degrees) {
  // 1/k! in 2^-32, for even and for odd k.
  constexpr uint32_t kCosine[] = {2147483648U, 178956971U, 5965232U, 106522U, 1184U, 9U};
  constexpr uint32_t kSine[] = {715827883U, 35791394U, 852176U, 11836U, 108U, 1U};
  constexpr uint32_t kRadianQ54 = 2398762259U;  // pi / (2 * 180 * 2^16)
  constexpr uint32_t kDegreesQ8 = 1922527338U;  // its reciprocal

  const uint32_t angle = static_cast<uint32_t>(fov_degrees.raw);
  const uint64_t radians_q31 = wide_product_u(angle, kRadianQ54) >> 23;      // up to 1.05
  const uint64_t square_q31 = shift_rounded(radians_q31 * radians_q31, 31);  // up to 1.1
  // Horner's rule on alternating series: 1 - z (c0 - z (c1 - ...)). Every bracket is positive, below 2^32,
  // and every product below 2^64.
  uint64_t cosine_q32 = 0;
  uint64_t sine_q32 = 0;
  for (int term = 5; term >= 0; --term) {
    cosine_q32 = kCosine[term] - shift_rounded(square_q31 * cosine_q32, 31);
    sine_q32 = kSine[term] - shift_rounded(square_q31 * sine_q32, 31);
  }
  cosine_q32 = (uint64_t{1} << 32) - shift_rounded(square_q31 * cosine_q32, 31);
  sine_q32 = (uint64_t{1} << 32) - shift_rounded(square_q31 * sine_q32, 31);
  const uint64_t ratio_q31 = divide_rounded(cosine_q32 << 31, sine_q32);  // 0.6 to 1
  return divide_rounded(ratio_q31 * kDegreesQ8, angle);
}

}  // namespace thimble
