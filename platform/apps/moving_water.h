/// The water of a lit scene made to move: its columns in the caller's bytes, where they are blocked, what
/// touches them.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/light/scene.h"
#include "thimble/light/water.h"
#include "thimble/trace/ray.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::apps {

/// Waves run by not quite a column a frame: two steps of 28/64.
inline constexpr int kStepsAFrame = 2;

struct MovingWater {
  Water columns;
  Vec3i corner;
  Bytes bytes;              ///< of the columns
  int32_t greatest_q8 = 0;  ///< no column ever rises above
};

/// Whether a column is solid from the floor of the water to its surface at rest: it then holds none, and
/// reflects. What floats is not: water is below it.
inline bool is_filled(const CompactTree& tree, const WaterSurface& rest, int32_t x, int32_t y) {
  const int32_t top = (rest.highest_q8 + Q8::kOne - 1) >> Q8::kBits;
  for (int32_t z = 0; z < top; ++z) {
    if (!material_at(tree, {rest.corner.x + x, rest.corner.y + y, rest.corner.z + z}, nullptr)) {
      return false;
    }
  }
  return true;
}

/// Water at rest as the scene has it. Bytes are taken from the arena the first time; a bit a column more is
/// used behind them while this runs. Waves are limited to an eighth of the world's side up and down.
/// Errors: kOutOfMemory; those of Water::init.
[[gnu::noinline]] inline Status calm_water(const CompactTree& tree, const WaterSurface& rest, Arena* arena,
                                           MovingWater* water) {
  if (water->bytes.empty()) {
    water->bytes = arena->take(water_bytes(rest.width, rest.depth));
  }
  const size_t columns = static_cast<size_t>(rest.width) * static_cast<size_t>(rest.depth);
  const Bytes scratch = arena->rest().subspan(0, (columns + 7) / 8);
  if (water->bytes.empty() || scratch.size < (columns + 7) / 8) {
    return Status::kOutOfMemory;
  }
  arena->note_scratch(scratch.size);
  for (uint8_t& byte : scratch) {
    byte = 0;
  }
  size_t bit = 0;
  for (int32_t y = 0; y < rest.depth; ++y) {
    for (int32_t x = 0; x < rest.width; ++x, ++bit) {
      if (is_filled(tree, rest, x, y)) {
        scratch.data[bit >> 3] = static_cast<uint8_t>(scratch.data[bit >> 3] | 1U << (bit & 7U));
      }
    }
  }
  WaterConfig config;
  config.width = rest.width;
  config.depth = rest.depth;
  config.rest_q8 = rest.highest_q8;
  const int32_t waves = int32_t{Q8::kOne / 8} << tree.level();
  const int32_t sky = ((int32_t{1} << tree.level()) - rest.corner.z) * Q8::kOne;
  config.least_q8 = config.rest_q8 > waves ? config.rest_q8 - waves : 0;
  config.greatest_q8 = config.rest_q8 < sky - waves ? config.rest_q8 + waves : sky;
  if (config.greatest_q8 < config.rest_q8) {
    config.greatest_q8 = config.rest_q8;
  }
  config.blocked = scratch;
  const Status status = Water::make(config, water->bytes, &water->columns);
  if (status == Status::kOk) {
    water->corner = rest.corner;
    water->greatest_q8 = config.greatest_q8;
  }
  return status;
}

/// The surface of now. `ever` makes its bounds those of all waves to come: nothing is met elsewhere, but more
/// columns are looked at, and every ray that waves could change looks at one.
inline WaterSurface surface_of(const MovingWater& water, bool ever) {
  return ever ? water.columns.surface_below(water.corner, water.greatest_q8)
              : water.columns.surface(water.corner);
}

/// Where the ray comes upon the upper side of the water before anything solid: x and y in 1/256 voxel from
/// the first column's corner. False where it does not.
[[gnu::noinline]] inline bool find_surface(const CompactTree& tree, const MovingWater& water, const Ray& ray,
                                           int32_t* x_q8, int32_t* y_q8) {
  const WaterSurface surface = surface_of(water, false);
  WaterHit wet;
  Hit solid;
  if (!water_enter(surface, ray, &wet) || wet.axis < 0 || wet.side < 0 ||
      closest_hit(tree, ray, &solid) != Status::kOk) {
    return false;
  }
  if (solid.kind == HitKind::kHit &&
      int64_t{solid.t_numerator} * wet.t_denominator <= int64_t{wet.t_numerator} * solid.t_denominator) {
    return false;
  }
  const Vec3i low{(surface.corner.x + wet.column_x) * Q8::kOne, (surface.corner.y + wet.column_y) * Q8::kOne,
                  surface.corner.z * Q8::kOne};
  const Vec3i high{low.x + Q8::kOne, low.y + Q8::kOne, low.z + surface.height_q8(wet.column_x, wet.column_y)};
  const Vec3Q8 at = start_on_plane(ray, wet.axis, high[wet.axis], low, high);
  *x_q8 = at.x.raw - surface.corner.x * Q8::kOne;
  *y_q8 = at.y.raw - surface.corner.y * Q8::kOne;
  return true;
}

}  // namespace thimble::apps
