/// @file moving_pool.h
/// The water of a scene made to move, for somebody to look at: it rains.
#ifndef THIMBLE_TOOLS_VIEWER_MOVING_POOL_H
#define THIMBLE_TOOLS_VIEWER_MOVING_POOL_H

#include <cstdint>

#include "apps/moving_water.h"
#include "scene/host_memory.h"
#include "scene/random.h"

namespace thimble::tools::viewer {

class MovingPool {
 public:
  /// Frames from one drop to the next.
  static constexpr std::uint32_t kDropFrames = 12;

  /// 8 bytes a column; water beyond the core's limits stays at rest.
  MovingPool(const CompactTree& tree, const WaterSurface& rest);

  /// The next frame, the same in every run: two steps, and a drop somewhere now and then.
  void step();
  /// The water of now, valid until the next step.
  WaterSurface surface() const;

 private:
  WaterSurface rest_;
  HostMemory memory_;
  apps::MovingWater water_;
  bool moves_ = false;
  std::uint32_t frames_ = 0;
  SplitMix64 random_{1};
};

}  // namespace thimble::tools::viewer

#endif
