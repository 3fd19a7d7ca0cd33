// The integer optics: what holds exactly, case by case. That every operation keeps to the bound of its header is swept by
// tools/instruments/operation_errors.cpp, which test_hard_cases runs.
//
// THIMBLE_SEED sets the seed of the random sweeps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/ray_cases.h"
#include "thimble/light/host/optics.h"
#include "thimble/trace/ray.h"
#include "thimble/trace/secondary_ray.h"

namespace {

using namespace thimble;
using thimble::tests::pick;
using thimble::tests::pick_int;

using Real = long double;
using Reals = std::array<Real, 3>;

const int kSweep = thimble::tests::many_or_few(1000000, 100000);

std::uint64_t seed() {
  return tests::seed_or(5);
}

Reals reals(const Vec3i& v) {
  return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}
Real dot(const Reals& a, const Reals& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Real length(const Reals& a) {
  return std::sqrt(dot(a, a));
}
Reals combine(Real s, const Reals& a, Real t, const Reals& b) {
  return {s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]};
}
Real angle_urad(const Reals& a, const Reals& b) {
  const Reals cross = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  return 1e6L * std::atan2(length(cross), dot(a, b));
}

std::string text_of(const Vec3i& v) {
  return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

// Of any number of bits up to `bits`, zeros among them, never all zero.
Vec3i random_direction(std::mt19937_64& random, int bits) {
  Vec3i direction;
  do {
    const int most = pick_int(random, 1, bits);
    for (int axis = 0; axis < 3; ++axis) {
      const int own = pick(random, 0, 2) == 0 ? pick_int(random, 0, most) : most;
      const std::int64_t limit = (std::int64_t{1} << own) - 1;
      direction[axis] = pick_int(random, -limit, limit);
    }
  } while (direction == Vec3i{});
  return direction;
}

// The largest value seen, and where.
struct Worst {
  Real value = 0;
  std::string where;

  void see(Real candidate, const std::string& place) {
    if (!(candidate <= value)) {
      value = candidate;
      where = place;
    }
  }
};

#define CHECK_WORST(worst, bound)                                                                            \
  do {                                                                                                       \
    INFO("largest " << static_cast<double>((worst).value) << " at " << (worst).where << " seed " << seed()); \
    CHECK((worst).value <= static_cast<Real>(bound));                                                        \
    CHECK((worst).value > 0.3L * static_cast<Real>(bound)); /* the bound means something */                  \
  } while (false)

}  // namespace

TEST_CASE("shorten: any direction -> 15 bits, zeros, signs and short ones as they are") {
  std::mt19937_64 random(seed());
  int wrong = 0;
  for (int i = 0; i < kSweep; ++i) {
    const Vec3i direction = random_direction(random, 20);
    const Vec3i result = shorten(direction);
    std::int32_t before = 0;
    std::int32_t after = 0;
    for (int axis = 0; axis < 3; ++axis) {
      before = std::max(before, std::abs(direction[axis]));
      after = std::max(after, std::abs(result[axis]));
      wrong += direction[axis] == 0 && result[axis] != 0 ? 1 : 0;
      wrong += (direction[axis] < 0 && result[axis] > 0) || (direction[axis] > 0 && result[axis] < 0) ? 1 : 0;
    }
    wrong += after > kMaxShort ? 1 : 0;
    wrong += before <= kMaxShort ? (result == direction ? 0 : 1) : (after < (1 << 14) ? 1 : 0);
  }
  CHECK(wrong == 0);
  CHECK(shorten({kMaxDirection, -kMaxDirection, 0}) == Vec3i{1 << 14, -(1 << 14), 0});
  CHECK(shorten({65535, 0, 3}) == Vec3i{1 << 14, 0, 1});
}

TEST_CASE("length_of: every vector of 15 bits -> the nearest integer") {
  std::mt19937_64 random(seed());
  Worst off;
  for (int i = 0; i < kSweep; ++i) {
    const Vec3i vector = random_direction(random, 15);
    off.see(std::fabs(static_cast<Real>(length_of(vector)) - length(reals(vector))), text_of(vector));
  }
  CHECK_WORST(off, 0.5L);
  CHECK(length_of({0, 0, 0}) == 0);
  CHECK(length_of({kMaxShort, kMaxShort, -kMaxShort}) == 56754);
  CHECK(length_of({0, -kMaxShort, 0}) == kMaxShort);
}

TEST_CASE("unit_q14: along an axis, a diagonal, none -> the unit worked out by hand") {
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::int32_t size : {1, 3, 16384, 32767, 65535, kMaxDirection}) {
      Vec3i direction;
      direction[axis] = -size;
      Vec3i unit;
      unit[axis] = -kUnitQ14;
      CHECK(unit_q14(direction) == unit);
    }
  }
  CHECK(unit_q14({5, -5, 0}) == Vec3i{11585, -11585, 0});
  CHECK(unit_q14({0, 0, 0}) == Vec3i{});
}

TEST_CASE("reflect: at a face, and at a normal along an axis -> a change of one sign") {
  CHECK(reflect(Vec3i{7, -9, kMaxDirection}, 2) == Vec3i{7, -9, -kMaxDirection});
  CHECK(reflect(Vec3i{7, -9, 1}, 0) == Vec3i{-7, -9, 1});
  // The longest directions that are allowed.
  CHECK(reflect(Vec3i{kMaxShort, -kMaxShort, kMaxShort}, Vec3i{0, 0, kUnitQ14}) ==
        Vec3i{kMaxShort, -kMaxShort, -kMaxShort});
  CHECK(reflect(Vec3i{kMaxShort, -kMaxShort, kMaxShort}, Vec3i{0, -kUnitQ14, 0}) ==
        Vec3i{kMaxShort, kMaxShort, kMaxShort});
}

namespace {

__extension__ typedef __int128 Int128;

// Whether light goes through, by the exact inequality for the very integers given.
bool goes_through(const Vec3i& unit, const Vec3i& normal, std::uint32_t eta) {
  const Int128 big_d = Int128{unit.x} * normal.x + Int128{unit.y} * normal.y + Int128{unit.z} * normal.z;
  const Int128 big_n =
      Int128{normal.x} * normal.x + Int128{normal.y} * normal.y + Int128{normal.z} * normal.z;
  const Int128 big_l = Int128{unit.x} * unit.x + Int128{unit.y} * unit.y + Int128{unit.z} * unit.z;
  return big_d != 0 &&
         big_l * big_n * (Int128{1} << 24) - Int128{eta} * eta * (big_l * big_n - big_d * big_d) > 0;
}

// Ratios from 1/4 to 4: the ends, usual ones and any.
std::uint32_t random_eta(std::mt19937_64& random) {
  constexpr std::array<std::uint32_t, 8> kUsual = {1024, 4096, 16384, 5460, 3073, 5325, 3151, 4097};
  const std::int64_t choice = pick(random, 0, 15);
  return choice < 8 ? kUsual[static_cast<std::size_t>(choice)]
                    : static_cast<std::uint32_t>(pick(random, 1024, 16384));
}

}  // namespace

TEST_CASE("refract: all angles, ratios 1/4 to 4 -> total reflection exactly at faces, and lengths are kept") {
  std::mt19937_64 random(seed());
  Worst longer;
  int total = 0;
  int wrong = 0;
  for (int i = 0; i < 2 * kSweep; ++i) {
    const bool is_bent = i % 2 != 0;
    const int axis = pick_int(random, 0, 2);
    Vec3i normal;
    normal[axis] = kUnitQ14;
    normal = is_bent ? unit_q14(random_direction(random, 20)) : normal;
    Vec3i unit = unit_q14(random_direction(random, 20));
    const std::uint32_t eta = random_eta(random);
    const Reals n = reals(normal);
    const Reals side = combine(1, reals(unit), -dot(reals(unit), n) / dot(n, n), n);
    if (pick(random, 0, 3) == 0 && length(side) > 100) {
      // Near the critical angle, on both sides, or grazing.
      const Real s = std::min(1.0L, std::min(1.0L, 4096.0L / static_cast<Real>(eta)) +
                                        1e-4L * static_cast<Real>(pick(random, -9, 9)));
      const Reals aimed =
          combine(16384 * s / length(side), side, 16384 * std::sqrt(1 - s * s) / length(n), n);
      for (int k = 0; k < 3; ++k) {
        unit[k] = static_cast<std::int32_t>(std::lround(aimed[static_cast<std::size_t>(k)]));
      }
    }
    const bool through = goes_through(unit, normal, eta);
    Vec3i out{1, 2, 3};
    const bool result = is_bent ? refract(unit, normal, eta, &out) : refract(unit, axis, eta, &out);
    if (eta == 4096) {
      wrong += result && out == unit ? 0 : 1;
    } else if (result != through) {
      // At a bent normal the inequality of the header leaves less than 1/64 of a unit of the square for this.
      const Real along = dot(reals(unit), n);
      const Real sine_square = dot(reals(unit), reals(unit)) - along * along / dot(n, n);
      const Real ratio = static_cast<Real>(eta) / 4096;
      const Real excess = ratio * ratio * sine_square - dot(reals(unit), reals(unit));
      wrong += is_bent && std::fabs(excess) <= ratio * ratio / 64 ? 0 : 1;
    } else if (!result) {
      ++total;
      wrong += out == Vec3i{1, 2, 3} ? 0 : 1;
    } else {
      wrong += is_bent || ((out[axis] > 0) == (unit[axis] > 0) && out[axis] != 0) ? 0 : 1;
      longer.see(std::fabs(length(reals(out)) - length(reals(unit))),
                 text_of(unit) + text_of(normal) + " eta " + std::to_string(eta));
    }
  }
  CHECK(wrong == 0);
  CHECK(total > kSweep / 5);
  CHECK_WORST(longer, 3);
}

TEST_CASE("refract: the critical angle -> total reflection from its exact integer on, not before") {
  // Every second ratio from dense to thin; the last tangent that passes is found, and the next one does not.
  int wrong = 0;
  for (std::uint32_t eta = 4098; eta <= 16384; eta += 2) {
    std::int32_t low = 0;  // passes
    std::int32_t high = kUnitQ14;
    Vec3i out;
    while (high - low > 1) {
      const std::int32_t middle = (low + high) / 2;
      const std::int32_t along =
          static_cast<std::int32_t>(std::lround(std::sqrt(16384.0L * 16384 - Real{1} * middle * middle)));
      (refract(Vec3i{middle, 0, -along}, 2, eta, &out) ? low : high) = middle;
    }
    const Real critical = 4096.0L / static_cast<Real>(eta) * 16384;
    wrong += std::fabs(static_cast<Real>(low) - critical) <= 2 ? 0 : 1;
  }
  CHECK(wrong == 0);
  // By the inequality: 16 * 4096^2 against 4096^2 + c^2, which c = 15863 is below and 15864 above.
  Vec3i out;
  CHECK_FALSE(refract(Vec3i{4096, 0, 15863}, 2, 16384, &out));
  CHECK(refract(Vec3i{4096, 0, 15864}, 2, 16384, &out));
  CHECK_FALSE(refract(Vec3i{4096, 0, 15863}, Vec3i{0, 0, kUnitQ14}, 16384, &out));
  CHECK(refract(Vec3i{4096, 0, 15864}, Vec3i{0, 0, -kUnitQ14}, 16384, &out));
  // On it: a triangle of 3, 4 and 5 and the ratio 5/4.
  CHECK_FALSE(refract(Vec3i{0, 4 * 3277, -3 * 3277}, 2, 5120, &out));
  CHECK(refract(Vec3i{0, 4 * 3277, -3 * 3277}, 2, 5119, &out));
  CHECK_FALSE(refract(Vec3i{0, kUnitQ14, 0}, 2, 4095, &out));
  CHECK(refract(Vec3i{0, kUnitQ14, 1}, 2, 4095, &out));
}

TEST_CASE(
    "refract: normal incidence -> straight on, any ratio and side; there and back -> the same direction") {
  int wrong = 0;
  for (std::uint32_t eta = kMinEtaQ12; eta <= kMaxEtaQ12; eta += 7) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const std::int32_t sign : {-kUnitQ14, kUnitQ14}) {
        Vec3i unit;
        unit[axis] = sign;
        Vec3i out;
        REQUIRE(refract(unit, axis, eta, &out));
        wrong += out == unit ? 0 : 1;
        REQUIRE(refract(unit, unit, eta, &out));
        wrong += out == unit ? 0 : 1;
        REQUIRE(refract(unit, Vec3i{-unit.x, -unit.y, -unit.z}, eta, &out));
        wrong += out == unit ? 0 : 1;
      }
    }
  }
  CHECK(wrong == 0);
  std::mt19937_64 random(seed());
  Worst turned;
  for (int i = 0; i < kSweep / 10; ++i) {
    const Vec3i unit = unit_q14(random_direction(random, 20));
    Vec3i inside;
    Vec3i back;
    if (unit.z != 0 && std::abs(unit.z) > 2000 && refract(unit, 2, eta_q12(4096, 6144), &inside) &&
        refract(inside, 2, eta_q12(6144, 4096), &back)) {
      turned.see(angle_urad(reals(unit), reals(back)), text_of(unit));
    }
  }
  CHECK(turned.value < 2000);
  CHECK(turned.value > 0);
}

TEST_CASE("eta_q12: two indices -> their ratio to the nearest, clamped") {
  CHECK(eta_q12(4096, 4096) == kOneQ12);
  CHECK(eta_q12(5325, 5325) == kOneQ12);
  CHECK(eta_q12(4096, 16384) == kMinEtaQ12);
  CHECK(eta_q12(16384, 4096) == kMaxEtaQ12);
  CHECK(eta_q12(4096, 5460) == 3073);
  CHECK(eta_q12(1, 65535) == kMinEtaQ12);
  CHECK(eta_q12(65535, 1) == kMaxEtaQ12);
  CHECK(eta_q12(1, 0) == kMaxEtaQ12);
}

TEST_CASE("r0_q16: pairs of indices -> the same in either order, 0 for equal ones only") {
  std::mt19937_64 random(seed());
  int wrong = 0;
  for (int i = 0; i < kSweep / 4; ++i) {
    const std::uint32_t a = static_cast<std::uint32_t>(pick(random, 1, 65535));
    const std::uint32_t b = static_cast<std::uint32_t>(
        pick(random, 0, 3) == 0 ? a - pick(random, 0, std::min(a - 1, 9U)) : pick(random, 1, 65535));
    const std::uint32_t value = r0_q16(a, b);
    wrong += (value == 0) == (a == b) && value <= kOneQ16 && value == r0_q16(b, a) ? 0 : 1;
  }
  CHECK(wrong == 0);
  CHECK(r0_q16(4096, 6144) == 2621);  // glass of 1.5: 4 per cent
  CHECK(r0_q16(4096, 0) == kOneQ16);
  CHECK(r0_q16(0, 0) == 0);
}

TEST_CASE("fresnel_q16: every cosine -> a share that falls with it, never above 1") {
  int wrong = 0;
  for (const std::uint32_t r0 : {1U, 2U, 655U, 1337U, 2621U, 23593U, 65535U, 65536U}) {
    std::uint32_t last = kOneQ16;
    for (std::int32_t cosine = 0; cosine <= kUnitQ14 + 3; ++cosine) {
      const std::uint32_t value = fresnel_q16(cosine, r0);
      wrong += value <= last && value >= r0 && value <= kOneQ16 && value == fresnel_q16(-cosine, r0) ? 0 : 1;
      last = value;
    }
    CHECK(fresnel_q16(kUnitQ14, r0) == r0);
    CHECK(fresnel_q16(0, r0) == kOneQ16);
  }
  for (std::int32_t cosine = 0; cosine <= kUnitQ14; ++cosine) {
    wrong += fresnel_q16(cosine, r0_q16(5325, 5325)) == 0 ? 0 : 1;
  }
  CHECK(wrong == 0);
}

TEST_CASE("transmittance_q16: every number of halvings -> never rising, 1 at 0 and 0 beyond 17") {
  int wrong = 0;
  std::uint32_t last = kOneQ16;
  for (std::uint32_t x = 0; x <= 18U << 16; ++x) {
    const std::uint32_t value = transmittance_q16(x);
    wrong += value <= last ? 0 : 1;
    last = value;
  }
  CHECK(wrong == 0);
  for (std::uint32_t n = 0; n <= 16; ++n) {
    CHECK(transmittance_q16(n << 16) == kOneQ16 >> n);
  }
  CHECK(transmittance_q16(17U << 16) == 0);
  CHECK(transmittance_q16(UINT32_MAX) == 0);
}

TEST_CASE("distance_q8: worked out by hand; farther than a number says -> the greatest") {
  CHECK(distance_q8({0, -7, 0}, 1234, 7 * 256) == 1234);
  CHECK(distance_q8({300, 400, 0}, 300, 300 * 256) == 500);
  CHECK(distance_q8({1, 1, 1}, 0, 1) == 0);
  CHECK(distance_q8({kMaxDirection, kMaxDirection, 1}, 1 << 24, 256) == INT32_MAX);
  CHECK(distance_q8({kMaxDirection, 0, 255}, 1 << 24, 256 * 255) == INT32_MAX);
}

TEST_CASE("distance_q8 with a cosine: rays to a point, any others -> both as apart, and the definition's") {
  std::mt19937_64 random(seed());
  int wrong = 0;
  int to_points = 0;
  for (int i = 0; i < kSweep; ++i) {
    const Vec3i direction = random_direction(random, pick_int(random, 1, 20));
    const int axis = pick_int(random, 0, 2);
    const bool to_point = pick(random, 0, 1) != 0;
    const auto numerator = pick_int(random, -1, std::int64_t{1} << pick(random, 0, 24));
    const int other = pick_int(random, 0, 2);
    const std::int32_t denominator = to_point ? 256 : 256 * std::abs(direction[other]);
    std::uint32_t cosine = 99999;
    const std::int32_t distance = distance_q8(direction, numerator, denominator, axis, &cosine);
    wrong += distance == distance_q8(direction, numerator, denominator) ? 0 : 1;
    const std::uint32_t unit = static_cast<std::uint32_t>(std::abs(unit_q14(direction)[axis]));
    wrong += cosine == std::min(unit, std::uint32_t{1} << 14) ? 0 : 1;
    // Up to 15 bits the direction is scaled up by 2^n, and its length is a whole number then.
    std::int64_t largest = 0;
    for (int k = 0; k < 3; ++k) {
      largest = std::max<std::int64_t>(largest, std::abs(direction[k]));
    }
    if (to_point && numerator > 0 && largest > 0 && largest < 1 << 15) {
      ++to_points;
      int shift = 0;
      while (largest << shift < 1 << 14) {
        ++shift;
      }
      const std::int64_t length =
          length_of({direction.x * (1 << shift), direction.y * (1 << shift), direction.z * (1 << shift)});
      const std::int64_t half = shift == 0 ? 0 : std::int64_t{1} << (shift - 1);
      wrong += distance == std::min<std::int64_t>((length * numerator + half) >> shift, INT32_MAX) ? 0 : 1;
    }
  }
  CHECK(wrong == 0);
  CHECK(to_points > kSweep / 10);
}

TEST_CASE("occlusion direction: the six faces -> away from each, a turned copy of the first") {
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool smaller : {false, true}) {
      for (int i = 0; i < kOcclusionDirections; ++i) {
        const Vec3i direction = occlusion_direction(i, axis, smaller);
        CHECK(leaves_face(direction, axis, smaller));
        CHECK_FALSE(enters_face(direction, axis, smaller));
        CHECK(std::abs(direction[axis]) == kOcclusionPattern[i].z);
        CHECK(direction[(axis + 1) % 3] == kOcclusionPattern[i].x);
        CHECK(direction[(axis + 2) % 3] == kOcclusionPattern[i].y);
      }
    }
  }
}

TEST_CASE("roughen: four offsets -> nothing in sum, none at 0, equal lengths") {
  const Vec3i unit{0, 9830, 13107};
  for (int i = 0; i < kRoughnessRays; ++i) {
    CHECK(roughen(unit, 0, i) == unit);
  }
  for (const int roughness : {1, 100, 255}) {
    Vec3i sum;
    for (int i = 0; i < kRoughnessRays; ++i) {
      const Vec3i bent = roughen(unit, static_cast<std::uint8_t>(roughness), i);
      for (int axis = 0; axis < 3; ++axis) {
        sum[axis] += bent[axis] - unit[axis];
      }
      CHECK(angle_urad(reals(bent), reals(unit)) < 0.58e6L);
    }
    CHECK(sum == Vec3i{});
  }
}
