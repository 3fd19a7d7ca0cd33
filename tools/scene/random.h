/// A small random generator that gives the same numbers on every machine.
///
/// SplitMix64: Guy L. Steele Jr., Doug Lea and Christine H. Flood, "Fast Splittable Pseudorandom Number
/// Generators", OOPSLA 2014, figure 16 (golden-ratio increment; the finaliser is David Stafford's variant 13
/// of MurmurHash3's). 64 bits of state, period 2^64, one addition and two multiplications a number.
#pragma once

#include <stdint.h>

namespace thimble::tools {

class SplitMix64 {
 public:
  explicit constexpr SplitMix64(uint64_t seed) : state_(seed) {}

  /// 64 random bits.
  constexpr uint64_t next() {
    state_ += 0x9E3779B97F4A7C15U;
    uint64_t mixed = state_;
    mixed = (mixed ^ mixed >> 30) * 0xBF58476D1CE4E5B9U;
    mixed = (mixed ^ mixed >> 27) * 0x94D049BB133111EBU;
    return mixed ^ mixed >> 31;
  }
  /// A whole number 0 .. bound - 1, bound 1 .. 2^32: the product's upper half. The bias is below
  /// bound / 2^32.
  constexpr uint32_t below(uint64_t bound) { return static_cast<uint32_t>((next() >> 32) * bound >> 32); }
  /// A whole number low .. high, both included.
  constexpr int32_t between(int32_t low, int32_t high) {
    return low + static_cast<int32_t>(below(static_cast<uint64_t>(high - low) + 1));
  }

 private:
  uint64_t state_;
};

}  // namespace thimble::tools
