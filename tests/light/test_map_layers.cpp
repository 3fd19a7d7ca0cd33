// Rays to lamps go through the air by layers of empty bricks at once: what hangs there hides the lamp wherever it is,
// and to the pixel.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "support/counts.h"
#include "support/ray_cases.h"
#include "thimble/light/map_render.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

constexpr int kWide = 44;
constexpr int kHigh = 32;
constexpr EffectSet kByLamps = Effect::kDirectLight | Effect::kShadows | Effect::kEmitterLight;

constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);

struct Drawn {
  std::vector<std::uint8_t> bytes;
  LitCounts counts;
  std::uint64_t visits_by_tree = 0;
  std::uint64_t hits_by_tree = 0;
};
// The picture by the map, which is the tree's and sends the same rays of light.
Drawn drawn(const ChipScene& scene, const Camera& camera, const LitScene& lit) {
  Drawn both[2];
  const Shading shading;
  for (int by_map = 0; by_map < 2; ++by_map) {
    Drawn& made = both[by_map];
    made.bytes.resize(band_bytes(PixelFormat::kRgb888, camera.width_px(), camera.height_px()));
    const Band band{{made.bytes.data(), made.bytes.size()}, PixelFormat::kRgb888, 0, 0, camera.height_px()};
    REQUIRE((by_map != 0 ? render_lit_band<kByLamps>(scene.tree, scene.map, camera, shading, lit, {}, band,
                                                     &made.counts)
                         : render_lit_band<kByLamps>(scene.tree, camera, shading, lit, band, &made.counts)) ==
            Status::kOk);
  }
  REQUIRE(both[1].bytes == both[0].bytes);
  REQUIRE(both[1].counts.rays[kShadow] == both[0].counts.rays[kShadow]);
  both[1].visits_by_tree = both[0].counts.node_visits[kShadow];
  both[1].hits_by_tree = both[0].counts.hits[kShadow];
  return both[1];
}

/// A wall through the world.
std::vector<Vec3i> wall_at(int place, int side, int axis) {
  std::vector<Vec3i> voxels;
  voxels.reserve(static_cast<std::size_t>(side * side));
  for (int i = 0; i < side * side; ++i) {
    Vec3i at{};
    at[axis] = place;
    at[(axis + 1) % 3] = i / side;
    at[(axis + 2) % 3] = i % side;
    voxels.push_back(at);
  }
  return voxels;
}

/// A wall all over one side of the world, and a few voxels in the air before it, in clusters.
std::vector<Vec3i> hang_before_a_wall(std::mt19937_64& random, int side, int axis, bool high, int count) {
  std::vector<Vec3i> voxels = wall_at(high ? side - 1 : 0, side, axis);
  Vec3i at{};
  for (int i = 0; i < count; ++i) {
    const bool anew = i % 12 == 0;
    for (int other = 0; other < 3; ++other) {
      at[other] = anew ? pick_int(random, 0, side - 1)
                       : std::min(std::max(at[other] + pick_int(random, -1, 1), 0), side - 1);
    }
    voxels.push_back(at);
  }
  return voxels;
}

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
    const ChipScene scene =
        make_chip_scene(level, hang_before_a_wall(random, side, axis, high, turn % 40 * 4));
    const auto anywhere = [&](int grain) { return pick_int(random, 0, 256 * side) / grain * grain; };
    // From across the world towards some place of the wall.
    Vec3Q8 eye{};
    Vec3i forward{};
    for (int i = 0; i < 3; ++i) {
      const int from = i == axis ? (high ? 0 : 256 * side) : anywhere(1);
      const int to = i == axis ? (high ? 256 * side : 0) : anywhere(1);
      eye[i] = Q8::from_raw(from);
      forward[i] = to - from;
    }
    Camera camera;
    REQUIRE(camera.set(PerspectiveView{eye, forward, {}, Q16::saturate(50), kWide, kHigh, 0}, level) ==
            Status::kOk);
    std::vector<Light> lamps(turn / 6 % 2 == 0 ? 1 : 2);
    for (Light& lamp : lamps) {
      lamp.is_point = true;
      lamp.reach = 60;
      const int grain = turn % 4 == 0 ? 256 : turn % 4 == 1 ? 1024 : 1;
      Vec3i place{};
      for (int i = 0; i < 3; ++i) {
        place[i] = anywhere(grain);
      }
      lamp.place = place;
      lamp.color_q8[0] = lamp.color_q8[1] = lamp.color_q8[2] = 900;
    }
    LitScene lit;
    lit.lights = {lamps.data(), lamps.size()};
    const Drawn got = drawn(scene, camera, lit);
    CHECK(got.counts.node_visits[kShadow] <= got.visits_by_tree / 4);
    hidden += got.counts.hits[kShadow];
    reached += got.counts.rays[kShadow] - got.counts.hits[kShadow];
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
    std::vector<Vec3i> voxels = wall_at(kNear, 64, 0);
    const std::vector<Vec3i> behind = wall_at(kNear + way + 3, 64, 0);
    voxels.insert(voxels.end(), behind.begin(), behind.end());
    const ChipScene scene = make_chip_scene(6, voxels);
    Light lamp;
    lamp.is_point = true;
    lamp.reach = 60;
    lamp.place = Vec3i{256 * (kNear + 1 + way) + 100, 32 * 256 + 30, 32 * 256 - 50};
    lamp.color_q8[0] = lamp.color_q8[1] = lamp.color_q8[2] = 900;
    LitScene lit;
    lit.lights = {&lamp, 1};
    Camera camera;
    const Vec3Q8 eye{Q8::saturate(kNear + 3), Q8::saturate(32), Q8::saturate(32)};
    REQUIRE(camera.set(PerspectiveView{eye, {-1, 0, 0}, {}, Q16::saturate(20), kWide, kHigh, 0}, 6) ==
            Status::kOk);
    const Drawn got = drawn(scene, camera, lit);
    CHECK(got.counts.rays[kShadow] == kWide * kHigh);
    CHECK(got.counts.hits[kShadow] == 0);
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
    std::vector<Vec3i> voxels = wall_at(high ? kSide - 4 : 3, kSide, axis);
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
        voxels.push_back(at);
      }
    }
    const ChipScene scene = make_chip_scene(kLevel, voxels);
    // The eye looks straight at the wall from before everything that hangs.
    Vec3Q8 eye{};
    Vec3i forward{};
    for (int i = 0; i < 3; ++i) {
      eye[i] = Q8::from_raw(256 * (i == axis ? start[i] + (high ? -1 : 1) : start[i]));
    }
    forward[axis] = high ? 1 : -1;
    Camera camera;
    REQUIRE(camera.set(PerspectiveView{eye, forward, {}, Q16::saturate(10), kPicture, kPicture, 0}, kLevel) ==
            Status::kOk);
    Light lamp;
    lamp.is_point = true;
    lamp.reach = 200;
    lamp.place = Vec3i{256 * (start.x + times * step.x), 256 * (start.y + times * step.y),
                       256 * (start.z + times * step.z)};
    lamp.color_q8[0] = lamp.color_q8[1] = lamp.color_q8[2] = 2000;
    LitScene lit;
    lit.lights = {&lamp, 1};
    const Drawn got = drawn(scene, camera, lit);
    hidden += got.hits_by_tree != 0 ? 1 : 0;
    reached += got.counts.rays[kShadow] != got.hits_by_tree ? 1 : 0;
  }
  CAPTURE(hidden);
  CAPTURE(reached);
  CHECK(hidden > turns / 60);
  CHECK(reached > turns / 6);
}

}  // namespace
