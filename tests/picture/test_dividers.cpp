// Quotients by the core's divider and, as cores without one find them, by sums or products. The mutants' program holds a
// second copy of this file, over their src (tests/mutants/CMakeLists.txt): the host has a divider.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "../../src/picture/bricks/edge_quotient.h"
#include "../../src/picture/bricks/place_across.h"

using namespace thimble;

TEST_CASE("bricks: the place across a face, with a divider and without -> the greatest that is not beyond") {
  const auto check = [](std::uint32_t in, std::uint32_t speed, bool flipped) {
    // In the world's own direction: the greatest `place` with place * speed <= this.
    const std::uint64_t along = flipped ? 256 * std::uint64_t{speed} - in : in;
    for (const std::int32_t place :
         {bricks::place_across<true>(in, speed, flipped), bricks::place_across<false>(in, speed, flipped)}) {
      REQUIRE(place >= 0);
      REQUIRE(place <= 256);
      REQUIRE(static_cast<std::uint64_t>(place) * speed <= along);
      REQUIRE((static_cast<std::uint64_t>(place) + 1) * speed > along);
    }
  };
  for (const std::uint32_t speed : {1U, 2U, 3U, 7U, 128U, 255U, 256U, 257U, 4095U, 65535U, (1U << 20) - 3}) {
    for (std::uint32_t place = 0; place <= 256; ++place) {
      for (std::uint32_t more = 0; more < std::min(speed, 3U); ++more) {
        for (const std::uint32_t in : {place * speed + more, (place + 1) * speed - 1 - more}) {
          CAPTURE(speed);
          CAPTURE(in);
          if (in < 256 * speed) {
            check(in, speed, false);
          }
          if (in <= 256 * speed) {
            check(in, speed, true);
          }
        }
      }
    }
  }
}

TEST_CASE(
    "bricks: where an edge crosses a row, with a divider and without -> 2 units wrong, and 2^-13 of it") {
  const auto check = [](std::int32_t value, std::int32_t divisor) {
    const double exact = std::ldexp(static_cast<double>(value), bricks::kCrossingBits) / divisor;
    const double most = 2 + std::ldexp(std::abs(exact), -13);
    CAPTURE(value);
    CAPTURE(divisor);
    REQUIRE(std::abs(bricks::EdgeQuotient<true>(divisor)(value) - exact) <= most);
    if (divisor >= bricks::EdgeQuotient<false>::kLeast) {
      REQUIRE(std::abs(bricks::EdgeQuotient<false>(divisor)(value) - exact) <= most);
    }
  };
  constexpr std::int64_t kMost = INT32_MAX;
  std::mt19937_64 random(20261126);
  const auto check_divisor = [&](std::int32_t divisor) {
    const std::int64_t limit = std::min(64 * std::int64_t{divisor} - 1, kMost);
    std::uniform_int_distribution<std::int64_t> values(-limit, limit);
    for (const std::int64_t value :
         {std::int64_t{0}, std::int64_t{1}, limit, -limit, values(random), values(random)}) {
      check(static_cast<std::int32_t>(value), divisor);
    }
  };
  for (int bit = 0; bit < 31; ++bit) {
    for (const std::int64_t more : {-2, -1, 0, 1, 2}) {
      const std::int64_t divisor = (std::int64_t{1} << bit) + more;
      check_divisor(static_cast<std::int32_t>(std::clamp(divisor, std::int64_t{1}, kMost)));
    }
    for (int i = 0; i < 2000; ++i) {
      check_divisor(static_cast<std::int32_t>((std::uint64_t{1} << bit) + (random() & ((1U << bit) - 1))));
    }
  }
}
