// The pixels that can show a box.
#include <doctest/doctest.h>

#include <random>

#include "support/wide_cases.h"
#include "wide/lit/miss_shader.h"

namespace thimble::tests {
namespace {

// Whether the line of a ray touches a box, its faces and edges included.
bool line_touches(const Ray& ray, const VoxelBox& box) {
  std::int64_t begin[3];
  std::int64_t end[3];
  std::int64_t speed[3];
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t low = std::int64_t{box.low[axis]} * 256 - ray.origin[axis].raw;
    const std::int64_t high = std::int64_t{box.high[axis]} * 256 - ray.origin[axis].raw;
    const bool down = ray.direction[axis] < 0;
    begin[axis] = down ? -high : low;
    end[axis] = down ? -low : high;
    speed[axis] = down ? -std::int64_t{ray.direction[axis]} : ray.direction[axis];
    if (speed[axis] == 0 && (low > 0 || high < 0)) {
      return false;
    }
  }
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) {
      if (speed[a] != 0 && speed[b] != 0 && begin[a] * speed[b] > end[b] * speed[a]) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

TEST_CASE("wide: pixels that can show a box -> no other ray touches it, most of theirs do") {
  std::mt19937_64 random(81);
  std::int64_t wrong = 0;
  std::int64_t beside = 0;
  std::int64_t touching = 0;
  std::int64_t idle = 0;
  WideScene scene;
  for (int trial = 0; trial < 400;) {
    if (trial % 8 == 0) {
      scene = random_scene(random);
    }
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    ++trial;
    CAPTURE(trial);
    VoxelBox box = scene.tree.bounds();
    if (pick(random, 0, 1) == 0) {
      box.low = random_voxel(random, 0, std::int64_t{1} << scene.level);
      const Vec3i size = random_voxel(random, 0, std::int64_t{1} << pick(random, 0, scene.level));
      box.high = {box.low.x + size.x, box.low.y + size.y, box.low.z + size.z};
    }
    const wide::PixelBox shown = wide::pixels_that_show(frame.camera, box);
    for (std::int32_t row = 0; row < frame.camera.height_px(); ++row) {
      for (std::int32_t x = 0; x < frame.camera.width_px(); ++x) {
        const bool touches = line_touches(frame.camera.ray(x, row), box);
        const bool can = shown.x0 <= x && x < shown.x1 && shown.y0 <= row && row < shown.y1;
        wrong += touches && !can ? 1 : 0;
        beside += can ? 0 : 1;
        touching += touches ? 1 : 0;
        idle += can && !touches ? 1 : 0;
      }
    }
  }
  CHECK(wrong == 0);
  CAPTURE(beside);
  CAPTURE(touching);
  CHECK(beside > 100000);
  CHECK(touching > 50000);
  CHECK(idle < touching);
}

}  // namespace thimble::tests
