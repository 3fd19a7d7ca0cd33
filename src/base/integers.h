/// Signs, sizes and limits of 32-bit numbers.
#pragma once

#include <stdint.h>

namespace thimble {

/// |value|; also right for the most negative number.
constexpr uint32_t magnitude_32(int32_t value) {
  return value < 0 ? 0U - static_cast<uint32_t>(value) : static_cast<uint32_t>(value);
}
/// The same for numbers above INT32_MIN, where it stays signed.
constexpr int32_t absolute(int32_t value) {
  return value < 0 ? -value : value;
}
constexpr int32_t lesser(int32_t a, int32_t b) {
  return a < b ? a : b;
}
constexpr int32_t greater(int32_t a, int32_t b) {
  return a > b ? a : b;
}
/// Whether |value| <= limit.
constexpr bool is_within(int32_t value, int32_t limit) {
  return value >= -limit && value <= limit;
}
/// The number of low .. high that is nearest to `value`.
constexpr int32_t clamped(int32_t value, int32_t low, int32_t high) {
  return value < low ? low : value > high ? high : value;
}

}  // namespace thimble
