/// @file vec.h
/// Three components and two: positions, directions, sizes. World axes are right-handed, z up:
///
///        z
///        |  y
///        | /
///        |/___ x
#ifndef THIMBLE_VEC_H
#define THIMBLE_VEC_H

#include <stdint.h>

#include "thimble/fixed.h"

namespace thimble {

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

/// The half-open box of voxels [min, max) on every axis; empty when `min == max` on any.
struct VoxelBox {
  Vec3i min;
  Vec3i max;

  constexpr bool empty() const { return min.x >= max.x || min.y >= max.y || min.z >= max.z; }
  friend constexpr bool operator==(const VoxelBox& a, const VoxelBox& b) {
    return a.min == b.min && a.max == b.max;
  }
};

}  // namespace thimble

#endif
