// Divides several numbers by one, roughly: where an edge crosses the rows of a tile. Internal to src/.
#pragma once

#include "../../base/bits.h"
#include "../../base/wide_arithmetic.h"

namespace thimble::bricks {
namespace {

// Quotients are in 1/2^kCrossingBits.
constexpr int kCrossingBits = 11;

// Divides by `divisor`, at least kLeast, numbers of less than 64 times its size: with the core's divider, or with a
// reciprocal where the core only has products of 64 bits.
//
// With a divider cutting off costs a quotient 1 unit, and its dividend likewise; the divisor keeps 14 bits, which costs
// 2^-13 of the quotient. With a reciprocal cutting off costs 1 unit, and what the divisor loses 2^-14 of the quotient.
template <bool kByDivider>
class EdgeQuotient;

template <>
class EdgeQuotient<true> {
 public:
  [[maybe_unused]] static constexpr int32_t kLeast = 1;
  [[gnu::always_inline]] explicit EdgeQuotient(int32_t divisor) {
    const int high = bits::highest_bit(static_cast<uint32_t>(divisor));
    cut_ = high > 13 ? high - 13 : 0;
    by_ = divisor >> cut_;
  }
  [[gnu::always_inline]] int32_t operator()(int32_t value) const {
    return (cut_ <= kCrossingBits ? value * (1 << (kCrossingBits - cut_)) : value >> (cut_ - kCrossingBits)) /
           by_;
  }

 private:
  int cut_;
  int32_t by_;
};

template <>
class EdgeQuotient<false> {
 public:
  // The least divisor.
  [[maybe_unused]] static constexpr int32_t kLeast = 1 << (kCrossingBits + 1);
  // Two of Newton's steps from a straight line that is wrong by at most 1/17; the divisor is cut to 16 bits.
  [[gnu::always_inline]] explicit EdgeQuotient(int32_t divisor) {
    high_ = bits::highest_bit(static_cast<uint32_t>(divisor));
    const uint32_t by = (static_cast<uint32_t>(divisor) << (30 - high_)) >> 15;
    uint32_t inverse = 92521 - (61681 * by >> 16);  // 2^31 / by
    int32_t rest = static_cast<int32_t>((uint32_t{1} << 31) - by * inverse);
    inverse += static_cast<uint32_t>(static_cast<int32_t>(inverse) * (rest >> 13) >> 18);
    rest = static_cast<int32_t>((uint32_t{1} << 31) - by * inverse);
    reciprocal_ = static_cast<int32_t>(inverse << 15) + (static_cast<int32_t>(inverse) * (rest >> 8) >> 8);
  }
  [[gnu::always_inline]] int32_t operator()(int32_t value) const {
    return static_cast<int32_t>(wide_product(value, reciprocal_) >> 32) >> (high_ - (kCrossingBits + 1));
  }

 private:
  int high_;
  int32_t reciprocal_;  // 2^61 by the divisor, of which bit 30 is the highest
};

}  // namespace
}  // namespace thimble::bricks
