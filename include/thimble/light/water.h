/// @file water.h
/// Water in columns: its geometry for a ray (`WaterSurface`), and how it moves (`Water`).
///
/// The geometry: columns of any height, hit by the exact rule. A plain view; whether the heights move is
/// nothing to it, and water that never moves is one level and no array.
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
///
/// Moving water: a small wave equation on columns, in the caller's bytes. Stepped only while it moves.
///
///      z            height above the floor of the water, one a column; what moves is held in 1/65536 voxel,
///      |  _   _     what is seen is rounded to 1/256
///      |_/ \_/ \_
///      |  |->|  |   flux through each edge between neighbours, volume a step: what one column loses the
///      |__|__|__|   other gets, so the volume is kept exactly, for ever
///       i-1  i  i+1
///
/// A step is one unit of time; a column is one voxel wide. Waves run with `wave_speed_q6` columns a step. The
/// scheme is staggered (fluxes first, from the heights; then heights, from the fluxes), its energy in the
/// sense of src/light/WATER.md never grows whatever the rounding, and a mirrored or turned world stays the
/// exact image of the other. All are integers: the same calls give one `state_crc32` on every machine.
///
/// Blocked columns (islands, walls) hold no water and reflect, as the border does. No volume passes between
/// basins that they part.
///
/// What it does not do: waves do not break or splash, nothing flows over a dry bank, the speed of waves does
/// not depend on the depth, floating bodies are not carried.
#ifndef THIMBLE_LIGHT_WATER_H
#define THIMBLE_LIGHT_WATER_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "../trace/ray.h"

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
/// water: (0, 0, 2^14). It bends the light only: what is hit is the column. `x` and `y` lie where a ray may
/// start (`check_ray`), or anywhere nearer; beyond the water the nearest column's slope holds.
Vec3i water_normal(const WaterSurface& surface, Q8 x, Q8 y);

/// Columns a side.
inline constexpr int32_t kMaxWaterSide = 4096;
/// Heights, in 1/256 voxel above the floor of the water: 4096 voxels.
inline constexpr int32_t kMaxWaterHeightQ8 = int32_t{1} << 20;
/// Half a column a step. The scheme is stable up to 0.707 (and not beyond, Courant, Friedrichs, Lewy 1928);
/// at half a column each of a column's four edges may also take a quarter of what is there, which is what
/// keeps heights within their limits without ever adding energy.
inline constexpr int32_t kMaxWaveSpeedQ6 = 32;
/// Slower waves would freeze on slopes that can be seen; step less often instead.
inline constexpr int32_t kMinWaveSpeedQ6 = 8;

struct WaterConfig {
  int32_t width = 0;           ///< columns along x, 1 .. kMaxWaterSide
  int32_t depth = 0;           ///< columns along y, 1 .. kMaxWaterSide
  int32_t rest_q8 = 0;         ///< height of the surface at rest, least_q8 .. greatest_q8
  int32_t least_q8 = 0;        ///< no column falls below, 0 .. greatest_q8
  int32_t greatest_q8 = 0;     ///< no column rises above, up to kMaxWaterHeightQ8
  int32_t wave_speed_q6 = 28;  ///< columns a step, kMinWaveSpeedQ6 .. kMaxWaveSpeedQ6
  int32_t damping_q12 = 24;    ///< share of its height that a wave loses a step, 0 .. 2048 (a half)
  ConstBytes blocked;          ///< a bit a column, row by row, the lowest bit first; empty: none is blocked
};

/// Bytes for `make` at any address: 8 a column (height 4, two fluxes of 2) and 4 a row; 0 when a side is out
/// of range. 32 x 32: 8,323; 64 x 64: 33,027.
constexpr size_t water_bytes(int32_t width, int32_t depth) {
  if (width < 1 || width > kMaxWaterSide || depth < 1 || depth > kMaxWaterSide) {
    return 0;
  }
  const size_t columns = static_cast<size_t>(width) * static_cast<size_t>(depth);
  return 8 * columns + 4 * static_cast<size_t>(depth) + 3;
}

class Water {
 public:
  /// Still water at the rest level. `bytes` outlive it and are all its memory; `config.blocked` is read here
  /// only. `kOutOfRange`: a number beyond its limits, the wave speed beyond the stability limit among them.
  /// `kBadArgument`: `blocked` has not (width * depth + 7) / 8 bytes. `kOutOfMemory`: fewer than
  /// `water_bytes`. Anything but `kOk` leaves `water` and `bytes` as they were.
  static Status make(const WaterConfig& config, Bytes bytes, Water* water);
  /// The same in an arena, which gives `water_bytes`; after an error it is as it was.
  static Status make(const WaterConfig& config, Arena& arena, Water* water) {
    return make_in(arena, water_bytes(config.width, config.depth), sizeof(uint32_t),
                   [&](Bytes bytes) { return make(config, bytes, water); });
  }

  // --- Disturbance. Points are relative to the first column's corner, in 1/256 voxel: column (i, j) is the
  // square from 256 * i, 256 * j on. A disturbance that is a mirror image, or turned by quarters, does the
  // mirror image.

  /// Presses the water down around a point by `depth_q8` (+-2^14, 64 voxels; negative pulls up), in the shape
  ///
  ///     -depth * (1 - s) * (1 - 3 s),  s = (distance / radius)^2:  a bowl with a rim a third as high
  ///
  /// What is pressed away goes up around, through open edges only. `radius_q8` 384 .. 2^14 (1.5 to 64 voxels;
  /// smaller is taken as 384: a bowl needs some columns). Where a height would leave its limits, the whole is
  /// made half as deep, a quarter ..., or is left out. The deepest column sinks by `depth_q8` to within 1 per
  /// cent where there are no walls near. `kOutOfRange`: beyond these limits, or the point beyond +-2^21.
  /// Cost: some 600 instructions for each column of the square around; more where limits are near.
  Status touch(int32_t x_q8, int32_t y_q8, int32_t radius_q8, int32_t depth_q8);

  /// A thing that falls in: its momentum becomes fluxes away from it, so that the water yields from the next
  /// step on. `mass_q8` in voxels of water (0 .. 2^20), `speed_q8` downwards in voxels a step (+-2^16,
  /// negative is a thing leaping out), point and radius as for `touch`, which should be the thing's own.
  /// Fluxes that would exceed half a voxel a step are cut to that. `kOutOfRange` beyond these limits.
  Status drop(int32_t x_q8, int32_t y_q8, int32_t radius_q8, int32_t mass_q8, int32_t speed_q8);

  // --- Time

  /// One step. Nothing at all when the water is still; else only columns that are not at rest and their
  /// neighbours are looked at, some 160 instructions each.
  void step();
  /// Whether every column is at the rest level and nothing flows. Once all heights are within 1/1024 voxel of
  /// the rest level and all fluxes below that a step, or the last two steps have taken nothing from the
  /// energy any more, the water is laid to rest exactly: flat, at the level of `make`, volume kept. What is
  /// laid flat is less than can be seen in the first case and bounded by src/light/WATER.md in the second.
  /// With damping 0 that may take for ever.
  bool is_still() const { return still_; }
  /// Steps that did something, and columns whose height they worked out.
  uint32_t steps_done() const { return steps_done_; }
  uint64_t columns_updated() const { return columns_updated_; }

  // --- What is there. Columns 0 .. width - 1, 0 .. depth - 1; the caller keeps to them.

  int32_t width() const { return width_; }
  int32_t depth() const { return depth_; }
  int32_t rest_q8() const { return rest_ >> 8; }
  bool is_blocked(int32_t x, int32_t y) const { return heights_[index(x, y)] < 0; }
  /// Height above the floor, to the nearest 1/256 voxel; 0 for a blocked column.
  int32_t height_q8(int32_t x, int32_t y) const { return (heights_[index(x, y)] + 128) >> 8; }
  /// The same in 1/65536 voxel, as it is held; -1 for a blocked column.
  int32_t height_q16(int32_t x, int32_t y) const { return heights_[index(x, y)]; }
  /// Flux from a column to the next along x (axis 0) or y (axis 1), in 1/65536 voxel a step, within +-32767.
  int32_t flux_q16(int axis, int32_t x, int32_t y) const {
    return (axis == 0 ? flux_x_ : flux_y_)[index(x, y)];
  }
  /// The least and the greatest height now, in 1/256 voxel, blocked columns left out.
  int32_t lowest_q8() const { return (lowest_ + 128) >> 8; }
  int32_t highest_q8() const { return (highest_ + 128) >> 8; }
  /// The water's geometry as the tracer wants it, its first column's floor at the voxel `corner`. It sees the
  /// heights as they change, but its bounds are of now: ask anew after every step and disturbance.
  WaterSurface surface(const Vec3i& corner) const;
  /// The same with another upper bound, at least that of now (1/256 voxel): nothing is met elsewhere, but more columns
  /// are looked at.
  WaterSurface surface_below(const Vec3i& corner, int32_t bound_q8) const {
    return {corner, width_, depth_, lowest_q8(), bound_q8, heights_, has_blocked_};
  }
  /// Sum of all heights, in 1/65536 cubic voxel: (columns not blocked) * 256 * rest_q8, always.
  uint64_t volume_q16() const;
  /// CRC-32 of the heights (4 bytes each, little-endian), row by row, then of the fluxes along x and along y
  /// (2 bytes each).
  uint32_t state_crc32() const;

 private:
  // Columns of a row that are not at rest (first .. end - 1); none when both are equal.
  struct RowSpan {
    uint16_t first;
    uint16_t end;
  };
  struct Bowl;
  struct Region;

  size_t index(int32_t x, int32_t y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  int32_t next_flux(int32_t here, int32_t there, int32_t flux);
  void edges_of_row(int32_t y, int32_t first, int32_t end);
  RowSpan heights_of_row(int32_t y, int32_t first, int32_t end);
  static Bowl bowl_at(int32_t x_q8, int32_t y_q8, int32_t radius_q8);
  static int32_t push(const Bowl& bowl, uint32_t squared);
  static int32_t push_at(const Bowl& bowl, int32_t x, int32_t y);
  int32_t loss(const Bowl& bowl, int32_t x, int32_t y) const;
  Region region(const Bowl& bowl, int32_t radius_q8) const;
  bool bears(const Bowl& bowl, const Region& region) const;
  void wake(const Region& region);
  void lay_to_rest();

  int32_t* heights_ = nullptr;
  int16_t* flux_x_ = nullptr;
  int16_t* flux_y_ = nullptr;
  RowSpan* spans_ = nullptr;
  int32_t width_ = 0;
  int32_t depth_ = 0;
  int32_t rest_ = 0;
  int32_t least_ = 0;
  int32_t greatest_ = 0;
  int32_t lowest_ = 0;
  int32_t highest_ = 0;
  int32_t speed_squared_q12_ = 0;
  int32_t steepest_ = 0;  // differences of height beyond this count as this
  uint32_t damping_q12_ = 0;
  uint32_t steps_done_ = 0;
  uint64_t columns_updated_ = 0;
  bool has_blocked_ = false;
  bool still_ = true;
  bool moving_ = false;   // some cut sum was not 0: the step was not quiet
  bool quiet_ = false;    // the step before was
  bool visible_ = false;  // the step has left something above the threshold
};

}  // namespace thimble

#endif
