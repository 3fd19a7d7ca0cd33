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
  static size_t bytes(const WaterSurface& rest);
  MovingPool() = default;
  /// In bytes() of the caller's; water beyond the core's limits stays at rest.
  MovingPool(const CompactTree& tree, const WaterSurface& rest, Bytes memory);

  /// The next frame, the same in every run: two steps, and a drop somewhere now and then.
  void step();
  /// The water of now, valid until the next step.
  WaterSurface surface() const;

 private:
  WaterSurface rest_;
  apps::MovingWater water_;
  bool moves_ = false;
  uint32_t frames_ = 0;
  SplitMix64 random_{1};
};

}  // namespace thimble::tools
