// What metals mirror, by the brick map: the tree's bytes and rays, wherever a ray comes through an edge.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>

#include "support/counts.h"
#include "support/map_world.h"
#include "support/ray_cases.h"

namespace thimble::testing::map_mirrors {
namespace {

using tests::many_or_few;
using tests::pick_int;

constexpr EffectSet kMirrored = Effect::kDirectLight | Effect::kShadows | Effect::kMirror;
constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
constexpr int kMirrorRay = static_cast<int>(LitRayKind::kMirrorRay);
constexpr std::uint8_t kMetal = 1;
constexpr std::uint8_t kStone = 2;
constexpr std::uint8_t kRough = 3;

struct MirrorWorld : MapWorld {
  explicit MirrorWorld(int level = 5) : MapWorld(level) {
    surfaces[kMetal] = surface(SurfaceKind::kMetal, {230, 190, 120});
    surfaces[kMetal].mirror = 200;
    surfaces[kStone] = surface(SurfaceKind::kDiffuse, {90, 160, 210});
    surfaces[kRough] = surfaces[kMetal];
    surfaces[kRough].roughness = 255;
    surfaces[4] = surface(SurfaceKind::kDiffuse, {200, 60, 30});
  }
};

/// Both pictures are the same; what the map's took. Where all metals show something of their own the rays are the tree's.
template <EffectSet kSet = kMirrored>
LitCounts compare(const MirrorWorld& world, PixelFormat format = PixelFormat::kRgb888,
                  std::size_t offset = 0) {
  const BothCounts both = draw_both<kSet>(world, format, offset);
  const LitCounts& counts = both.by_map;
  const LitCounts& wanted = both.by_tree;
  REQUIRE(counts.rays[kMirrorRay] == wanted.rays[kMirrorRay]);
  REQUIRE(counts.hits[kMirrorRay] == wanted.hits[kMirrorRay]);
  if (world.surfaces[kMetal].mirror != 255) {
    REQUIRE(counts.rays[kShadow] == wanted.rays[kShadow]);
    REQUIRE(counts.hits[kShadow] == wanted.hits[kShadow]);
  }
  return counts;
}

TEST_CASE("mirrors by the map: more suns than go through the map -> the tree's picture") {
  for (std::size_t suns = kMaxFlatSuns - 1; suns < kMaxFlatSuns + 4; ++suns) {
    CAPTURE(suns);
    MirrorWorld world;
    world.lights.clear();
    for (std::size_t i = 0; i < suns; ++i) {
      world.lights.push_back(sun({static_cast<std::int32_t>(3 * i) - 7, -5, 9}, 100));
    }
    world.box({0, 0, 0}, {32, 32, 2}, kStone);
    world.box({4, 8, 2}, {9, 20, 12}, kMetal);
    world.map_it();
    world.look({16 * 256 + 31, -2 * 256 + 77, 22 * 256 + 5}, {16 * 256, 14 * 256, 2 * 256}, 50);
    CHECK(compare(world).rays[kShadow] > 1000 * suns);
  }
}

TEST_CASE("mirrors by the map: all light mirrored -> the metal's own light is skipped") {
  MirrorWorld world;
  world.surfaces[kMetal].mirror = 255;
  world.box({0, 0, 0}, {32, 32, 2}, kMetal);
  world.map_it();
  world.look({16 * 256 + 31, 2 * 256 + 77, 22 * 256 + 5}, {16 * 256, 14 * 256, 2 * 256}, 30);
  const LitCounts counts = compare(world);
  CHECK(counts.rays[kMirrorRay] > 1000);
  CHECK(counts.rays[kShadow] == 0);
}

// The middle pixel's ray meets a mirror in the middle of a face, or on a half or a quarter of it, and leaves along a
// lattice direction: through edges and corners, past voxels that touch its way or stand in it.
TEST_CASE("mirrors by the map: reflected rays through edges and corners -> the tree's picture") {
  std::mt19937_64 random(20261127);
  constexpr int kPicture = 3;
  int asked = 0;
  int passed = 0;
  int seen = 0;
  const int turns = many_or_few(4000, 300);
  for (int turn = 0; turn < turns; ++turn) {
    CAPTURE(turn);
    const int axis = turn % 3;
    const bool high = turn / 3 % 2 != 0;
    const int plane = high ? 28 : 4;  // of the mirror
    MirrorWorld world;
    Vec3i from{};
    Vec3i to{32, 32, 32};
    from[axis] = high ? plane : plane - 1;
    to[axis] = from[axis] + 1;
    world.box(from, to, turn % 7 == 0 ? kRough : kMetal);
    // Where the reflected ray begins, in 1/4 voxel, and how it goes.
    Vec3i start{};
    Vec3i step{};
    for (int i = 0; i < 3; ++i) {
      step[i] = pick_int(random, -3, 3);
      start[i] = 4 * pick_int(random, 10, 22) + pick_int(random, 0, 3);
    }
    start[axis] = 4 * plane;
    step[axis] = (high ? -1 : 1) * pick_int(random, 1, 4);
    // A straight way is common enough elsewhere; a third of these have two ways of one size.
    const int other = (axis + 1) % 3;
    if (turn % 3 == 0) {
      step[other] = turn % 2 == 0 ? step[axis] : -step[axis];
      start[other] = 4 * pick_int(random, 10, 22) + (turn % 4 < 2 ? 0 : 2);
    }
    for (int i = pick_int(random, 1, 8); i > 0; --i) {
      // A place on the way where it crosses a plane along the mirror's axis, or half way between, and what lies there.
      const int along = pick_int(random, 1, 20);
      Vec3i at{};
      bool fits = true;
      for (int k = 0; k < 3; ++k) {
        const int place = start[k] * 4 + step[k] * along * 16 / std::max(1, std::abs(step[axis])) / 2;
        at[k] = (place >> 4) - pick_int(random, 0, 1);
        fits = fits && at[k] >= 0 && at[k] < 32;
      }
      fits = fits && (high ? at[axis] < plane : at[axis] >= plane);
      if (fits) {
        world.voxel(at, pick_int(random, 0, 4) == 0 ? kMetal : pick_int(random, 0, 1) == 0 ? kStone : 4);
      }
    }
    world.map_it();
    Vec3i eye{};
    for (int i = 0; i < 3; ++i) {
      eye[i] = 64 * start[i] - 256 * 2 * (i == axis ? -step[i] : step[i]);
    }
    Vec3i forward = step;
    forward[axis] = -forward[axis];
    REQUIRE(world.camera.set(
                PerspectiveView{LitWorld::point(eye), forward, {}, Q16::saturate(4), kPicture, kPicture, 0},
                5) == Status::kOk);
    const LitCounts counts = turn % 2 == 0 ? compare(world) : compare<kMirrored | Effect::kSky>(world);
    seen += counts.rays[kMirrorRay] != 0 ? 1 : 0;
    asked += counts.node_visits[kMirrorRay] != 0 ? 1 : 0;
    passed += counts.node_visits[kMirrorRay] == 0 && counts.hits[kMirrorRay] != 0 ? 1 : 0;
  }
  CAPTURE(seen);
  CAPTURE(asked);
  CAPTURE(passed);
  CHECK(seen > turns / 2);
  CHECK(asked > turns / 20);
  CHECK(passed > turns / 8);
}

}  // namespace
}  // namespace thimble::testing::map_mirrors
