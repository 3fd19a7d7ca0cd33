#include "viewer/moving_pool.h"

#include <algorithm>

namespace thimble::tools::viewer {

MovingPool::MovingPool(const CompactTree& tree, const WaterSurface& rest) : rest_(rest) {
  const auto columns = static_cast<std::size_t>(rest.width) * static_cast<std::size_t>(rest.depth);
  memory_ = HostMemory(water_bytes(rest.width, rest.depth) + columns / 8 + 64);
  Arena arena(memory_.bytes());
  moves_ = apps::calm_water(tree, rest, &arena, &water_) == Status::kOk;
}

void MovingPool::step() {
  if (!moves_) {
    return;
  }
  if (frames_++ % kDropFrames == 0) {
    const std::int32_t radius_q8 = std::clamp(std::min(rest_.width, rest_.depth) * Q8::kOne / 12, 384, 4096);
    const std::int32_t x = random_.between(0, rest_.width * Q8::kOne - 1);
    const std::int32_t y = random_.between(0, rest_.depth * Q8::kOne - 1);
    // Out of range is a drop that misses.
    static_cast<void>(water_.columns.touch(x, y, radius_q8, std::min(radius_q8 / 2, rest_.highest_q8 / 2)));
  }
  for (int i = 0; i < apps::kStepsAFrame && !water_.columns.is_still(); ++i) {
    water_.columns.step();
  }
}

WaterSurface MovingPool::surface() const {
  return moves_ ? apps::surface_of(water_, false) : rest_;
}

}  // namespace thimble::tools::viewer
