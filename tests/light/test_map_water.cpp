// Water by the brick map: the tree's bytes and rays, from over, in and below water that is still, moves or has ripples, and
// from as far away as `draws_fast`. THIMBLE_FEW draws a tenth.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "support/map_world.h"
#include "support/random_up.h"
#include "support/ray_cases.h"
#include "thimble/light/water.h"

namespace thimble::testing::map_water {
namespace {

using tests::pick_int;

constexpr EffectSet kWet = Effect::kDirectLight | Effect::kShadows | Effect::kWater;
constexpr int kPrimary = static_cast<int>(LitRayKind::kPrimary);
constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
constexpr int kWaterRay = static_cast<int>(LitRayKind::kWaterRay);
constexpr std::uint8_t kStone = 1;
constexpr std::uint8_t kGlowing = 3;

struct WaterWorld : MapWorld {
  explicit WaterWorld(int level = 5) : MapWorld(level) {
    surfaces[kStone] = surface(SurfaceKind::kDiffuse, {90, 160, 210});
    surfaces[2] = surface(SurfaceKind::kDiffuse, {200, 60, 30});
    surfaces[kGlowing] = surface(SurfaceKind::kEmit, {90, 220, 120});
    scene.has_water = true;
    scene.has_sky = true;
    scene.water_material = medium(SurfaceKind::kGlass, {84, 176, 190}, 40, 5460);
  }
  void still(const Vec3i& corner, int width, int depth, int height_q8) {
    scene.water = still_water(corner, width, depth, height_q8);
  }

  std::vector<std::int32_t> heights;
};

/// Both pictures are the same, and so are the rays.
template <EffectSet kSet>
LitCounts compare(const WaterWorld& world, PixelFormat format) {
  const BothCounts both = draw_both<kSet>(world, format);
  for (const int kind : {kPrimary, kShadow, kWaterRay}) {
    CAPTURE(kind);
    REQUIRE(both.by_map.rays[kind] == both.by_tree.rays[kind]);
    REQUIRE(both.by_map.hits[kind] == both.by_tree.hits[kind]);
  }
  REQUIRE(both.by_map.pending_high_water == both.by_tree.pending_high_water);
  return both.by_map;
}

/// By every set that goes through the map.
constexpr LitCounts (*kCompare[])(const WaterWorld&, PixelFormat) = {
    compare<kWet>,
    compare<kWet | Effect::kEmission>,
    compare<kWet | Effect::kSky>,
    compare<kWet | Effect::kEmission | Effect::kSky>,
    compare<kWet | Effect::kRipples>,
    compare<kWet | Effect::kRipples | Effect::kEmission>,
    compare<kWet | Effect::kRipples | Effect::kSky>,
    compare<kWet | Effect::kRipples | Effect::kEmission | Effect::kSky>,
};

/// A place near the water and the world: over it, in it, below it, or on a plane of it.
Vec3i place_near(std::mt19937_64& random, const WaterSurface& water) {
  const int size[3] = {256 * water.width, 256 * water.depth, water.highest_q8};
  Vec3i at;
  for (int i = 0; i < 3; ++i) {
    const int low = 256 * water.corner[i];
    switch (pick_int(random, 0, 5)) {
      case 0:
        at[i] = low + pick_int(random, 0, 1) * size[i];
        break;
      case 1:
        at[i] = low + 256 * pick_int(random, 0, size[i] / 256);
        break;
      case 2:
        at[i] = low + pick_int(random, -4 * 256, size[i] + 8 * 256);
        break;
      default:
        at[i] = low + pick_int(random, 0, size[i]);
    }
    at[i] = std::clamp(at[i], -40 * 256, 72 * 256);
  }
  return at;
}

/// Boxes and voxels anywhere, mostly on a floor, and water of any kind somewhere.
void build(std::mt19937_64& random, WaterWorld* world) {
  if (pick_int(random, 0, 4) != 0) {
    world->box({0, 0, 0}, {32, 32, pick_int(random, 1, 5)}, kStone);
  }
  for (int i = pick_int(random, 1, 12); i > 0; --i) {
    const Vec3i at{pick_int(random, 0, 28), pick_int(random, 0, 28), pick_int(random, 0, 18)};
    const Vec3i size{pick_int(random, 1, 6), pick_int(random, 1, 6), pick_int(random, 1, 9)};
    world->box(
        at, {at.x + size.x < 32 ? at.x + size.x : 32, at.y + size.y < 32 ? at.y + size.y : 32, at.z + size.z},
        pick_int(random, 1, 3));
  }
  // Now and then it leaves the world by so many voxels, which the tree draws.
  const int out = pick_int(random, 0, 9) != 0 ? 0 : pick_int(random, 0, 1) == 0 ? 5 : 2000;
  const Vec3i corner{pick_int(random, -out, 8), pick_int(random, -out, 8), pick_int(random, -out, 6)};
  const int width = pick_int(random, 1, 32 + out - corner.x);
  const int depth = pick_int(random, 1, 32 + out - corner.y);
  const int whole = pick_int(random, 1, 12 + out);
  const int height = 256 * whole + (pick_int(random, 0, 1) == 0 ? 0 : pick_int(random, -255, 255));
  world->still(corner, width, depth, height);
  if (pick_int(random, 0, 1) == 0 && out <= 5) {
    WaterSurface& water = world->scene.water;
    world->heights.resize(static_cast<std::size_t>(width * depth));
    const int amplitude = pick_int(random, 0, 2) == 0 ? 256 * height : pick_int(random, 1, 40000);
    const bool has_blocked = pick_int(random, 0, 3) == 0;
    water.lowest_q8 = kMaxWaterHeightQ8;
    water.highest_q8 = 0;
    for (std::int32_t& column : world->heights) {
      const int wave = pick_int(random, -amplitude, amplitude);
      column = 256 * height + wave < 0 ? 0 : 256 * height + wave;
      if (has_blocked && pick_int(random, 0, 5) == 0) {
        column = -1;
        continue;
      }
      const int own = (column + 128) >> 8;
      water.lowest_q8 = own < water.lowest_q8 ? own : water.lowest_q8;
      water.highest_q8 = own > water.highest_q8 ? own : water.highest_q8;
    }
    water.lowest_q8 = water.lowest_q8 < water.highest_q8 ? water.lowest_q8 : water.highest_q8;
    water.has_blocked = has_blocked;
    water.heights_q16 = world->heights.data();
  }
  LitScene& scene = world->scene;
  scene.bounces = static_cast<std::uint8_t>(pick_int(random, 0, kMaxBounces));
  scene.ripple_phase = static_cast<std::uint8_t>(pick_int(random, 0, 255));
  scene.water_material.index_q12 = static_cast<std::uint16_t>(pick_int(random, 4096, 9000));
  scene.water_material.density_q8 = static_cast<std::uint16_t>(pick_int(random, 0, 300));
  world->lights.clear();
  for (int i = pick_int(random, 0, 2); i > 0; --i) {
    const Vec3i towards{pick_int(random, -9, 9), pick_int(random, -9, 9), pick_int(random, -4, 16)};
    world->lights.push_back(sun(towards == Vec3i{} ? Vec3i{0, 0, 1} : towards, pick_int(random, 60, 300)));
  }
}

TEST_CASE("water by the map: random water, worlds and cameras -> the tree's picture and rays") {
#if defined(__SANITIZE_ADDRESS__)
  const int turns = 300;
#else
  const int turns = std::getenv("THIMBLE_FEW") != nullptr ? 300 : 3000;
#endif
  std::mt19937_64 random(20261126);
  int wet = 0;
  int passed = 0;
  int asked = 0;
  int far_away = 0;
  for (int turn = 0; turn < turns; ++turn) {
    CAPTURE(turn);
    WaterWorld world;
    build(random, &world);
    world.map_it();
    for (int view = 0; view < 3; ++view) {
      CAPTURE(view);
      Vec3i eye = place_near(random, world.scene.water);
      const Vec3i target = place_near(random, world.scene.water);
      if (pick_int(random, 0, 2) == 0) {
        eye.z += pick_int(random, 256, 20 * 256);
      }
      if (eye == target) {
        eye.z += 256;
      }
      const int fov = pick_int(random, 0, 2) == 0 ? pick_int(random, 2, 8) : pick_int(random, 20, 110);
      world.look(eye, target, fov, 24, 18);
      Camera rolled;
      const Vec3Q8 from = LitWorld::point(eye);
      if (rolled.set(PerspectiveView{from, look_at(from, LitWorld::point(target)), tests::random_up(random),
                                     Q16::saturate(fov), 24, 18, 0},
                     world.tree.level()) == Status::kOk) {
        world.camera = rolled;
      }
      if (pick_int(random, 0, 4) == 0) {
        for (int axis = 0; axis < 3; ++axis) {
          eye[axis] = tests::far_coordinate(random, world.tree.level(), 15);
        }
        const Vec3Q8 far = LitWorld::point(eye);
        Camera away;
        if (away.set(PerspectiveView{far, look_at(far, LitWorld::point(target)), tests::random_up(random),
                                     Q16::saturate(pick_int(random, 1, 40)), 24, 18, 15},
                     world.tree.level()) == Status::kOk &&
            draws_fast(world.map, away)) {
          world.camera = away;
          far_away += tests::takes_31_bits(away) ? 1 : 0;
        }
      }
      world.options.dither = pick_int(random, 0, 3) != 0;
      const LitCounts counts =
          kCompare[(turn + view) % 8](world, static_cast<PixelFormat>(pick_int(random, 0, 4)));
      const bool asks = counts.node_visits[kPrimary] != 0;
      wet += counts.rays[kWaterRay] != 0 ? 1 : 0;
      passed += counts.rays[kWaterRay] != 0 && !asks ? 1 : 0;
      asked += asks ? 1 : 0;
    }
  }
  CAPTURE(wet);
  CAPTURE(passed);
  CAPTURE(asked);
  CHECK(wet > turns);
  CHECK(passed > turns / 4);
  CHECK(asked > turns / 4);
  CHECK(far_away > turns / 100);
}

// A pixel is a ray to the water, one up and one down to the ground, from where one goes to the sun. All but that up come
// to the one column of still water.
TEST_CASE("water by the map: all of a still sea from above -> three times a column is looked at, a pixel") {
  WaterWorld world;
  world.box({0, 0, 0}, {32, 32, 2}, kStone);
  world.still({0, 0, 0}, 32, 32, 4 * 256);
  world.map_it();
  world.look({16 * 256 + 31, 16 * 256 + 57, 25 * 256}, {16 * 256 + 3, 15 * 256 + 11, 0}, 40, 24, 18);
  const BothCounts both = draw_both<kWet>(world);
  constexpr unsigned kPixels = 24 * 18;
  CHECK(both.by_map.rays[kWaterRay] == 2 * kPixels);
  CHECK(both.by_map.node_visits[kWaterRay] >= 3 * kPixels);
  CHECK(both.by_map.node_visits[kWaterRay] < 3 * kPixels + kPixels / 16);  // more of a few on a column's edge
}

// The middle pixel's ray rises at 45 degrees to where the water's side ends, beside a bank as high as the water: there it
// leaves by the side, below the top, and so begins in the bank.
TEST_CASE("water by the map: a ray that leaves through the edge of side and surface -> the tree's picture") {
  for (const int up : {0, 1, 5}) {
    WaterWorld world;
    world.box({14, 0, 0}, {32, 32, up + 6}, kStone);
    world.still({2, 2, up}, 12, 28, 6 * 256);
    world.map_it();
    const Vec3i eye{11 * 256, 16 * 256 + 77, (up + 3) * 256};
    world.look(eye, {eye.x + 1024, eye.y, eye.z + 1024}, 20, 5, 5);
    const LitCounts counts = compare<kWet | Effect::kSky>(world, PixelFormat::kRgb888);
    CHECK(counts.rays[kWaterRay] >= 25);
  }
}

}  // namespace
}  // namespace thimble::testing::map_water
