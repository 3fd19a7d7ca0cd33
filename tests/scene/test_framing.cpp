// Framing: a box, seen from any side, fills the part of the picture that was wished and is seen whole.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "readers/source.h"
#include "scene/framing.h"
#include "thimble/trace/trace.h"
#include "thimble/tree/dense_grid.h"

namespace {

using namespace thimble;

constexpr int kLevel = 6;
const VoxelBox kBox{{10, 20, 5}, {50, 44, 37}};

// The box's eight corners, some voxels each.
class Corners {
 public:
  Corners() : bytes_(dense_grid_bytes({1 << kLevel, 1 << kLevel, 1 << kLevel})) {
    REQUIRE(DenseGrid::make({1 << kLevel, 1 << kLevel, 1 << kLevel}, Bytes(bytes_.data(), bytes_.size()),
                            &grid_) == Status::kOk);
    constexpr int kSide = 4;  // voxels that pixels cannot miss
    for (int i = 0; i < 8 * kSide * kSide * kSide; ++i) {
      Vec3i at;
      int rest = i;
      for (int axis = 0; axis < 3; ++axis, rest /= 2 * kSide) {
        const int step = rest % (2 * kSide);
        at[axis] = step < kSide ? kBox.low[axis] + step : kBox.high[axis] - 1 - (step - kSide);
      }
      REQUIRE(grid_.set(at) == Status::kOk);
    }
  }

  // How far out from the picture's middle hits go, of the way to its edge, on the axis where they go
  // farthest.
  double reach(const Camera& camera) const {
    double farthest = 0;
    for (std::int32_t y = 0; y < camera.height_px(); ++y) {
      for (std::int32_t x = 0; x < camera.width_px(); ++x) {
        Hit hit;
        REQUIRE(closest_hit(grid_, camera.ray(x, y), &hit) == Status::kOk);
        if (hit.kind == HitKind::kHit) {
          farthest = std::max({farthest, std::abs(2 * x + 1 - camera.width_px()) / (1.0 * camera.width_px()),
                               std::abs(2 * y + 1 - camera.height_px()) / (1.0 * camera.height_px())});
        }
      }
    }
    return farthest;
  }

 private:
  std::vector<std::uint8_t> bytes_;
  DenseGrid grid_;
};

}  // namespace

TEST_CASE("framing: any side, shape and projection -> the box fills as much of the picture as was wished") {
  const Corners corners;
  for (const tools::Real3& forward :
       {tools::kDefaultForward, tools::Real3{1, 0, 0}, tools::Real3{-3, 2, 9}, tools::Real3{0, 0, -1}}) {
    for (const double fill : {0.5, tools::kDefaultFill}) {
      for (const bool orthographic : {false, true}) {
        for (const bool tall : {false, true}) {
          tools::ViewWishes wishes;
          wishes.width_px = tall ? 60 : 160;
          wishes.height_px = tall ? 140 : 90;
          wishes.orthographic = orthographic;
          wishes.forward = forward;
          wishes.fill = fill;
          const tools::Framing framing = tools::frame_box(wishes, kLevel, kBox);
          CAPTURE(forward[0]);
          CAPTURE(forward[2]);
          CAPTURE(fill);
          CAPTURE(orthographic);
          CAPTURE(tall);
          CHECK(framing.note.empty());
          CHECK(framing.kept.is_perspective == !orthographic);
          const double reach = corners.reach(framing.camera);
          CHECK(reach <= fill + 0.001);
          CHECK(reach >= fill - 0.06);  // less than three pixels
        }
      }
    }
  }
}

TEST_CASE("framing: the same wishes -> the same camera; what it keeps makes it again") {
  for (const bool orthographic : {false, true}) {
    tools::ViewWishes wishes;
    wishes.orthographic = orthographic;
    const tools::Framing one = tools::frame_box(wishes, kLevel, kBox);
    Camera again;
    REQUIRE(set_camera(one.kept, wishes.width_px, wishes.height_px, kLevel, &again) == Status::kOk);
    for (const std::int32_t x : {0, 399, 799}) {
      CHECK(again.ray(x, 300).origin == one.camera.ray(x, 300).origin);
      CHECK(again.ray(x, 300).direction == one.camera.ray(x, 300).direction);
    }
  }
}

TEST_CASE("framing: too near to see all -> a note; a direction of nothing -> a sentence") {
  tools::ViewWishes narrow;
  narrow.fov_degrees = 1;
  CHECK_FALSE(tools::frame_box(narrow, kLevel, kBox).note.empty());
  tools::ViewWishes nowhere;
  nowhere.eye = nowhere.target = tools::Real3{1, 2, 3};
  CHECK_THROWS_AS((void)tools::frame_box(nowhere, kLevel, kBox), tools::InputError);
  CHECK_THROWS_AS((void)tools::finer({}, 64), tools::InputError);
}
