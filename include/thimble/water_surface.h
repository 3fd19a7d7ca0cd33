/// @file water_surface.h
/// The geometry of water for a ray: columns of any height, hit by the exact rule. A plain view; whether the
/// heights move (water.h) is nothing to it, and water that never moves is one level and no array.
///
///            ___      column (i, j) is the half-open box
///      _____|   |__   [x + i, x + i + 1) x [y + j, y + j + 1) x [z, z + height), height in 1/256 voxel,
///     |   | |   |  |  (x, y, z) the voxel `corner`: z is the floor of the water
///     |___|_|___|__|
///
/// The rules are those of ray.h: a ray is in the water where it spends a positive length in the union of the
/// columns; a point that it only touches does not count; a ray that runs in a face belongs to the box that
/// owns it; planes crossed at the same t are crossed together, and the lowest axis names them. There is no
/// epsilon: everything is decided by comparing products of integers.
///
/// Solid voxels that stand in the water are not known here: whoever traces both gives them precedence.
///
/// Bits: with the water inside a world and the ray within the limits of ray.h, distances are below 2^23 and
/// directions below 2^20, so every product is below 2^43 and every sum of two below 2^44.
#ifndef THIMBLE_WATER_SURFACE_H
#define THIMBLE_WATER_SURFACE_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/ray.h"
#include "thimble/vec.h"

namespace thimble {

struct WaterSurface {
  Vec3i corner;            ///< the first column's lowest corner, a voxel of the world (0 .. 4095)
  int32_t width = 0;       ///< columns along x; corner.x + width <= 4096
  int32_t depth = 0;       ///< columns along y; corner.y + depth <= 4096
  int32_t lowest_q8 = 0;   ///< no column that holds water is lower, 1/256 voxel above the floor ...
  int32_t highest_q8 = 0;  ///< ... and none is higher; up to 2^20
  /// Null for still water: then every column is `highest_q8` high, and no byte is read. Else width * depth
  /// heights above the floor, row by row, in 1/65536 voxel, of which the nearest 1/256 counts; negative: the
  /// column holds no water (blocked), and its height is 0.
  const int32_t* heights_q16 = nullptr;
  /// Whether some column may be blocked; false lets a ray take what lies below `lowest_q8` at once.
  bool has_blocked = false;

  constexpr int32_t height_q8(int32_t x, int32_t y) const {
    if (heights_q16 == nullptr) {
      return highest_q8;
    }
    return (height_q16(x, y) + 128) >> 8;
  }
  /// The same as it is held: finer, for slopes; negative where the column is blocked.
  constexpr int32_t height_q16(int32_t x, int32_t y) const {
    if (heights_q16 == nullptr) {
      return highest_q8 * 256;
    }
    return heights_q16[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
};

/// Water that never moves: `width` x `depth` columns, all `height_q8` high. No bytes.
constexpr WaterSurface still_water(const Vec3i& corner, int32_t width, int32_t depth, int32_t height_q8) {
  return {corner, width, depth, height_q8, height_q8, nullptr, false};
}

/// Where a ray enters the water or leaves it.
struct WaterHit {
  int32_t column_x = 0;  ///< the column entered, or the last one left; 0 .. width - 1
  int32_t column_y = 0;
  /// Axis of the face crossed: 0 and 1 the column's sides, 2 its top or bottom; the lowest when several are
  /// crossed at the same t. -1: the ray starts inside (t = 0; `water_enter` only).
  int8_t axis = -1;
  /// Which of the two faces: the sign of its outward normal along `axis` (axis 2: 1 the surface, -1 the
  /// floor). 0 for axis -1.
  int8_t side = 0;
  /// t = t_numerator / t_denominator exactly, as in `Hit`: numerator 0 .. 2^23, denominator
  /// 256 * |direction[axis]| (1 for axis -1). Not reduced. Compare with a Hit's by cross products (2^51).
  int32_t t_numerator = 0;
  int32_t t_denominator = 1;
  /// Columns looked at: at most width + depth + 4.
  uint32_t visits = 0;
};

/// The first column in which the ray, for which `check_ray` holds, spends a positive length. False, and `hit`
/// untouched but for `visits`, when there is none. A ray that misses the box of the water looks at no column;
/// in water without waves one that hits it looks at one.
bool water_enter(const WaterSurface& surface, const Ray& ray, WaterHit* hit);

/// Where a ray that is in the water from t = 0 on leaves it for the first time: the end of the first stretch
/// without a gap of positive length. False when it does not start in the water.
bool water_leave(const WaterSurface& surface, const Ray& ray, WaterHit* hit);

/// Whether a ray from `point` in `direction` spends a positive length in the water from t = 0 on: what
/// `water_enter` says with axis -1, in constant time.
bool water_holds(const WaterSurface& surface, const Vec3Q8& point, const Vec3i& direction);

/// Normal of the surface at a point above the columns, world coordinates in 1/256 voxel: between the centres
/// of columns the slopes are interpolated, so that there are no facets; at walls they are one-sided, and
/// blocked columns do not count. z is 2^14; x and y are at most 2^15 in magnitude (a slope of 2). Still
/// water: (0, 0, 2^14). It bends the light only: what is hit is the column.
Vec3i water_normal(const WaterSurface& surface, Q8 x, Q8 y);

/// Normal for light at a hit, out of the water, of length 2^14 .. 2^16: of the surface, also at the upright
/// face between two columns that hold water (it is part of a slope); of the face itself at the border, at
/// blocked columns and at the floor, and wherever the surface's normal would be seen from behind. `direction`
/// is the ray's, `x` and `y` the point's, world coordinates.
Vec3i water_hit_normal(const WaterSurface& surface, const WaterHit& hit, const Vec3i& direction, Q8 x, Q8 y);

}  // namespace thimble

#endif
