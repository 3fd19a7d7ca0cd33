// Framing: a box, seen from any side, fills the part of the picture that was wished and is seen whole.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "apps/demo_view.h"
#include "readers/oct.h"
#include "readers/source.h"
#include "scene/framing.h"
#include "scene/scene_source.h"
#include "support/scene_under_test.h"
#include "thimble/trace/ray.h"

namespace {

using namespace thimble;

constexpr int kLevel = 6;
const VoxelBox kBox{{10, 20, 5}, {50, 44, 37}};

// A tree in bytes of its own.
struct Packed {
  explicit Packed(const Octree& octree)
      : bytes(tests::compact_of(octree)), tree(tests::open_or_throw(bytes)) {}
  tests::HeapBytes bytes;
  CompactTree tree;
};

// The box's eight corners, some voxels each.
Packed corners() {
  tests::OwnedPool pool(kLevel);
  constexpr int kSide = 4;  // voxels that pixels cannot miss
  for (int i = 0; i < 8 * kSide * kSide * kSide; ++i) {
    Vec3i at;
    int rest = i;
    for (int axis = 0; axis < 3; ++axis, rest /= 2 * kSide) {
      const int step = rest % (2 * kSide);
      at[axis] = step < kSide ? kBox.low[axis] + step : kBox.high[axis] - 1 - (step - kSide);
    }
    REQUIRE(pool.octree.insert(at) == Status::kOk);
  }
  return Packed(pool.octree);
}

// Where hits lie on the picture, as parts of its half width and height from the middle.
struct Reach {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  double farthest() const { return std::max({-left, right, -top, bottom}); }
};
Reach reach_of(const CompactTree& tree, const Camera& camera) {
  Reach reach;
  for (std::int32_t y = 0; y < camera.height_px(); ++y) {
    for (std::int32_t x = 0; x < camera.width_px(); ++x) {
      Hit hit;
      REQUIRE(closest_hit(tree, camera.ray(x, y), &hit) == Status::kOk);
      if (hit.kind == HitKind::kHit) {
        const double across = (2.0 * x + 1) / camera.width_px() - 1;
        const double down = (2.0 * y + 1) / camera.height_px() - 1;
        reach = {std::min(reach.left, across), std::max(reach.right, across), std::min(reach.top, down),
                 std::max(reach.bottom, down)};
      }
    }
  }
  return reach;
}

}  // namespace

TEST_CASE("framing: any side, shape and projection -> the box fills as much of the picture as was wished") {
  const Packed world = corners();
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
          const double reach = reach_of(world.tree, framing.camera).farthest();
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
  CHECK_THROWS_AS((void)tools::frame_box(nowhere, kLevel, kBox), tools::FramingError);
  CHECK_THROWS_AS((void)tools::finer({}, 64), tools::InputError);
}

namespace {

// A staircase of balls: nothing of it is near the corners of its box.
Packed balls() {
  tests::OwnedPool pool(kLevel);
  for (const Vec3i& center : {Vec3i{16, 14, 12}, Vec3i{36, 30, 26}, Vec3i{48, 20, 44}}) {
    for (int i = 0; i < 17 * 17 * 17; ++i) {
      const Vec3i off{i % 17 - 8, i / 17 % 17 - 8, i / 289 - 8};
      if (off.x * off.x + off.y * off.y + off.z * off.z <= 64) {
        const Vec3i at{center.x + off.x, center.y + off.y, center.z + off.z};
        REQUIRE(pool.octree.insert(at) == Status::kOk);
      }
    }
  }
  return Packed(pool.octree);
}

constexpr tools::NamedView kSides[] = {
    tools::NamedView::kBest, tools::NamedView::kIso,   tools::NamedView::kFront, tools::NamedView::kBack,
    tools::NamedView::kLeft, tools::NamedView::kRight, tools::NamedView::kTop};

}  // namespace

TEST_CASE(
    "scene shape: worlds of points and blocks -> as far in any direction as all that is solid; voxels by "
    "number") {
  std::mt19937_64 random(7);
  for (const int level : {1, 3, 6, 10, 11, 12}) {
    for (int world = 0; world < 8; ++world) {
      tests::OwnedPool pool(level);
      const auto any_place = [&](int of) { return static_cast<std::int32_t>(random() >> (64 - of)); };
      for (int i = 0; i < 1 + 40 * world; ++i) {
        const int block = random() % 4 == 0 ? static_cast<int>(random() % static_cast<unsigned>(level)) : 0;
        const std::int32_t inside = ~((1 << block) - 1);
        REQUIRE(pool.octree.insert_block(
                    {any_place(level) & inside, any_place(level) & inside, any_place(level) & inside}, block,
                    0) == Status::kOk);
      }
      const Packed packed(pool.octree);
      const CompactTree& tree = packed.tree;
      std::uint32_t number = tree.node_count();
      tools::walk_blocks(tree, [&](const Vec3i& corner, int of, std::uint8_t) {
        CHECK((of != 0 || tools::corner_of(tree, number++) == corner));
      });
      const std::vector<Vec3i> corners = tools::shape_of(tree).corners;
      const std::int32_t step = level <= 10 ? 1 : 1 << (level - 10);
      for (int direction = 0; direction < 30; ++direction) {
        const Vec3i along{any_place(8) - 128, any_place(8) - 128, any_place(8) - 128};
        std::int64_t farthest = INT64_MIN;
        tools::walk_blocks(tree, [&](const Vec3i& corner, int of, std::uint8_t) {
          std::int64_t at = 0;
          for (int axis = 0; axis < 3; ++axis) {
            const std::int32_t high = (corner[axis] + (1 << of) + step - 1) / step * step;
            at += std::int64_t{along[axis]} * (along[axis] > 0 ? high : corner[axis] / step * step);
          }
          farthest = std::max(farthest, at);
        });
        std::int64_t found = INT64_MIN;
        for (const Vec3i& corner : corners) {
          found = std::max(found, std::int64_t{along.x} * corner.x + std::int64_t{along.y} * corner.y +
                                      std::int64_t{along.z} * corner.z);
        }
        CHECK(found == farthest);
      }
    }
  }
}

TEST_CASE("framing: every named view and shape -> what is occupied fills 90 % of the tighter side, centred") {
  const Packed world = balls();
  const tools::SceneShape shape = tools::shape_of(world.tree);
  for (const tools::NamedView side : kSides) {
    for (const bool orthographic : {false, true}) {
      for (const bool tall : {false, true}) {
        for (const double turn : {0.0, 33.0}) {
          tools::ViewWishes wishes;
          wishes.width_px = tall ? 150 : 260;
          wishes.height_px = tall ? 240 : 160;
          wishes.orthographic = orthographic;
          wishes.side = side;
          wishes.onward.turn = turn;
          wishes.fov_degrees = tools::kPictureFov;
          CAPTURE(static_cast<int>(side));
          CAPTURE(orthographic);
          CAPTURE(tall);
          CAPTURE(turn);
          const Reach reach = reach_of(world.tree, tools::frame_shape(wishes, shape).camera);
          const double across = (reach.right - reach.left) / 2;
          const double down = (reach.bottom - reach.top) / 2;
          CHECK(std::max(across, down) <= tools::kPictureFill + 0.001);
          CHECK(std::max(across, down) >= tools::kPictureFill - 0.025);  // two pixels
          CHECK(std::abs(reach.left + reach.right) < 0.04);
          CHECK(std::abs(reach.top + reach.bottom) < 0.04);
        }
      }
    }
  }
}

TEST_CASE("framing: front looks along +y, left along +x, top down with the front below; turns add up") {
  const Packed world = balls();
  const tools::SceneShape shape = tools::shape_of(world.tree);
  const auto forward = [&](tools::NamedView side, double turn, double tilt) {
    tools::ViewWishes wishes;
    wishes.side = side;
    wishes.onward = {turn, tilt};
    const Vec3i raw = tools::frame_shape(wishes, shape).kept.forward;
    const auto unit = [](std::int32_t value) {
      return static_cast<int>(std::lround(value / 1073741824.0 * 8));
    };
    return Vec3i{unit(raw.x), unit(raw.y), unit(raw.z)};
  };
  using tools::NamedView;
  CHECK(forward(NamedView::kFront, 0, 0) == Vec3i{0, 8, 0});
  CHECK(forward(NamedView::kBack, 0, 0) == Vec3i{0, -8, 0});
  CHECK(forward(NamedView::kLeft, 0, 0) == Vec3i{8, 0, 0});
  CHECK(forward(NamedView::kRight, 0, 0) == Vec3i{-8, 0, 0});
  CHECK(forward(NamedView::kTop, 0, 0) == Vec3i{0, 0, -8});
  CHECK(forward(NamedView::kFront, 90, 0) == forward(NamedView::kRight, 0, 0));
  CHECK(forward(NamedView::kFront, 0, 500) == forward(NamedView::kTop, 0, 0));
  CHECK(forward(NamedView::kBest, 180, 0).x == -forward(NamedView::kBest, 0, 0).x);
}

TEST_CASE("framing: best, iso -> the side with the many colours, from the front where sides are alike") {
  const auto painted = [](int axis, bool high, tools::NamedView view = tools::NamedView::kBest) {
    // A cube whose one side is a checkerboard of materials.
    tests::OwnedPool pool(5);
    Octree& octree = pool.octree;
    for (int i = 0; i < 16 * 16 * 16; ++i) {
      const Vec3i at{i % 16 + 8, i / 16 % 16 + 8, i / 256 + 8};
      const bool on_side = axis >= 0 && at[axis] == (high ? 23 : 8);
      REQUIRE(octree.insert(at, static_cast<std::uint8_t>(on_side ? 1 + i % 200 : 0)) == Status::kOk);
    }
    const Packed packed(octree);
    const CompactTree& tree = packed.tree;
    return tools::best_angles(tools::shape_of(tree), view);
  };
  const auto plain = painted(-1, false);
  CHECK(plain.turn == -35);
  CHECK(std::abs(painted(1, false).turn) < 90);
  CHECK(std::abs(painted(1, true).turn) > 90);
  CHECK(painted(0, false).turn < 0);
  CHECK(painted(0, true).turn > 0);
  const auto corner = [&](int axis, bool high) { return painted(axis, high, tools::NamedView::kIso).turn; };
  CHECK(corner(-1, false) == -45);
  CHECK(std::abs(corner(1, true)) == 135);
  CHECK(corner(0, true) == 45);
}

TEST_CASE("framing: best of one material -> from the front, though the back has more faces") {
  for (const std::uint8_t of_back : {std::uint8_t{0}, std::uint8_t{1}}) {
    tests::OwnedPool pool(5);
    Octree& octree = pool.octree;
    for (int i = 0; i < 16 * 16; ++i) {
      for (int y = 8; y < 16; ++y) {
        REQUIRE(octree.insert({8 + i % 16, y, 8 + i / 16}, 0) == Status::kOk);
      }
      // A flight of steps behind.
      for (int y = 16; y < 32 - i / 16; ++y) {
        REQUIRE(octree.insert({8 + i % 16, y, 8 + i / 16}, of_back) == Status::kOk);
      }
    }
    const Packed packed(octree);
    const CompactTree& tree = packed.tree;
    CHECK((std::abs(tools::best_angles(tools::shape_of(tree)).turn) > 90) == (of_back != 0));
  }
}

TEST_CASE(
    "framing: round -> the demonstration's whole turn has everything in the picture, and no picture is "
    "small") {
  // A bar with a mast at its end, which is far from the middle of its box.
  tests::OwnedPool pool(5);
  Octree& octree = pool.octree;
  for (int i = 2; i < 30; ++i) {
    REQUIRE(octree.insert({i, 20, 4}, 0) == Status::kOk);
    REQUIRE(octree.insert({2, 20, 2 + i / 2}, 0) == Status::kOk);
  }
  const Packed packed(octree);
  const CompactTree& tree = packed.tree;
  const tools::SceneShape shape = tools::shape_of(tree);
  tools::SceneArguments arguments;
  arguments.scene = "points:1,depth=5";
  const auto source = tools::open_scene(arguments);  // without a camera of its own
  for (const auto& [each_width, height] : {std::pair{128, 64}, {96, 96}, {48, 96}}) {
    const auto& width = each_width;
    CAPTURE(width);
    tools::ViewWishes wishes;
    wishes.side = tools::NamedView::kBest;
    wishes.fov_degrees = tools::kPictureFov;
    wishes.width_px = width;
    wishes.height_px = height;
    // Pixels that meet something within `margin` pixels of the picture's edges, in all of a turn.
    const auto met = [&, width = width, height = height](const SceneCamera& kept, int margin) {
      const apps::Orbit orbit = apps::orbit_of(kept);
      int pixels = 0;
      for (std::uint32_t frame = 0; frame < apps::kFramesARound; ++frame) {
        Camera camera;
        REQUIRE(apps::view_at(orbit, tree, frame, {}, width, height, &camera) == Status::kOk);
        for (int i = 0; i < width * height; ++i) {
          const int x = i % width;
          const int y = i / width;
          if (std::min({x, y, width - 1 - x, height - 1 - y}) < margin) {
            Hit hit;
            REQUIRE(closest_hit(tree, camera.ray(x, y), &hit, {}) == Status::kOk);
            pixels += hit.kind == HitKind::kHit ? 1 : 0;
          }
        }
      }
      return pixels;
    };
    const SceneCamera round = tools::frame_round(wishes, *source, shape).kept;
    CHECK(met(round, 1) == 0);
    CHECK(met(round, std::min(width, height) / 6) > 0);
    CHECK(met(tools::frame_shape(wishes, shape).kept, 1) > 0);
  }
}

TEST_CASE("framing: a turn of pictures -> one eye's distance, evenly round, everything in every picture") {
  const Packed world = balls();
  const tools::SceneShape shape = tools::shape_of(world.tree);
  tools::ViewWishes wishes;
  wishes.side = tools::NamedView::kBest;
  wishes.width_px = 120;
  wishes.height_px = 90;
  wishes.fov_degrees = tools::kPictureFov;
  const std::vector<tools::Framing> turns = tools::frame_turns(wishes, shape, 8);
  REQUIRE(turns.size() == 8);
  double widest = 0;
  for (const tools::Framing& framing : turns) {
    widest = std::max(widest, reach_of(world.tree, framing.camera).farthest());
    CHECK(framing.kept.eye.z == turns[0].kept.eye.z);
  }
  CHECK(widest <= tools::kPictureFill + 0.001);
  CHECK(widest >= tools::kPictureFill - 0.05);
}

TEST_CASE("framing: nothing occupied, one voxel, a whole world -> a camera all the same") {
  for (const int voxels : {0, 1, 64}) {
    tests::OwnedPool pool(2);
    Octree& octree = pool.octree;
    for (int i = 0; i < voxels; ++i) {
      REQUIRE(octree.insert({i % 4, i / 4 % 4, i / 16}) == Status::kOk);
    }
    const Packed packed(octree);
    const CompactTree& tree = packed.tree;
    for (const tools::NamedView side : kSides) {
      for (const bool orthographic : {false, true}) {
        tools::ViewWishes wishes;
        wishes.side = side;
        wishes.orthographic = orthographic;
        wishes.fov_degrees = tools::kPictureFov;
        CAPTURE(voxels);
        CAPTURE(static_cast<int>(side));
        CHECK_NOTHROW((void)tools::frame_shape(wishes, tools::shape_of(tree)));
      }
    }
  }
}
