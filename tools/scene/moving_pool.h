/// The water of a scene made to move, for somebody to look at: it rains. Integers, and nothing of a system: the page rains
/// by it, too.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "apps/moving_water.h"
#include "scene/random.h"

namespace thimble::tools {

class MovingPool {
 public:
  /// Frames from one drop to the next.
  static constexpr uint32_t kDropFrames = 12;

  /// For that water: 8 a column.
  static size_t bytes(const WaterSurface& rest) {
    const size_t columns = static_cast<size_t>(rest.width) * static_cast<size_t>(rest.depth);
    return water_bytes(rest.width, rest.depth) + columns / 8 + 64;
  }
  MovingPool() = default;
  /// In bytes() of the caller's; water beyond the core's limits stays at rest.
  MovingPool(const CompactTree& tree, const WaterSurface& rest, Bytes memory) : rest_(rest) {
    Arena arena(memory);
    moves_ = apps::calm_water(tree, rest, &arena, &water_) == Status::kOk;
  }

  /// The next frame, the same in every run: two steps, and a drop somewhere now and then.
  void step() {
    if (!moves_) {
      return;
    }
    if (frames_++ % kDropFrames == 0) {
      const int32_t side = rest_.width < rest_.depth ? rest_.width : rest_.depth;
      const int32_t twelfth_q8 = side * Q8::kOne / 12;
      const int32_t radius_q8 = twelfth_q8 < 384 ? 384 : twelfth_q8 > 4096 ? 4096 : twelfth_q8;
      const int32_t deepest_q8 = rest_.highest_q8 < radius_q8 ? rest_.highest_q8 / 2 : radius_q8 / 2;
      const int32_t x = random_.between(0, rest_.width * Q8::kOne - 1);
      const int32_t y = random_.between(0, rest_.depth * Q8::kOne - 1);
      // Out of range is a drop that misses.
      static_cast<void>(water_.columns.touch(x, y, radius_q8, deepest_q8));
    }
    for (int i = 0; i < apps::kStepsAFrame && !water_.columns.is_still(); ++i) {
      water_.columns.step();
    }
  }
  /// The water of now, valid until the next step.
  WaterSurface surface() const { return moves_ ? apps::surface_of(water_, false) : rest_; }

 private:
  WaterSurface rest_;
  apps::MovingWater water_;
  bool moves_ = false;
  uint32_t frames_ = 0;
  SplitMix64 random_{1};
};

}  // namespace thimble::tools
