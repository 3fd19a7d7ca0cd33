/// @file vec.h
/// Fixed-point numbers, and positions, directions and boxes made of three numbers.
///
/// A fixed-point number is an `int32_t` that knows where its binary point is. Formats in use
///   Q8   (24.8)   positions of rays, 1/256 voxel, about +-8.3 million voxels
///   Q14  (18.14)  lengths of a camera (camera.h), 1/16384 voxel, up to 131,072 voxels
///   Q16  (16.16)  angles in degrees, lengths in voxels, about +-32,768
///
/// Overflow: `+`, `-` and unary `-` wrap modulo 2^32 (no undefined behaviour); the callers' stated limits
/// keep them from doing so. Conversions that can lose something are named functions: there is no implicit
/// conversion between formats, or from and to integers. There is no multiplication here: where the core
/// multiplies, it does so on raw integers with the bound of the product written beside it.
///
/// World axes are right-handed, z up:
///
///        z
///        |  y
///        | /
///        |/___ x
#ifndef THIMBLE_BASE_VEC_H
#define THIMBLE_BASE_VEC_H

#include <stdint.h>

namespace thimble {

template <int kFractionBits>
struct Fixed {
  static_assert(kFractionBits > 0 && kFractionBits < 31);
  static constexpr int kBits = kFractionBits;
  static constexpr int32_t kOne = int32_t{1} << kFractionBits;
  /// The largest whole number that `saturate` represents without clamping.
  static constexpr int32_t kMaxWhole = INT32_MAX >> kFractionBits;

  int32_t raw = 0;

  static constexpr Fixed from_raw(int32_t raw_value) {
    Fixed result;
    result.raw = raw_value;
    return result;
  }
  /// `whole` exactly; out of -kMaxWhole-1 .. kMaxWhole it is clamped to the nearest representable number.
  static constexpr Fixed saturate(int32_t whole) {
    if (whole > kMaxWhole) {
      return from_raw(INT32_MAX);
    }
    if (whole < -kMaxWhole - 1) {
      return from_raw(INT32_MIN);
    }
    return from_raw(whole * kOne);
  }

  /// The greatest integer not above this number.
  constexpr int32_t floor() const { return raw >> kFractionBits; }
  /// What `floor` leaves: 0 .. kOne - 1, in units of 2^-kFractionBits.
  constexpr int32_t fraction() const { return raw & (kOne - 1); }

  friend constexpr Fixed operator+(Fixed a, Fixed b) {
    return from_raw(static_cast<int32_t>(static_cast<uint32_t>(a.raw) + static_cast<uint32_t>(b.raw)));
  }
  friend constexpr Fixed operator-(Fixed a, Fixed b) {
    return from_raw(static_cast<int32_t>(static_cast<uint32_t>(a.raw) - static_cast<uint32_t>(b.raw)));
  }
  friend constexpr Fixed operator-(Fixed a) {
    return from_raw(static_cast<int32_t>(0U - static_cast<uint32_t>(a.raw)));
  }
  friend constexpr bool operator==(Fixed a, Fixed b) { return a.raw == b.raw; }
  friend constexpr bool operator!=(Fixed a, Fixed b) { return a.raw != b.raw; }
  friend constexpr bool operator<(Fixed a, Fixed b) { return a.raw < b.raw; }
  friend constexpr bool operator<=(Fixed a, Fixed b) { return a.raw <= b.raw; }
  friend constexpr bool operator>(Fixed a, Fixed b) { return a.raw > b.raw; }
  friend constexpr bool operator>=(Fixed a, Fixed b) { return a.raw >= b.raw; }
};

using Q8 = Fixed<8>;
using Q16 = Fixed<16>;

template <class T>
struct Vec3 {
  T x{};
  T y{};
  T z{};

  /// Component `axis` (0 = x, 1 = y, 2 = z).
  constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr const T& operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

  friend constexpr bool operator==(const Vec3& a, const Vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
  friend constexpr bool operator!=(const Vec3& a, const Vec3& b) { return !(a == b); }
};

/// A voxel's indices, or an integer direction.
using Vec3i = Vec3<int32_t>;
/// A position in 1/256 voxel.
using Vec3Q8 = Vec3<Q8>;

/// Worlds are cubes of 2^level voxels a side.
inline constexpr int kMinLevel = 1;
inline constexpr int kMaxLevel = 12;

/// The half-open box of voxels [low, high) on every axis; empty when `low == high` on any.
struct VoxelBox {
  Vec3i low;
  Vec3i high;

  constexpr bool empty() const { return low.x >= high.x || low.y >= high.y || low.z >= high.z; }
  friend constexpr bool operator==(const VoxelBox& a, const VoxelBox& b) {
    return a.low == b.low && a.high == b.high;
  }
};

}  // namespace thimble

#endif
