// Mirrors, glass, clouds and water, where what a ray must show is known.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/lit_world.h"

namespace {

using namespace thimble;
using namespace thimble::testing;

constexpr Rgb8 kWhite{255, 255, 255};
constexpr EffectSet kGlassy = Effect::kDirectLight | Effect::kGlass | Effect::kSky;

/// What is left of 255 after `voxels` of a density.
double absorbed(double density_q8, double channel, double voxels) {
  return 255.0 * std::exp2(-density_q8 / 256 * (1 - channel / 255) * voxels);
}
bool near(int value, double wanted, double within) {
  return std::abs(value - wanted) <= within;
}
int distance(const Rgb8& one, const Rgb8& other) {
  return std::abs(one.r - other.r) + std::abs(one.g - other.g) + std::abs(one.b - other.b);
}
Rgb8 at(const LitWorld& world, const std::vector<Rgb8>& picture, int x, int y) {
  return picture[static_cast<std::size_t>(y * world.camera.width_px() + x)];
}
/// A sky of one colour all round.
void set_sky(LitWorld* world, const Rgb8& color) {
  world->scene.has_sky = true;
  world->scene.sky = {color, color, color};
}

/// A room of light walls with a pattern, open in front (small y).
void build_room(LitWorld* world) {
  world->box({0, 0, 0}, {32, 32, 2}, 0);
  world->box({0, 30, 0}, {32, 32, 32}, 1);
  world->box({0, 0, 0}, {2, 32, 32}, 2);
  for (int i = 0; i < 7; ++i) {
    world->box({4 * i + 2, 30, 4 + 3 * i}, {4 * i + 4, 31, 7 + 3 * i}, 3);
  }
  world->surfaces[0].albedo = {210, 200, 190};
  world->surfaces[1].albedo = {200, 90, 80};
  world->surfaces[2].albedo = {90, 160, 90};
  world->surfaces[3].albedo = {60, 80, 220};
  world->lights = {sun({-3, -8, 9})};
  world->scene.has_shadows = true;
}
void look_at_room(LitWorld* world) {
  world->look({18 * 256, -24 * 256, 20 * 256}, {15 * 256, 20 * 256, 12 * 256}, 50, 96, 72);
}

TEST_CASE("glass of index 1 without colour: invisible, pixel by pixel") {
  for (const EffectSet shadows : {Effect::kNone, Effect::kShadows}) {
    LitWorld empty;
    build_room(&empty);
    empty.finish();
    look_at_room(&empty);
    LitWorld glass;
    build_room(&glass);
    glass.box({8, 8, 6}, {20, 20, 18}, 4);
    glass.voxel({25, 6, 9}, 4);
    glass.surfaces[4] = surface(SurfaceKind::kGlass, kWhite);
    glass.surfaces[4].index_q12 = kMinIndexQ12;
    glass.finish();
    look_at_room(&glass);
    LitCounts counts;
    CHECK(glass.draw(kGlassy | shadows, &counts) == empty.draw(kGlassy | shadows));
    CHECK(counts.rays[static_cast<int>(LitRayKind::kGlassRay)] > 500);
    // With an index it is seen.
    glass.surfaces[4].index_q12 = 6144;
    CHECK(glass.draw(kGlassy | shadows) != empty.draw(kGlassy | shadows));
  }
}

TEST_CASE("absorption: through a slab of known thickness as Beer and Lambert have it") {
  for (const int thickness : {1, 2, 5, 11}) {
    for (const int density : {16, 64, 200}) {
      LitWorld world;
      world.box({0, 10, 0}, {32, 10 + thickness, 32}, 1);
      world.surfaces[1] = medium(SurfaceKind::kGlass, {0, 100, 255}, density);
      set_sky(&world, kWhite);
      world.finish();
      world.look({16 * 256 + 128, -20 * 256, 16 * 256 + 128}, {16 * 256 + 128, 0, 16 * 256 + 128}, 4, 9, 9);
      const Rgb8 color = world.middle(kGlassy);
      CAPTURE(thickness);
      CAPTURE(density);
      CHECK(near(color.r, absorbed(density, 0, thickness), 1));
      CHECK(near(color.g, absorbed(density, 100, thickness), 1));
      CHECK(color.b == 255);
    }
  }
}

TEST_CASE("clouds: what they absorb they show of themselves, in the light around") {
  LitWorld world;
  world.box({0, 10, 0}, {32, 14, 32}, 1);
  world.surfaces[1] = medium(SurfaceKind::kMedia, {200, 100, 40}, 64);  // one halving in four voxels
  set_sky(&world, {80, 80, 80});
  set_ambient(&world.scene, 256);
  world.finish();
  world.look({16 * 256 + 128, -20 * 256, 16 * 256 + 128}, {16 * 256 + 128, 0, 16 * 256 + 128}, 4, 9, 9);
  const Rgb8 color = world.middle(Effect::kDirectLight | Effect::kMedia | Effect::kSky);
  CHECK(near(color.r, 140, 1));
  CHECK(near(color.g, 90, 1));
  CHECK(near(color.b, 60, 1));
}

TEST_CASE("glass: reflected and refracted light together are no more than came in") {
  for (const int index : {4096, 4300, 5325, 6144, 9900, 16384}) {
    LitWorld world;
    world.box({8, 8, 8}, {24, 24, 24}, 1);
    world.box({12, 12, 12}, {20, 20, 20}, 2);
    world.box({3, 3, 3}, {6, 29, 29}, 3);
    world.surfaces[1] = surface(SurfaceKind::kGlass, kWhite);
    world.surfaces[1].index_q12 = static_cast<std::uint16_t>(index);
    world.surfaces[2] = world.surfaces[1];
    world.surfaces[2].index_q12 = 5000;
    world.surfaces[3] = surface(SurfaceKind::kMetal, kWhite);
    world.scene.bounces = kMaxBounces;
    set_sky(&world, {200, 200, 200});
    world.finish();
    world.look({40 * 256, -20 * 256, 30 * 256}, {14 * 256, 16 * 256, 15 * 256}, 50);
    int least = 255;
    for (const Rgb8& color : world.draw(kGlassy | Effect::kMirror)) {
      CHECK(color.r <= 200);
      least = color.r < least ? color.r : least;
    }
    // What is lost: rays below 1/256, and those that bounce about inside.
    CHECK(least > 60);
  }
}

TEST_CASE("a mirror: shows what the mirrored camera sees, in the metal's colour") {
  // The floor is a mirror; seen in it, the wall is as from below the floor.
  LitWorld mirror;
  mirror.box({0, 0, 14}, {32, 32, 16}, 1);
  mirror.box({0, 28, 16}, {32, 30, 28}, 2);
  mirror.surfaces[1] = surface(SurfaceKind::kMetal, kWhite);
  mirror.surfaces[2] = surface(SurfaceKind::kEmit, {10, 200, 90});
  set_ambient(&mirror.scene, 0);
  set_sky(&mirror, {0, 0, 0});
  mirror.finish();
  mirror.look({16 * 256, 2 * 256, 20 * 256}, {16 * 256, 20 * 256, 16 * 256}, 40, 33, 33);
  const EffectSet effects = Effect::kDirectLight | Effect::kEmission | Effect::kMirror | Effect::kSky;
  const std::vector<Rgb8> picture = mirror.draw(effects);
  // Straight ahead: 4 down over 18; the ray comes to the floor at y = 20 and to the wall at 28, 1.8 above it.
  CHECK(at(mirror, picture, 16, 16) == Rgb8{10, 200, 90});
  mirror.surfaces[1].albedo = {255, 128, 0};
  const Rgb8 tinted = mirror.middle(effects);
  CHECK(near(tinted.r, 10, 1));
  CHECK(tinted.g > 100);  // Schlick: more than the half at this angle
  CHECK(tinted.g < 160);
  CHECK(tinted.b < 45);
}

TEST_CASE("a closed box of mirrors: ends at its limit of bounces in the metal's plain colour") {
  LitWorld world;
  world.box({4, 4, 4}, {28, 28, 28}, 1);
  LitWorld box;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      Vec3i low{4, 4, 4};
      Vec3i high{28, 28, 28};
      low[axis] = side == 0 ? 4 : 27;
      high[axis] = low[axis] + 1;
      box.box(low, high, 1);
    }
  }
  box.surfaces[1] = surface(SurfaceKind::kMetal, kWhite);
  set_ambient(&box.scene, 100);
  box.finish();
  box.look({10 * 256 + 77, 12 * 256 + 13, 14 * 256 + 50}, {20 * 256, 19 * 256, 17 * 256}, 80);
  for (const int bounces : {0, 1, 3, 8}) {
    box.scene.bounces = static_cast<std::uint8_t>(bounces);
    LitCounts counts;
    int most = 0;
    int least = 255;
    for (const Rgb8& color : box.draw(Effect::kDirectLight | Effect::kMirror, &counts)) {
      most = color.r > most ? color.r : most;
      least = color.r < least ? color.r : least;
    }
    const std::uint64_t pixels = 48 * 36;
    CHECK(counts.rays[static_cast<int>(LitRayKind::kMirrorRay)] ==
          pixels * static_cast<std::uint64_t>(bounces));
    // A face has between 160 and 256 of 256 of the ambient light.
    CHECK(most <= 100);
    CHECK(least >= 60);
  }
}

TEST_CASE("inside glass: a camera there looks out, through the colour of the glass") {
  LitWorld world;
  world.box({4, 4, 4}, {28, 28, 28}, 1);
  world.surfaces[1] = medium(SurfaceKind::kGlass, {128, 255, 255}, 32);
  set_sky(&world, kWhite);
  world.finish();
  // 12 voxels of glass ahead.
  world.look({16 * 256, 16 * 256, 16 * 256}, {16 * 256, 40 * 256, 16 * 256}, 4, 9, 9);
  const Rgb8 color = world.middle(kGlassy);
  CHECK(near(color.r, absorbed(32, 128, 12), 1));
  CHECK(color.g == 255);
  // With an index: total reflection to the sides, the sky ahead.
  world.surfaces[1].index_q12 = 6144;
  CHECK(world.middle(kGlassy).g > 235);
}

TEST_CASE("an emitter inside glass: shines out, dimmed by the glass before it") {
  LitWorld world;
  world.box({4, 4, 4}, {28, 28, 28}, 1);
  world.box({14, 14, 14}, {18, 18, 18}, 2);
  world.surfaces[1] = medium(SurfaceKind::kGlass, {0, 255, 255}, 25);
  world.surfaces[2] = surface(SurfaceKind::kEmit, kWhite);
  set_ambient(&world.scene, 0);
  world.finish();
  world.look({16 * 256, -20 * 256, 16 * 256}, {16 * 256, 16 * 256, 16 * 256}, 4, 9, 9);
  const Rgb8 color = world.middle(kGlassy | Effect::kEmission);
  CHECK(near(color.r, absorbed(25, 0, 10), 1));
  CHECK(color.g == 255);
  // A camera inside the emitter sees it.
  world.look({16 * 256, 16 * 256, 16 * 256}, {16 * 256, 40 * 256, 16 * 256}, 4, 9, 9);
  CHECK(world.middle(kGlassy | Effect::kEmission) == kWhite);
}

TEST_CASE("nested media: a cloud in glass in a cloud, each takes what lies within it") {
  LitWorld world;
  world.box({0, 4, 0}, {32, 28, 32}, 1);
  world.box({0, 8, 0}, {32, 24, 32}, 2);
  world.box({0, 12, 0}, {32, 20, 32}, 3);
  world.surfaces[1] = medium(SurfaceKind::kMedia, {0, 0, 0}, 16);
  world.surfaces[2] = medium(SurfaceKind::kGlass, {0, 255, 255}, 20);
  world.surfaces[3] = world.surfaces[1];
  world.surfaces[3].density_q8 = 30;
  set_sky(&world, kWhite);
  world.finish();
  world.look({16 * 256, -20 * 256, 16 * 256}, {16 * 256, 16 * 256, 16 * 256}, 4, 9, 9);
  const Rgb8 color = world.middle(kGlassy | Effect::kMedia);
  const double clouds = std::exp2(-(16.0 * 8 + 30.0 * 8) / 256);
  CHECK(near(color.g, 255 * clouds, 1));
  CHECK(near(color.r, absorbed(20, 0, 8) * clouds, 1));
  // Only one of both in the set: the other is plain.
  LitCounts counts;
  world.draw(kGlassy, &counts);
  CHECK(counts.rays[static_cast<int>(LitRayKind::kMediaRay)] == 0);
}

TEST_CASE("index limits: beyond them an index counts as the limit, below 1 as 1") {
  LitWorld world;
  world.box({8, 8, 8}, {24, 24, 24}, 1);
  world.surfaces[1] = surface(SurfaceKind::kGlass, kWhite);
  set_sky(&world, {180, 180, 180});
  world.finish();
  world.look({40 * 256, -20 * 256, 30 * 256}, {16 * 256, 16 * 256, 16 * 256}, 50);
  const auto with = [&](std::uint16_t index) {
    world.surfaces[1].index_q12 = index;
    return world.draw(kGlassy);
  };
  CHECK(with(0) == with(kMinIndexQ12));
  CHECK(with(1000) == with(kMinIndexQ12));
  CHECK(with(65535) == with(kMaxIndexQ12));
}

/// A basin whose floor is at z = 4, with water up to `height_q8` above it.
void build_basin(LitWorld* world, int height_q8) {
  world->box({0, 0, 0}, {32, 32, 4}, 0);
  world->surfaces[0] = surface(SurfaceKind::kDiffuse, kWhite);
  set_ambient(&world->scene, 256);
  set_sky(world, kWhite);
  world->scene.has_water = true;
  world->scene.water = still_water({0, 0, 4}, 32, 32, height_q8);
  world->scene.water_material.albedo = {0, 128, 255};
  world->scene.water_material.density_q8 = 40;
}

TEST_CASE("water from above: the bottom, dimmed by the water over it") {
  LitWorld world;
  build_basin(&world, 6 * 256);
  world.finish();
  world.look({16 * 256, 16 * 256, 60 * 256}, {16 * 256, 16 * 256, 0}, 4, 9, 9);
  const Rgb8 color = world.middle(Effect::kDirectLight | Effect::kWater | Effect::kSky);
  // 2 per cent of the sky and 98 of the bottom.
  const double reflected = 255 * 0.02;
  CHECK(near(color.r, reflected + 0.98 * absorbed(40, 0, 6), 3));
  CHECK(near(color.g, reflected + 0.98 * absorbed(40, 128, 6), 3));
  CHECK(color.b >= 253);
}

TEST_CASE("water: a camera under it sees its floor near by, and up through the surface") {
  LitWorld world;
  build_basin(&world, 12 * 256);
  world.finish();
  world.look({16 * 256, 16 * 256, 8 * 256}, {16 * 256, 16 * 256, 0}, 4, 9, 9);
  const EffectSet effects = Effect::kDirectLight | Effect::kWater | Effect::kSky;
  CHECK(near(world.middle(effects).r, absorbed(40, 0, 4), 1));
  world.look({16 * 256, 16 * 256, 8 * 256}, {16 * 256, 16 * 256, 40 * 256}, 4, 9, 9);
  CHECK(near(world.middle(effects).r, 0.98 * absorbed(40, 0, 8), 4));
  // 56 degrees from straight up, beyond the critical 48.6: total reflection, so the floor's light comes
  // mirrored and no sky. The floor is white too; made black it is dark. (It comes down at x = 23: flatter,
  // and it would leave through the open side of the water, into the sky.)
  world.surfaces[0].albedo = {0, 0, 0};
  world.look({2 * 256, 16 * 256, 14 * 256}, {17 * 256, 16 * 256, 24 * 256}, 4, 9, 9);
  CHECK(world.middle(effects) == Rgb8{0, 0, 0});
  // 41 degrees: most of it goes out.
  world.look({2 * 256, 16 * 256, 10 * 256}, {9 * 256, 16 * 256, 18 * 256}, 4, 9, 9);
  CHECK(world.middle(effects).b > 200);
}

TEST_CASE("water: a camera exactly on the surface is above it looking up, in it looking down") {
  LitWorld world;
  build_basin(&world, 5 * 256 + 40);
  world.finish();
  const Vec3i eye{16 * 256 + 5, 16 * 256 + 9, 9 * 256 + 40};
  const EffectSet effects = Effect::kDirectLight | Effect::kWater | Effect::kSky;
  world.look(eye, {eye.x, eye.y, 40 * 256}, 60, 33, 33);
  for (const Rgb8& color : world.draw(effects)) {
    CHECK(color == kWhite);
  }
  world.look(eye, {eye.x, eye.y, 0}, 4, 9, 9);
  CHECK(near(world.middle(effects).r, absorbed(40, 0, 5 + 40 / 256.0), 1));
  // Level: half of the picture each, and no seam at which something else is seen.
  world.look(eye, {eye.x + 256, eye.y, eye.z}, 60, 32, 32);
  const std::vector<Rgb8> picture = world.draw(effects);
  CHECK(at(world, picture, 16, 15) == kWhite);
  CHECK(at(world, picture, 16, 31).r < 255);
}

TEST_CASE("coplanar glass and water: solid goes before water, and neither is counted twice") {
  // A block of glass of the water's own index stands in the water up to just its surface: seen from above
  // both are one.
  LitWorld world;
  build_basin(&world, 6 * 256);
  world.box({8, 8, 4}, {24, 24, 10}, 1);
  world.surfaces[1] = world.scene.water_material;
  world.finish();
  world.look({16 * 256, 5 * 256, 60 * 256}, {16 * 256, 12 * 256, 0}, 20, 64, 64);
  LitWorld water;
  build_basin(&water, 6 * 256);
  water.finish();
  water.look({16 * 256, 5 * 256, 60 * 256}, {16 * 256, 12 * 256, 0}, 20, 64, 64);
  const EffectSet effects = Effect::kDirectLight | Effect::kWater | Effect::kGlass | Effect::kSky;
  const std::vector<Rgb8> with = world.draw(effects);
  const std::vector<Rgb8> without = water.draw(effects);
  for (std::size_t i = 0; i < with.size(); ++i) {
    CHECK(distance(with[i], without[i]) <= 3);
  }
}

TEST_CASE("water: the floor, seen by total reflection at the water's open sides, is lit up to its edge") {
  // A ray that is reflected within 1/256 voxel above the floor starts on the floor's edge. It is the floor's
  // top that it sees, which the sun lights, not the side behind it.
  LitWorld world;
  build_basin(&world, 12 * 256);
  set_ambient(&world.scene, 0);
  world.lights = {sun({0, 0, 1}, 256)};
  world.scene.water_material.albedo = kWhite;
  world.finish();
  std::uint64_t sent = 0;
  for (int i = 0; i < 6; ++i) {
    world.look({48 * 256 + 40 * i, -31 * 256 - 17 * i, 25 * 256}, {16 * 256, 0, 10 * 256 + 9 * i}, 11, 160,
               120);
    LitCounts counts;
    const std::vector<Rgb8> picture =
        world.draw(Effect::kDirectLight | Effect::kWater | Effect::kSky, &counts);
    for (int pixel = 0; pixel < 160 * 120; ++pixel) {
      Hit hit;
      REQUIRE(closest_hit(world.tree, world.camera.ray(pixel % 160, pixel / 160), &hit) == Status::kOk);
      // Seen past the water: a side.
      if (hit.kind != HitKind::kHit || hit.axis == 2) {
        CHECK(picture[static_cast<std::size_t>(pixel)].g > 200);
      }
    }
    sent += counts.rays[static_cast<int>(LitRayKind::kWaterRay)];
  }
  CHECK(sent > 6 * 2 * 160 * 120);
}

TEST_CASE("light through glass: takes its colour, and what is solid behind still casts a shadow") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 2}, 0);
  world.box({4, 4, 10}, {28, 28, 14}, 1);
  world.surfaces[0].albedo = kWhite;
  world.surfaces[1] = surface(SurfaceKind::kGlass, {255, 100, 0});
  world.surfaces[1].density_q8 = 64;
  set_ambient(&world.scene, 0);
  world.lights = {sun({0, 0, 1}, 256)};
  world.finish();
  world.look({16 * 256, 16 * 256, 6 * 256}, {16 * 256, 16 * 256, 0}, 4, 9, 9);
  const Rgb8 color = world.middle(Effect::kDirectLight | Effect::kShadows | Effect::kGlass);
  CHECK(color.r == 255);
  CHECK(near(color.g, absorbed(64, 100, 4), 1));
  CHECK(near(color.b, absorbed(64, 0, 4), 1));
  // A lamp within the glass: only what is below it counts.
  world.lights = {lamp({16 * 256, 16 * 256, 12 * 256}, 256, 60000)};
  world.finish();
  CHECK(
      near(world.middle(Effect::kDirectLight | Effect::kShadows | Effect::kGlass).b, absorbed(64, 0, 2), 1));
  LitWorld covered;
  covered.box({0, 0, 0}, {32, 32, 2}, 0);
  covered.box({4, 4, 10}, {28, 28, 14}, 1);
  covered.box({4, 4, 14}, {28, 28, 15}, 0);
  covered.surfaces = world.surfaces;
  set_ambient(&covered.scene, 0);
  covered.lights = {sun({0, 0, 1}, 256)};
  covered.finish();
  covered.look({16 * 256, 16 * 256, 6 * 256}, {16 * 256, 16 * 256, 0}, 4, 9, 9);
  CHECK(covered.middle(Effect::kDirectLight | Effect::kShadows | Effect::kGlass).r == 0);
}

TEST_CASE("fog: between air and what is seen, by the distance") {
  LitWorld world;
  world.box({0, 24, 0}, {32, 26, 32}, 0);
  world.surfaces[0].albedo = {0, 0, 0};
  world.scene.fog.color = {200, 100, 50};
  world.scene.fog.density_q16 = 65536 / 20;
  world.finish();
  // 40 voxels: two halvings.
  world.look({16 * 256, -16 * 256, 16 * 256}, {16 * 256, 0, 16 * 256}, 4, 9, 9);
  const Rgb8 color = world.middle(Effect::kDirectLight | Effect::kFog);
  CHECK(near(color.r, 150, 1));
  CHECK(near(color.g, 75, 1));
  CHECK(near(color.b, 37.5, 1));
}

}  // namespace

// What lies between and behind things: sky and depth cue, against their formulas in doubles.
namespace thimble::testing {
namespace {

double mixed(double from, double to, double share) {
  return from + (to - from) * share;
}

TEST_CASE(
    "sky: every pixel -> the gradient of its ray's height, within two steps; ground below the horizon") {
  LitWorld world;
  world.voxel({0, 0, 0}, 0);
  world.scene.sky.zenith = {10, 60, 250};
  world.scene.sky.horizon = {240, 200, 180};
  world.scene.sky.ground = {90, 80, 20};
  world.finish();
  int above = 0;
  int below = 0;
  for (const int height : {-40, -3, 0, 2, 60}) {
    CAPTURE(height);
    world.look({-20 * 256, -30 * 256, 16 * 256}, {-20 * 256, -130 * 256, (16 + height) * 256}, 70);
    const std::vector<Rgb8> picture = world.draw(Effect::kSky);
    for (int y = 0; y < world.camera.height_px(); ++y) {
      for (int x = 0; x < world.camera.width_px(); ++x) {
        const Vec3i ray = world.camera.ray(x, y).direction;
        const double length =
            std::hypot(static_cast<double>(ray.x), static_cast<double>(ray.y), static_cast<double>(ray.z));
        const double steep = std::abs(ray.z) / length;
        const bool is_up = ray.z >= 0;
        (is_up ? above : below) += 1;
        const Rgb8 far = is_up ? world.scene.sky.zenith : world.scene.sky.ground;
        const Rgb8 near = world.scene.sky.horizon;
        const double share = 1 - std::pow(1 - steep, is_up ? 2 : 8);
        const Rgb8 is = picture[static_cast<std::size_t>(y * world.camera.width_px() + x)];
        REQUIRE(std::abs(is.r - mixed(near.r, far.r, share)) < 2);
        REQUIRE(std::abs(is.g - mixed(near.g, far.g, share)) < 2);
        REQUIRE(std::abs(is.b - mixed(near.b, far.b, share)) < 2);
      }
    }
  }
  CHECK(above > 1000);
  CHECK(below > 1000);
}

TEST_CASE("depth cue: colours times the brightness that shade mode depth gives their distance") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 2}, 1);
  world.box({6, 8, 2}, {12, 14, 9}, 2);
  world.box({20, 16, 2}, {30, 22, 20}, 3);
  world.surfaces[1].albedo = {250, 120, 60};
  world.surfaces[2].albedo = {40, 230, 90};
  world.surfaces[3].albedo = {200, 200, 255};
  world.finish();
  world.look({-10 * 256, -20 * 256, 30 * 256}, {16 * 256, 16 * 256, 4 * 256});
  world.shading.near_q8 = 30 * 256;
  world.shading.far_q8 = 70 * 256;
  world.lights = {sun({-5, -9, 16}, 120)};  // nothing so bright that it is cut off
  set_ambient(&world.scene, 60);
  world.scene.lights = {world.lights.data(), world.lights.size()};
  const std::vector<Rgb8> plain = world.draw(Effect::kDirectLight);
  const std::vector<Rgb8> cued = world.draw(Effect::kDirectLight | Effect::kDepthCue);
  Shading depth = world.shading;
  depth.mode = ShadeMode::kDepth;
  std::vector<std::uint8_t> grays(plain.size());
  const Band band{{grays.data(), grays.size()}, PixelFormat::kGray8, 0, 0, world.camera.height_px()};
  REQUIRE(render_band(world.tree, world.camera, depth, band) == Status::kOk);
  int between = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CAPTURE(i);
    if (grays[i] == 0) {
      continue;  // what is missed keeps the background
    }
    const double share = grays[i] / 255.0;
    REQUIRE(std::abs(cued[i].r - plain[i].r * share) < 1.5);
    REQUIRE(std::abs(cued[i].g - plain[i].g * share) < 1.5);
    REQUIRE(std::abs(cued[i].b - plain[i].b * share) < 1.5);
    between += grays[i] > 20 && grays[i] < 235 ? 1 : 0;
  }
  CHECK(between > 300);
}

}  // namespace
}  // namespace thimble::testing
