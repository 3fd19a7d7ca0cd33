/// Arguments that nobody means: ends of what a number can say, powers of two and their neighbours, bytes that are
/// too few, damaged views. The tests of this folder call every public function of the core with them, under
/// AddressSanitizer and UndefinedBehaviorSanitizer (the `sanitize` build), and check what a header promises of a
/// call that is refused.
///
/// Deterministic: the seed of a test is in it. A run takes seconds; THIMBLE_MISUSE_SECONDS=3600 runs with other
/// seeds for that long in each test.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "support/scene_under_test.h"
#include "thimble/base/memory.h"
#include "thimble/base/vec.h"

namespace thimble::tests {

class OddValues {
 public:
  explicit OddValues(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  bool one_in(std::uint64_t n) { return bits() % n == 0; }
  /// Any number from low to high, both among them, the ends more often than others.
  std::int64_t between(std::int64_t low, std::int64_t high) {
    switch (bits() % 6) {
      case 0:
        return low;
      case 1:
        return high;
      default:
        return low + static_cast<std::int64_t>(bits() % (static_cast<std::uint64_t>(high - low) + 1));
    }
  }
  std::int32_t between_32(std::int32_t low, std::int32_t high) {
    return static_cast<std::int32_t>(between(low, high));
  }
  /// Any number at all one time in `n`, else one from low to high.
  std::int32_t any_or(std::uint64_t n, std::int32_t low, std::int32_t high) {
    return one_in(n) ? any<std::int32_t>() : between_32(low, high);
  }
  /// Any value of the type: its ends, those of others, zero, powers of two, and what stands beside them.
  template <class T>
  T any() {
    using Limits = std::numeric_limits<T>;
    const auto beside = static_cast<std::uint64_t>(bits() % 3) - 1;
    std::uint64_t value = 0;
    switch (bits() % 8) {
      case 0:
        value = static_cast<std::uint64_t>(Limits::min());
        break;
      case 1:
        value = static_cast<std::uint64_t>(Limits::max());
        break;
      case 2:
        break;
      case 3:
        value = bits() % 16;
        break;
      case 4:
        value = std::uint64_t{1} << bits() % 64;
        break;
      case 5:
        value = 0 - (std::uint64_t{1} << bits() % 64);
        break;
      case 6:
        value = bits() % 5000;
        break;
      default:
        return static_cast<T>(bits() >> bits() % 64);
    }
    return static_cast<T>(value + beside);
  }
  Vec3i any_vector() { return {any<std::int32_t>(), any<std::int32_t>(), any<std::int32_t>()}; }
  Vec3i vector_between(std::int32_t low, std::int32_t high) {
    return {between_32(low, high), between_32(low, high), between_32(low, high)};
  }
  Vec3Q8 any_point() {
    return {Q8::from_raw(any<std::int32_t>()), Q8::from_raw(any<std::int32_t>()),
            Q8::from_raw(any<std::int32_t>())};
  }

 private:
  std::mt19937_64 engine_;
};

/// A size at, about or below what is needed, never above a mebibyte: a need may be terabytes.
inline std::size_t odd_size(OddValues& odd, std::size_t needed) {
  constexpr std::size_t kMost = std::size_t{1} << 20;
  const std::size_t beside = needed + static_cast<std::size_t>(odd.between(0, 4)) - 2;
  const std::size_t size = odd.one_in(8) ? static_cast<std::size_t>(odd.bits() % 4096) : beside;
  return std::min(size, kMost);
}

/// Some bytes changed, or cut off.
inline HeapBytes damaged(OddValues& odd, ConstBytes sound) {
  const std::size_t size = odd.one_in(4) ? odd.bits() % (sound.size + 1) : sound.size;
  HeapBytes bytes(sound.subspan(0, size));
  for (std::uint64_t count = odd.bits() % 8; count > 0 && size > 0; --count) {
    // Headers, at the front, decide most.
    const std::size_t at = odd.one_in(2) ? odd.bits() % size : odd.bits() % std::min<std::size_t>(size, 96);
    bytes.span()[at] = odd.any<std::uint8_t>();
  }
  return bytes;
}

/// Calls `round(odd)` `rounds` times, each with values of its own; longer where THIMBLE_MISUSE_SECONDS says
/// so.
template <class Round>
void misuse(std::uint64_t seed, int rounds, Round round) {
  const char* const given = std::getenv("THIMBLE_MISUSE_SECONDS");
  const double seconds = given == nullptr ? 0 : std::atof(given);
  const auto begin = std::chrono::steady_clock::now();
  const auto goes_on = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < seconds;
  };
  for (std::uint64_t number = 0; number < static_cast<std::uint64_t>(rounds) || goes_on(); ++number) {
    OddValues odd(seed * 1000003 + number);
    round(odd);
  }
}

}  // namespace thimble::tests
