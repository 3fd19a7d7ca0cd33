#include "scene/moving_pool.h"

namespace thimble::tools {

size_t MovingPool::bytes(const WaterSurface& rest) {
  const size_t columns = static_cast<size_t>(rest.width) * static_cast<size_t>(rest.depth);
  return water_bytes(rest.width, rest.depth) + columns / 8 + 64;
}

MovingPool::MovingPool(const CompactTree& tree, const WaterSurface& rest, Bytes memory) : rest_(rest) {
  Arena arena(memory);
  moves_ = apps::calm_water(tree, rest, &arena, &water_) == Status::kOk;
}

void MovingPool::step() {
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

WaterSurface MovingPool::surface() const {
  return moves_ ? apps::surface_of(water_, false) : rest_;
}

}  // namespace thimble::tools
