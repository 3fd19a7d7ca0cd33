// Rays to lamps go through the air by layers of empty bricks at once: what hangs there hides the lamp wherever it is,
// and to the pixel.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <random>

#include "support/counts.h"
#include "support/map_world.h"
#include "support/ray_cases.h"

namespace thimble::testing::map_layers {
namespace {

using tests::many_or_few;
using tests::pick_int;

constexpr int kWide = 44;
constexpr int kHigh = 32;
constexpr EffectSet kByLamps = Effect::kDirectLight | Effect::kShadows | Effect::kEmitterLight;
constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);

struct LampWorld : MapWorld {
  explicit LampWorld(int level) : MapWorld(level), side(1 << level) { lights.clear(); }
  /// A wall through the world.
  void wall(int place, int axis) {
    Vec3i low{};
    Vec3i high{side, side, side};
    low[axis] = place;
    high[axis] = place + 1;
    box(low, high, 1);
  }
  /// The picture by the map is the tree's, and sends the same rays of light.
  BothCounts compare() const {
    const BothCounts both = draw_both<kByLamps>(*this);
    REQUIRE(both.by_map.rays[kShadow] == both.by_tree.rays[kShadow]);
    return both;
  }

  int side;
};

TEST_CASE("lamps by the map: voxels that hang in the air, empty bricks around them -> the tree's shadows") {
  std::mt19937_64 random(20261125);
  std::uint64_t hidden = 0;
  std::uint64_t reached = 0;
  for (int turn = 0; turn < 360; ++turn) {
    CAPTURE(turn);
    const int level = 5 + turn % 2;
    const int side = 1 << level;
    const int axis = turn % 3;
    const bool high = turn / 3 % 2 != 0;
    // A wall all over one side of the world, and a few voxels in the air before it, in clusters.
    LampWorld world(level);
    world.wall(high ? side - 1 : 0, axis);
    Vec3i hanging{};
    for (int i = 0; i < turn % 40 * 4; ++i) {
      for (int other = 0; other < 3; ++other) {
        hanging[other] = i % 12 == 0 ? pick_int(random, 0, side - 1)
                                     : std::clamp(hanging[other] + pick_int(random, -1, 1), 0, side - 1);
      }
      world.voxel(hanging, 1);
    }
    const auto anywhere = [&](int grain) { return pick_int(random, 0, 256 * side) / grain * grain; };
    // From across the world towards some place of the wall.
    Vec3i eye{};
    Vec3i target{};
    for (int i = 0; i < 3; ++i) {
      eye[i] = i == axis ? (high ? 0 : 256 * side) : anywhere(1);
      target[i] = i == axis ? (high ? 256 * side : 0) : anywhere(1);
    }
    for (int lamps = turn / 6 % 2 == 0 ? 1 : 2; lamps > 0; --lamps) {
      const int grain = turn % 4 == 0 ? 256 : turn % 4 == 1 ? 1024 : 1;
      Vec3i place{};
      for (int i = 0; i < 3; ++i) {
        place[i] = anywhere(grain);
      }
      world.lights.push_back(lamp(place, 900, 60));
    }
    world.map_it();
    world.look(eye, target, 50, kWide, kHigh);
    const BothCounts both = world.compare();
    CHECK(both.by_map.node_visits[kShadow] <= both.by_tree.node_visits[kShadow] / 4);
    hidden += both.by_map.hits[kShadow];
    reached += both.by_map.rays[kShadow] - both.by_map.hits[kShadow];
  }
  // Both happen often, or else nothing was tested.
  CHECK(hidden > 10000);
  CHECK(reached > 100000);
}

// A ray to a lamp ends in the voxel that it hangs in, whatever the number of layers before that.
TEST_CASE("lamps by the map: a wall two voxels behind a lamp, near and far -> no ray meets it") {
  constexpr int kNear = 3;
  for (int way = 6; way <= 40; ++way) {
    CAPTURE(way);
    LampWorld world(6);
    world.wall(kNear, 0);
    world.wall(kNear + way + 3, 0);
    world.lights = {lamp({256 * (kNear + 1 + way) + 100, 32 * 256 + 30, 32 * 256 - 50}, 900, 60)};
    world.map_it();
    const Vec3i eye{256 * (kNear + 3), 32 * 256, 32 * 256};
    world.look(eye, {0, eye.y, eye.z}, 20, kWide, kHigh);
    const BothCounts both = world.compare();
    CHECK(both.by_map.rays[kShadow] == kWide * kHigh);
    CHECK(both.by_map.hits[kShadow] == 0);
  }
}

// The middle pixel meets a wall on a corner of bricks; from there the ray to the lamp crosses planes of bricks on two
// axes or on all three at the same time, once or again and again. What hangs beside its way hides the lamp only where
// the ray spends a length in it.
TEST_CASE("lamps by the map: planes of bricks crossed at the same time -> the tree's shadows") {
  std::mt19937_64 random(20261126);
  constexpr int kPicture = 3;
  constexpr int kLevel = 6;
  constexpr int kSide = 1 << kLevel;
  // Bricks that the ray goes along the wall's axis and the other two.
  constexpr int kWays[][3] = {{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}, {2, 2, 1}, {1, 2, 2},
                              {3, 1, 1}, {1, 3, 1}, {1, 0, 1}, {2, 1, 0}, {1, 3, 3}, {4, 3, 2}};
  int hidden = 0;
  int reached = 0;
  const int turns = many_or_few(6000, 1200);
  for (int turn = 0; turn < turns; ++turn) {
    CAPTURE(turn);
    const int axis = turn % 3;
    const bool high = turn / 3 % 2 != 0;
    const int(&way)[3] = kWays[static_cast<std::size_t>(turn / 6) % std::size(kWays)];
    // Where the ray begins, and how it goes, in voxels; on half of the turns off the corner along one axis.
    Vec3i start{};
    Vec3i step{};
    for (int i = 0; i < 3; ++i) {
      const int other = (axis + i) % 3;
      const bool down = i == 0 ? high : pick_int(random, 0, 1) != 0;
      start[other] =
          i == 0 ? (high ? kSide - 4 : 4) : 4 * (down ? pick_int(random, 8, 15) : pick_int(random, 1, 8));
      step[other] = (down ? -4 : 4) * way[i];
    }
    const int off = (axis + pick_int(random, 1, 2)) % 3;
    start[off] += turn % 2 * pick_int(random, 0, 3);
    int times = 0;
    const auto fits = [&](int count) {
      bool all = true;
      for (int i = 0; i < 3; ++i) {
        const int end = start[i] + count * step[i];
        all = all && end >= 0 && end <= kSide;
      }
      return all;
    };
    while (fits(times + 1)) {
      ++times;
    }
    REQUIRE(times > 0);
    // The wall, and voxels that touch the ray's way or stand in it.
    LampWorld world(kLevel);
    world.wall(high ? kSide - 4 : 3, axis);
    for (int i = pick_int(random, 1, 3); i > 0; --i) {
      const int along = pick_int(random, 1, 4 * times);
      Vec3i at{};
      bool in_air = true;
      for (int other = 0; other < 3; ++other) {
        at[other] = start[other] + along * step[other] / 4 - pick_int(random, 0, 1);
        in_air = in_air && at[other] >= 0 && at[other] < kSide;
      }
      in_air = in_air && (high ? at[axis] < kSide - 4 : at[axis] > 3);
      if (in_air) {
        world.voxel(at, 1);
      }
    }
    const auto on_way = [&](int count) {
      return Vec3i{256 * (start.x + count * step.x), 256 * (start.y + count * step.y),
                   256 * (start.z + count * step.z)};
    };
    world.lights = {lamp(on_way(times), 2000, 200)};
    world.map_it();
    // The eye looks straight at the wall from before everything that hangs.
    Vec3i eye = on_way(0);
    eye[axis] += high ? -256 : 256;
    world.look(eye, on_way(0), 10, kPicture, kPicture);
    const BothCounts both = world.compare();
    hidden += both.by_tree.hits[kShadow] != 0 ? 1 : 0;
    reached += both.by_map.rays[kShadow] != both.by_tree.hits[kShadow] ? 1 : 0;
  }
  CAPTURE(hidden);
  CAPTURE(reached);
  CHECK(hidden > turns / 60);
  CHECK(reached > turns / 6);
}

}  // namespace
}  // namespace thimble::testing::map_layers
