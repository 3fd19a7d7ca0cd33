// Waves in lit pictures: what is hit is the columns of the moment, and nothing else changes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "support/lit_world.h"
#include "thimble/light/water.h"

namespace {

using namespace thimble;
using namespace thimble::testing;

constexpr int kWavesSide = 24;  // columns
constexpr int kRestQ8 = 5 * 256;
constexpr int kGreatestQ8 = 9 * 256;

struct Waves {
  Waves() : bytes(water_bytes(kWavesSide, kWavesSide)) {
    WaterConfig config;
    config.width = kWavesSide;
    config.depth = kWavesSide;
    config.rest_q8 = kRestQ8;
    config.least_q8 = 256;
    config.greatest_q8 = kGreatestQ8;
    REQUIRE(Water::make(config, {bytes.data(), bytes.size()}, &water) == Status::kOk);
  }
  void stir() {
    REQUIRE(water.touch(8 * 256 + 30, 9 * 256, 4 * 256, 700) == Status::kOk);
    REQUIRE(water.touch(17 * 256, 15 * 256 + 99, 3 * 256, -500) == Status::kOk);
  }
  void step(int count) {
    for (int i = 0; i < count; ++i) {
      water.step();
    }
  }
  std::vector<std::uint8_t> bytes;
  Water water;
};

/// A box in voxels, and what part of a ray lies in it.
struct Box {
  double low[3];
  double high[3];
};
struct Part {
  double from = 0;
  double to = 0;
};
Part part_in(const Ray& ray, const Box& box) {
  Part part{0, 1e30};
  for (int axis = 0; axis < 3; ++axis) {
    const double from = ray.origin[axis].raw / 256.0;
    const double along = ray.direction[axis];
    if (ray.direction[axis] == 0) {
      if (from < box.low[axis] || from >= box.high[axis]) {
        return {};
      }
      continue;
    }
    const double one = (box.low[axis] - from) / along;
    const double other = (box.high[axis] - from) / along;
    part.from = std::max(part.from, std::min(one, other));
    part.to = std::min(part.to, std::max(one, other));
  }
  return part.from < part.to ? part : Part{};
}

/// A rock that stands in the water, and a sunken one.
constexpr Box kSolids[] = {{{0, 0, 0}, {32, 32, 4}}, {{14, 6, 4}, {18, 9, 13}}, {{6, 16, 4}, {11, 20, 8}}};
void build(LitWorld* world) {
  for (const Box& box : kSolids) {
    const auto corner = [](const double(&at)[3]) {
      return Vec3i{static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2])};
    };
    world->box(corner(box.low), corner(box.high), 1);
  }
  world->scene.has_water = true;
  world->scene.has_sky = true;
}

/// Voxels of water that the ray goes through before it meets something solid.
double way_in_water(const Ray& ray, const Water& water) {
  double solid = 1e30;
  for (const Box& box : kSolids) {
    const Part part = part_in(ray, box);
    solid = part.to > part.from ? std::min(solid, part.from) : solid;
  }
  double way = 0;
  for (int y = 0; y < kWavesSide; ++y) {
    for (int x = 0; x < kWavesSide; ++x) {
      const Box column{{4.0 + x, 4.0 + y, 4}, {5.0 + x, 5.0 + y, 4 + water.height_q8(x, y) / 256.0}};
      const Part part = part_in(ray, column);
      way += std::max(0.0, std::min(part.to, solid) - part.from);
    }
  }
  double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    squared += double(ray.direction[axis]) * double(ray.direction[axis]);
  }
  return way * std::sqrt(squared);
}

}  // namespace

TEST_CASE("waves in pictures: after any number of steps, silhouette and waterline are those of the columns") {
  LitWorld world;
  build(&world);
  // Everything shines white but what is seen through water, which is black; no ray is bent.
  world.surfaces[1] = surface(SurfaceKind::kEmit, {255, 255, 255});
  set_ambient(&world.scene, 0);
  world.scene.sky = {{255, 255, 255}, {255, 255, 255}, {255, 255, 255}};
  world.scene.water_material = surface(SurfaceKind::kGlass, {0, 0, 0});
  world.scene.water_material.index_q12 = kMinIndexQ12;
  world.scene.water_material.density_q8 = 65535;
  world.finish();
  Waves waves;
  waves.stir();
  const EffectSet effects = Effect::kDirectLight | Effect::kEmission | Effect::kWater | Effect::kSky;
  // Flat over the water, from above, and from within a trough's height.
  const Vec3i eyes[] = {
      {-4 * 256, 3 * 256, 10 * 256}, {16 * 256, -9 * 256, 24 * 256}, {31 * 256, 30 * 256, 9 * 256 + 20}};
  for (const Vec3i& eye : eyes) {
    std::set<std::vector<bool>> pictures;
    int sure = 0;
    int wet = 0;
    for (int round = 0; round < 4; ++round) {
      world.scene.water = waves.water.surface({4, 4, 4});
      world.look(eye, {16 * 256, 13 * 256, 8 * 256}, 50, 64, 48);
      const std::vector<Rgb8> picture = world.draw(effects);
      std::vector<bool> silhouette;
      for (int i = 0; i < 64 * 48; ++i) {
        const double way = way_in_water(world.camera.ray(i % 64, i / 64), waves.water);
        const int shown = picture[static_cast<std::size_t>(i)].r;
        silhouette.push_back(shown < 128);
        CAPTURE(i % 64);
        CAPTURE(i / 64);
        // 12/256 voxel of this water leave less than a 4000th.
        if (way > 12.0 / 256) {
          CHECK(shown == 0);
          ++wet;
          ++sure;
        } else if (way < 1e-9) {
          CHECK(shown == 255);
          ++sure;
        }
      }
      pictures.insert(silhouette);
      waves.step(9);
    }
    CHECK(pictures.size() == 4);
    CHECK(sure > 4 * 64 * 48 * 98 / 100);
    CHECK(wet > 1000);
    CHECK(wet < sure);
  }
}

TEST_CASE("waves in pictures: a pixel whose rays meet no column that may ever rise -> never changes") {
  // By way of glass and mirrors too: this is what the bands of a still picture rest upon.
  LitWorld world;
  build(&world);
  world.box({5, 5, 9}, {12, 12, 16}, 2);     // glass that stands in the slab between rest and highest wave
  world.box({20, 18, 11}, {26, 26, 14}, 3);  // and metal
  world.box({2, 28, 4}, {30, 30, 22}, 3);
  world.surfaces[2] = surface(SurfaceKind::kGlass, {220, 240, 230});
  world.surfaces[2].index_q12 = 6144;
  world.surfaces[3] = surface(SurfaceKind::kMetal, {240, 230, 200});
  world.lights = {sun({-5, -9, 12})};
  world.scene.has_shadows = true;
  world.finish();
  const EffectSet effects = Effect::kDirectLight | Effect::kShadows | Effect::kGlass | Effect::kMirror |
                            Effect::kWater | Effect::kSky;
  Waves waves;
  std::vector<bool> may_change;
  std::vector<Rgb8> first;
  const int width = 40;
  const int height = 30;
  world.look({16 * 256, -6 * 256, 13 * 256}, {16 * 256, 20 * 256, 14 * 256}, 70, width, height);
  // A picture of one pixel for each of them: its counts are that pixel's alone.
  const auto pixel_counts = [&](int x, int y) {
    const Vec3i direction = world.camera.ray(x, y).direction;
    Camera one;
    REQUIRE(one.set(PerspectiveView{world.camera.eye(), direction, {}, Q16::saturate(1), 1, 1, 20}, 5) ==
            Status::kOk);
    return one;
  };
  std::vector<Camera> cameras;
  for (int i = 0; i < width * height; ++i) {
    cameras.push_back(pixel_counts(i % width, i / width));
  }
  const auto draw_one = [&](const Camera& camera, LitCounts* counts) {
    std::uint8_t bytes[3] = {};
    const Band band{{bytes, 3}, PixelFormat::kRgb888, 0, 0, 1};
    REQUIRE(render_lit_band(effects, world.tree, camera, world.shading, world.scene, band, counts) ==
            Status::kOk);
    return Rgb8{bytes[0], bytes[1], bytes[2]};
  };
  world.scene.water = waves.water.surface({4, 4, 4});
  world.scene.water.highest_q8 = kGreatestQ8;
  int spared = 0;
  for (const Camera& camera : cameras) {
    LitCounts counts;
    first.push_back(draw_one(camera, &counts));
    may_change.push_back(counts.node_visits[static_cast<int>(LitRayKind::kWaterRay)] != 0);
    spared += may_change.back() ? 0 : 1;
  }
  CHECK(spared > 100);
  int changed = 0;
  for (int round = 0; round < 6; ++round) {
    if (round % 2 == 0) {
      waves.stir();
      REQUIRE(waves.water.touch(8 * 256, 8 * 256, 1500, -900) == Status::kOk);
    }
    waves.step(5);
    world.scene.water = waves.water.surface({4, 4, 4});
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const bool is_same = draw_one(cameras[i], nullptr) == first[i];
      CAPTURE(i);
      CHECK((is_same || may_change[i]));
      changed += is_same ? 0 : 1;
    }
  }
  CHECK(changed > 500);
}

TEST_CASE("waves in pictures: smooth waves seen from above -> a smooth picture, no column's edge in it") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 4}, 1);
  world.surfaces[1] = surface(SurfaceKind::kEmit, {255, 255, 255});
  set_ambient(&world.scene, 0);
  world.scene.has_sky = true;
  world.scene.has_water = true;
  world.scene.sky = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  // A shade tells how long the way to the bottom was: bent twice, it is shorter by a seventh.
  world.scene.water_material.albedo = {0, 0, 0};
  world.scene.water_material.density_q8 = 80;
  world.finish();
  Waves waves;
  REQUIRE(waves.water.touch(12 * 256, 12 * 256, 5 * 256, 120) == Status::kOk);
  for (int round = 0; round < 4; ++round) {
    waves.step(3);
    world.scene.water = waves.water.surface({4, 4, 4});
    world.look({16 * 256, -14 * 256, 23 * 256}, {16 * 256, 15 * 256, 9 * 256}, 13, 120, 90);
    const std::vector<Rgb8> picture =
        world.draw(Effect::kDirectLight | Effect::kEmission | Effect::kWater | Effect::kSky);
    int steepest = 0;
    int least = 255;
    int most = 0;
    for (int i = 0; i < 120 * 90; ++i) {
      const int here = picture[static_cast<std::size_t>(i)].r;
      least = std::min(least, here);
      most = std::max(most, here);
      if (i % 120 != 0) {
        steepest = std::max(steepest, std::abs(here - picture[static_cast<std::size_t>(i - 1)].r));
      }
    }
    // From pixel to pixel; a ray that begins on the wrong side of the surface is 11 off and more.
    CHECK(steepest < 8);
    CHECK(most - least > 20);
  }
}
