// Directions and light in integers. Every product has its bound beside it; optics.h states what the results
// are good for.
#include "thimble/light/host/optics.h"

#include "../base/bits.h"
#include "../base/integers.h"
#include "../base/ranges.h"
#include "../base/wide_arithmetic.h"

namespace thimble {
namespace {

constexpr int32_t signed_as(int32_t sign, uint32_t value) {
  return sign < 0 ? -static_cast<int32_t>(value) : static_cast<int32_t>(value);
}

// value / 2^shift to the nearest, halves away from zero; shift 1 and up, |value| at most 2^62.
constexpr int32_t rounded(int64_t value, int shift) {
  return static_cast<int32_t>(with_sign_of(value, shift_rounded(magnitude(value), shift)));
}

// The integer nearest to the root.
#if UINTPTR_MAX > 0xFFFFFFFFU || defined(__ARM_FEATURE_IDIV)
// Where the core divides fast: two steps of Heron's, from a straight line within 4 per cent of the root, never below it
// afterwards: within 1 / 1,000 and 1 / 1,000,000.
constexpr uint32_t root_rounded(uint32_t value) {
  if (value == 0) {
    return 0;
  }
  const int shift = (32 - bits::bit_length(value)) & ~1;
  const uint32_t scaled = value << shift;  // 2^30 .. 2^32 - 1
  // 2^15 (0.695 + 0.358 scaled / 2^30): 4 per cent too much or too little.
  uint32_t root = 22774 + static_cast<uint32_t>(uint64_t{scaled} * 11731 >> 30);
  root = (root + scaled / root) >> 1;
  root = ((root + scaled / root) >> 1) >> (shift / 2);
  // The root rounded down, or 1 more. No branch: nobody could predict it.
  root -= uint64_t{root} * root > value ? 1U : 0U;
  return root + (value - root * root > root ? 1U : 0U);
}
#else
// 16 steps of compare and subtract.
constexpr uint32_t root_rounded(uint32_t value) {
  uint32_t root = 0;
  for (uint32_t bit = 1U << 30; bit != 0; bit >>= 2) {
    if (value >= root + bit) {
      value -= root + bit;
      root = (root >> 1) + bit;
    } else {
      root >>= 1;
    }
  }
  // What is left exceeds the root exactly when the true root lies above root + 1/2.
  return value > root ? root + 1 : root;
}
#endif

constexpr uint32_t largest_of(const Vec3i& vector) {
  const uint32_t x = magnitude_32(vector.x);
  const uint32_t y = magnitude_32(vector.y);
  const uint32_t z = magnitude_32(vector.z);
  const uint32_t xy = x > y ? x : y;
  return xy > z ? xy : z;
}

// A direction with its largest component in 2^14 .. 2^15 - 1, which is the direction times 2^-exponent.
struct Scaled {
  Vec3i direction;
  int exponent = 0;
};

Scaled scaled(const Vec3i& direction) {
  const uint32_t largest = largest_of(direction);
  Scaled result{direction, bits::bit_length(largest) - 15};
  if (result.exponent < 0) {
    if (largest == 0) {
      return result;
    }
    for (int axis = 0; axis < 3; ++axis) {
      result.direction[axis] = direction[axis] * (int32_t{1} << -result.exponent);
    }
  } else if (result.exponent > 0) {
    if ((largest + (1U << (result.exponent - 1))) >> result.exponent > static_cast<uint32_t>(kMaxShort)) {
      ++result.exponent;  // rounding would carry into a 16th bit
    }
    const uint32_t half = 1U << (result.exponent - 1);
    for (int axis = 0; axis < 3; ++axis) {
      result.direction[axis] =
          signed_as(direction[axis], (magnitude_32(direction[axis]) + half) >> result.exponent);
    }
  }
  return result;
}

// Dot product of two vectors whose lengths' product is below 2^31; no partial sum is looked at.
int32_t dot(const Vec3i& a, const Vec3i& b) {
  THIMBLE_NOTE(Range::kDot, Exact(a.x) * Exact(b.x) + Exact(a.y) * Exact(b.y) + Exact(a.z) * Exact(b.z));
  return static_cast<int32_t>(static_cast<uint32_t>(a.x) * static_cast<uint32_t>(b.x) +
                              static_cast<uint32_t>(a.y) * static_cast<uint32_t>(b.y) +
                              static_cast<uint32_t>(a.z) * static_cast<uint32_t>(b.z));
}

// 2^56 / square for a square near 2^28, as 2^29 less it: the first two terms of 1 / (1 + e) = 1 - e + ...,
// and e is below 2^-8 for a vector within 16 of the length of a unit, so what is left out is below 2^-17.
int64_t inverse_of_square_q56(int32_t square) {
  return (int64_t{1} << 29) - square;
}

constexpr uint32_t clamped_eta(uint32_t eta) {
  return eta < kMinEtaQ12 ? kMinEtaQ12 : eta > kMaxEtaQ12 ? kMaxEtaQ12 : eta;
}

// 4 * (L - eta^2 S), rounded: the square of the component after refraction, in Q30; 0 on total reflection, at
// least 1 otherwise. With L and S times 2^scale_bits: L below 2^(29 + scale_bits), scale_bits at most 6.
// Products: eta^2 below 2^29, S up to 2^35, so 2^63 at the most.
uint32_t square_after_q30(uint64_t length_square, uint64_t tangent_square, uint32_t eta, int scale_bits) {
  const uint64_t tangent = uint64_t{eta * eta} * tangent_square;
  const uint64_t length = length_square << 24;
  THIMBLE_NOTE(Range::kTangent, Exact(eta * eta) * Exact(tangent_square));
  THIMBLE_NOTE(Range::kTangent, Exact(length_square) * Exact(1 << 24));
  if (tangent >= length) {
    return 0;
  }
  const uint64_t square = shift_rounded(length - tangent, 22 + scale_bits);
  return square == 0 ? 1 : static_cast<uint32_t>(square);
}

// 65536 * (1 - 2^(-i / 64)).
constexpr uint16_t kFall[65] = {0,     706,   1404,  2095,  2779,  3455,  4123,  4785,  5439,  6087,  6727,
                                7360,  7987,  8607,  9220,  9827,  10427, 11021, 11608, 12189, 12763, 13332,
                                13894, 14451, 15001, 15545, 16084, 16616, 17143, 17665, 18180, 18690, 19195,
                                19694, 20188, 20677, 21160, 21638, 22111, 22578, 23041, 23499, 23952, 24400,
                                24843, 25281, 25715, 26144, 26568, 26988, 27403, 27814, 28220, 28622, 29020,
                                29413, 29802, 30187, 30568, 30945, 31317, 31686, 32050, 32411, 32768};

// t * length * 2^exponent in 1/256 voxel, for a length in 2^14 .. 2^16.
int32_t distance_along(uint32_t length, int exponent, int32_t t_numerator, int32_t t_denominator) {
  const uint32_t component = static_cast<uint32_t>(t_denominator) >> 8;
  if (component == 0 || t_numerator <= 0) {
    return 0;
  }
  // length / component in Q28 by two divisions: the first quotient is below 2^32, what it leaves below 2^20.
  const uint32_t dividend = length << 16;
  const uint32_t high = dividend / component;
  const uint32_t low = ((dividend - high * component) << 12) / component;
  // 2^24 * 2^32, and 2^24 * 2^12 >> 12.
  const uint64_t distance_q16 = wide_product_u(static_cast<uint32_t>(t_numerator), high) +
                                (wide_product_u(static_cast<uint32_t>(t_numerator), low) >> 12);
  THIMBLE_NOTE(Range::kLength, Exact(distance_q16));
  const uint64_t distance = shift_rounded(distance_q16, 16 - exponent);  // the exponent is -14 .. 6
  return distance < INT32_MAX ? static_cast<int32_t>(distance) : INT32_MAX;
}

// |component| / length in Q14, rounded. Below 2^29 + 2^15.
uint32_t share_of_length(int32_t component, uint32_t length) {
  return ((magnitude_32(component) << 14) + (length >> 1)) / length;
}

}  // namespace

Vec3i shorten(const Vec3i& direction) {
  return largest_of(direction) <= static_cast<uint32_t>(kMaxShort) ? direction : scaled(direction).direction;
}

uint32_t length_of(const Vec3i& vector) {
  // 3 * (2^15 - 1)^2 is below 2^32.
  const uint32_t x = magnitude_32(vector.x);
  const uint32_t y = magnitude_32(vector.y);
  const uint32_t z = magnitude_32(vector.z);
  THIMBLE_NOTE(Range::kSquareSum, Exact(x) * Exact(x) + Exact(y) * Exact(y) + Exact(z) * Exact(z));
  return root_rounded(x * x + y * y + z * z);
}

Vec3i unit_q14(const Vec3i& direction) {
  Vec3i unit = scaled(direction).direction;
  const uint32_t length = length_of(unit);
  if (length == 0) {
    return unit;
  }
  for (int axis = 0; axis < 3; ++axis) {
    unit[axis] = signed_as(unit[axis], share_of_length(unit[axis], length));
  }
  return unit;
}

int32_t dot_q14(const Vec3i& a, const Vec3i& unit_q14) {
  return rounded(dot(a, unit_q14), 14);
}

Vec3i reflect(const Vec3i& direction, const Vec3i& normal_q14) {
  // Twice the component along the normal, in units of it: 2 D / N, with D below 2^30.
  const int64_t d = dot(direction, normal_q14);
  const int64_t inverse = inverse_of_square_q56(dot(normal_q14, normal_q14));
  THIMBLE_NOTE(Range::kReflected, Exact(d) * Exact(inverse));
  const int32_t twice_q14 = rounded(d * inverse, 41);
  Vec3i result;
  for (int axis = 0; axis < 3; ++axis) {
    result[axis] = direction[axis] - rounded(wide_product(twice_q14, normal_q14[axis]), 14);
  }
  return result;
}

uint32_t eta_q12(uint32_t n1_q12, uint32_t n2_q12) {
  if (n2_q12 == 0) {
    return kMaxEtaQ12;
  }
  return clamped_eta(((n1_q12 << 12) + (n2_q12 >> 1)) / n2_q12);  // below 2^28 + 2^15
}

bool refract(const Vec3i& unit, int axis, uint32_t eta_q12, Vec3i* out) {
  const uint32_t eta = clamped_eta(eta_q12);
  if (eta == kOneQ12) {
    *out = unit;
    return true;
  }
  const uint32_t along = magnitude_32(unit[axis]);
  if (along == 0) {
    return false;
  }
  const uint32_t length_square = static_cast<uint32_t>(dot(unit, unit));
  const uint32_t square = square_after_q30(length_square, length_square - along * along, eta, 0);
  if (square == 0) {
    return false;
  }
  const uint32_t root_q15 = root_rounded(square);
  for (int other = 0; other < 3; ++other) {
    // Below 2^15 * 2^14 + 2^11; and at least 1 along the axis, so that the ray goes through the face.
    const uint32_t size =
        other == axis ? (root_q15 + 1) >> 1 : (magnitude_32(unit[other]) * eta + (1U << 11)) >> 12;
    (*out)[other] = signed_as(unit[other], size);
  }
  return true;
}

bool refract(const Vec3i& unit, const Vec3i& normal_q14, uint32_t eta_q12, Vec3i* out) {
  const uint32_t eta = clamped_eta(eta_q12);
  if (eta == kOneQ12) {
    *out = unit;
    return true;
  }
  const int32_t d = dot(unit, normal_q14);
  if (d == 0) {
    return false;
  }
  // D^2 is below 2^57, so 64 D^2 below 2^63; the quotient is at most 64 L.
  const uint32_t normal_square = static_cast<uint32_t>(dot(normal_q14, normal_q14));
  const uint64_t length_square = uint64_t{static_cast<uint32_t>(dot(unit, unit))} << 6;
  const uint64_t along_square = divide(wide_product_u(magnitude_32(d), magnitude_32(d)) << 6, normal_square);
  const uint32_t square = square_after_q30(length_square, length_square - along_square, eta, 6);
  if (square == 0) {
    return false;
  }
  // out = eta * unit + h * normal with h = (root * |normal| - eta * D) / N, the root and D taken positive.
  // The normal's length goes under the same root: 2^30 * 2^28 / 2^28.
  const uint32_t root_q15 =
      root_rounded(static_cast<uint32_t>(shift_rounded(wide_product_u(square, normal_square), 28)));
  // In Q28 * 4096: 2^31 * 2^10 and 2^14 * 2^28, both below 2^43; times the inverse cut to 2^19.
  const int64_t onward_q40 =
      (int64_t{root_q15} << 25) - static_cast<int64_t>(wide_product_u(magnitude_32(d), eta));
  const int64_t inverse_q47 = inverse_of_square_q56(static_cast<int32_t>(normal_square)) >> 9;
  THIMBLE_NOTE(Range::kOnward, Exact(onward_q40) * Exact(inverse_q47));
  const int64_t h_q18 = (onward_q40 * inverse_q47) >> 41;  // below 2^43 * 2^19; 2^20 after the shift
  const int64_t h = d < 0 ? -h_q18 : h_q18;
  for (int axis = 0; axis < 3; ++axis) {
    // Q26 times 2^6 and Q32: below 2^36.
    THIMBLE_NOTE(Range::kRefracted,
                 Exact(unit[axis]) * Exact(eta) * Exact(64) + Exact(h) * Exact(normal_q14[axis]));
    (*out)[axis] =
        rounded(wide_product(unit[axis], static_cast<int32_t>(eta)) * 64 + h * normal_q14[axis], 18);
  }
  return true;
}

uint32_t r0_q16(uint32_t n1_q12, uint32_t n2_q12) {
  const uint32_t difference = n1_q12 > n2_q12 ? n1_q12 - n2_q12 : n2_q12 - n1_q12;
  if (difference == 0) {
    return 0;
  }
  const uint32_t sum = n1_q12 + n2_q12;
  if (difference == sum) {
    return kOneQ16;
  }
  // With 16 bits each the ratio is below 1 - 2^-17, so it rounds to 65535 at the most; the dividend is below
  // 2^32 - 2^16.
  const uint32_t ratio_q16 = ((difference << 16) + (sum >> 1)) / sum;
  const uint32_t square = (ratio_q16 * ratio_q16 + (1U << 15)) >> 16;
  return square == 0 ? 1 : square;
}

uint32_t fresnel_q16(int32_t cos_q14, uint32_t r0_q16) {
  if (r0_q16 == 0) {
    return 0;
  }
  const uint32_t cosine = magnitude_32(cos_q14);
  if (cosine == 0 || r0_q16 >= kOneQ16) {
    return kOneQ16;
  }
  const uint32_t lack =
      cosine < static_cast<uint32_t>(kUnitQ14) ? static_cast<uint32_t>(kUnitQ14) - cosine : 0;
  // Powers of 1 - cos in Q16. With the cosine at least 2^-14 the square is below 2^16 - 7, so that each
  // product and its half stay below 2^32.
  const uint32_t square = (lack * lack + (1U << 11)) >> 12;
  const uint32_t fourth = (square * square + (1U << 15)) >> 16;
  const uint32_t fifth = (fourth * lack + (1U << 13)) >> 14;
  return r0_q16 + (((kOneQ16 - r0_q16) * fifth + (1U << 15)) >> 16);
}

uint32_t transmittance_q16(uint32_t halvings_q16) {
  const uint32_t whole = halvings_q16 >> 16;
  if (whole > 16) {
    return 0;
  }
  const uint32_t place = (halvings_q16 >> 10) & 63U;
  const uint32_t between = halvings_q16 & 1023U;
  // A step of the table is at most 706: the product is below 2^20.
  const uint32_t step = uint32_t{kFall[place + 1]} - kFall[place];
  const uint32_t left = kOneQ16 - kFall[place] - ((step * between + 512) >> 10);
  return whole == 0 ? left : (left + (1U << (whole - 1))) >> whole;
}

int32_t distance_q8(const Vec3i& direction, int32_t t_numerator, int32_t t_denominator) {
  const Scaled scale = scaled(direction);
  return distance_along(length_of(scale.direction), scale.exponent, t_numerator, t_denominator);
}

int32_t distance_q8(const Vec3i& direction, int32_t t_numerator, int32_t t_denominator, int axis,
                    uint32_t* cosine_q14) {
  const Scaled scale = scaled(direction);
  const uint32_t length = length_of(scale.direction);
  // No component is longer than that.
  *cosine_q14 = length == 0 ? 0 : share_of_length(scale.direction[axis], length);
  return distance_along(length, scale.exponent, t_numerator, t_denominator);
}

}  // namespace thimble
