// Waves in lit pictures: what is hit is the columns of the moment.
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
  world.scene.water_material = medium(SurfaceKind::kGlass, {0, 0, 0}, 65535);
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
