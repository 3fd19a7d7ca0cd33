/// The 64-bit products of the tracing path, and the quotients, roots and products of set-up code.
///
/// Products of two 32-bit numbers have a name each, so that one place decides how a chip computes them; as
/// they stand the compiler does: one instruction on most chips, a call of its library on a Cortex-M0.
/// Everything else takes only shifts, additions and these products: a small core has no instruction for more,
/// and the compiler's library for it is large and slow.
///
/// Every loop runs at most 64 times. Results are exact or round to nearest as stated, on magnitudes: callers
/// keep signs apart, which makes mirrored input give mirrored output.
#pragma once

#include <stdint.h>

namespace thimble {

/// a * b, exactly.
constexpr int64_t wide_product(int32_t a, int32_t b) {
  return int64_t{a} * b;
}
constexpr uint64_t wide_product_u(uint32_t a, uint32_t b) {
  return uint64_t{a} * b;
}
/// a * b where one of them has 64 bits, as a camera's step from pixel to pixel, and the other is a count of 32, which a
/// loop widens once; callers know that the product stays below 2^63.
constexpr int64_t wide_multiple(int64_t a, int64_t b) {
  return a * b;
}
/// Whether a * b < c * d, exactly: which of the fractions a / d and c / b is the lesser, for b and d above 0.
constexpr bool is_product_less(int32_t a, int32_t b, int32_t c, int32_t d) {
  return wide_product(a, b) < wide_product(c, d);
}

/// Number of bits up to the highest 1 of `value`; 0 for 0.
constexpr int bit_width(uint64_t value) {
  int width = 0;
  for (int step = 32; step != 0; step >>= 1) {
    if ((value >> step) != 0) {
      value >>= step;
      width += step;
    }
  }
  return width + (value != 0 ? 1 : 0);
}

/// |value|; also right for the most negative number.
constexpr uint64_t magnitude(int64_t value) {
  return value < 0 ? 0U - static_cast<uint64_t>(value) : static_cast<uint64_t>(value);
}

/// `value` (below 2^63) with the sign of `sign`.
constexpr int64_t with_sign_of(int64_t sign, uint64_t value) {
  return sign < 0 ? -static_cast<int64_t>(value) : static_cast<int64_t>(value);
}

/// The integer nearest to value / 2^shift, halves up; `shift` 0 .. 62, `value` at most 2^63.
constexpr uint64_t shift_rounded(uint64_t value, int shift) {
  return shift == 0 ? value : (value + (uint64_t{1} << (shift - 1))) >> shift;
}

/// floor(dividend / divisor), by restoring division: one step a bit of the quotient. `divisor` 1 .. 2^63.
constexpr uint64_t divide(uint64_t dividend, uint64_t divisor) {
  int shift = bit_width(dividend) - bit_width(divisor);
  if (shift < 0) {
    return 0;
  }
  uint64_t quotient = 0;
  divisor <<= shift;
  for (; shift >= 0; --shift) {
    quotient <<= 1;
    if (dividend >= divisor) {
      dividend -= divisor;
      quotient |= 1;
    }
    divisor >>= 1;
  }
  return quotient;
}

/// The integer nearest to dividend / divisor, halves up; the sum of both is below 2^64.
constexpr uint64_t divide_rounded(uint64_t dividend, uint64_t divisor) {
  return divide(dividend + (divisor >> 1), divisor);
}

/// The integer nearest to the square root of `value`, at most 2^32 - 1: for values up to 2^64 - 2^32.
constexpr uint32_t square_root_rounded(uint64_t value) {
  uint64_t root = 0;
  uint64_t bit = uint64_t{1} << 62;
  for (int step = 0; step < 32; ++step) {
    if (value >= root + bit) {
      value -= root + bit;
      root = (root >> 1) + bit;
    } else {
      root >>= 1;
    }
    bit >>= 2;
  }
  // What is left exceeds the root exactly when the true root lies above root + 1/2.
  return static_cast<uint32_t>(value > root ? root + 1 : root);
}

/// The integer nearest to a * b / 2^shift, up to 2^-10 of a unit: `a` below 2^63, `shift` 42 .. 94. The
/// 95-bit product is cut to its upper 63 bits before it is rounded.
constexpr uint64_t multiply_shifted(uint64_t a, uint32_t b, int shift) {
  const uint64_t high = wide_product_u(static_cast<uint32_t>(a >> 32), b);
  const uint64_t low = wide_product_u(static_cast<uint32_t>(a), b);
  return shift_rounded(high + (low >> 32), shift - 32);
}

}  // namespace thimble
