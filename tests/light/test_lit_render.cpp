#include <doctest/doctest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "support/formats.h"
#include "support/lit_world.h"
#include "thimble/light/render.h"

namespace {

using namespace thimble;
using namespace thimble::testing;

/// Something of everything: materials 0 stone, 1 metal, 2 glass, 3 lamp, 4 cloud, 5 rough metal.
class EveryEffect : public LitWorld {
 public:
  EveryEffect() {
    call_for_everything();
    box({0, 0, 0}, {32, 32, 4}, 0);
    box({2, 20, 4}, {10, 28, 14}, 1);
    box({12, 8, 6}, {20, 16, 14}, 2);
    box({24, 24, 4}, {28, 28, 9}, 3);
    box({14, 20, 12}, {26, 28, 20}, 4);
    box({24, 6, 4}, {29, 11, 12}, 5);
    lights = {sun({-6, -9, 12}), lamp({20 * 256, 4 * 256, 20 * 256}, 300, 12)};
    scene.water = still_water({2, 2, 4}, 28, 28, 3 * 256 + 77);
    finish();
    look({-10 * 256, -22 * 256, 26 * 256}, {16 * 256, 15 * 256, 6 * 256}, 44);
    set_depth_range();
  }
};

template <EffectSet kSet>
void expect_same_as_fixed(const EveryEffect& world) {
  CAPTURE(kSet);
  std::vector<std::uint8_t> fixed(band_bytes(PixelFormat::kRgb888, 48, 36));
  std::vector<std::uint8_t> chosen(fixed.size());
  LitCounts fixed_counts;
  LitCounts chosen_counts;
  REQUIRE(render_lit_band<kSet>(world.tree, world.camera, world.shading, world.scene,
                                {{fixed.data(), fixed.size()}, PixelFormat::kRgb888, 0, 0, 36},
                                &fixed_counts) == Status::kOk);
  REQUIRE(render_lit_band(kSet, world.tree, world.camera, world.shading, world.scene,
                          {{chosen.data(), chosen.size()}, PixelFormat::kRgb888, 0, 0, 36},
                          &chosen_counts) == Status::kOk);
  CHECK(fixed == chosen);
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    CHECK(fixed_counts.rays[kind] == chosen_counts.rays[kind]);
    CHECK(fixed_counts.node_visits[kind] == chosen_counts.node_visits[kind]);
  }
}

TEST_CASE("no effects: the picture of render_band, in every format and shade mode") {
  EveryEffect world;
  for (const PixelFormat format : kFormats) {
    for (const ShadeMode mode :
         {ShadeMode::kDepth, ShadeMode::kNormal, ShadeMode::kColor, ShadeMode::kMono}) {
      world.shading.mode = mode;
      std::vector<std::uint8_t> plain(band_bytes(format, 48, 36));
      std::vector<std::uint8_t> lit(plain.size());
      RenderCounts plain_counts;
      LitCounts counts;
      REQUIRE(render_band(world.tree, world.camera, world.shading,
                          {{plain.data(), plain.size()}, format, 0, 0, 36}, &plain_counts) == Status::kOk);
      REQUIRE(render_lit_band<Effect::kNone>(world.tree, world.camera, world.shading, world.scene,
                                             {{lit.data(), lit.size()}, format, 0, 0, 36},
                                             &counts) == Status::kOk);
      CHECK(plain == lit);
      CHECK(counts.rays[0] == plain_counts.rays);
      CHECK(counts.hits[0] == plain_counts.hits);
      CHECK(counts.node_visits[0] == plain_counts.node_visits);
      for (int kind = 1; kind < kLitRayKinds; ++kind) {
        CHECK(counts.rays[kind] == 0);
      }
    }
  }
  static_assert(lit_render_bytes(Effect::kNone) == render_bytes());
}

TEST_CASE("a set known when compiling: the picture and the rays of the same set when running") {
  const EveryEffect world;
  expect_same_as_fixed<Effect::kDirectLight>(world);
  expect_same_as_fixed<Effect::kDirectLight | Effect::kShadows>(world);
  expect_same_as_fixed<Effect::kAmbientOcclusion | Effect::kSky>(world);
  expect_same_as_fixed<Effect::kDirectLight | Effect::kEmission | Effect::kFog>(world);
  expect_same_as_fixed<Effect::kMirror | Effect::kDepthCue>(world);
  expect_same_as_fixed<Effect::kGlass>(world);
  expect_same_as_fixed<Effect::kMedia | Effect::kDirectLight | Effect::kShadows>(world);
  expect_same_as_fixed<Effect::kWater | Effect::kSky | Effect::kDirectLight | Effect::kShadows>(world);
  expect_same_as_fixed<Effect::kSmoothNormals>(world);
  expect_same_as_fixed<Effect::kSmoothNormals | Effect::kDirectLight | Effect::kMirror>(world);
  expect_same_as_fixed<Effect::kAll & ~Effect::kSmoothNormals>(world);
  expect_same_as_fixed<Effect::kEdges>(world);
  expect_same_as_fixed<Effect::kEdges | Effect::kDirectLight | Effect::kShadows>(world);
  expect_same_as_fixed<Effect::kRipples | Effect::kWater | Effect::kSky>(world);
  expect_same_as_fixed<Effect::kAll>(world);
}

TEST_CASE("an effect that is not in the set: no ray of it, and it makes no difference to the others' code") {
  const EveryEffect world;
  constexpr std::pair<EffectSet, LitRayKind> kKinds[] = {
      {Effect::kShadows, LitRayKind::kShadow},   {Effect::kAmbientOcclusion, LitRayKind::kOcclusion},
      {Effect::kMirror, LitRayKind::kMirrorRay}, {Effect::kGlass, LitRayKind::kGlassRay},
      {Effect::kMedia, LitRayKind::kMediaRay},   {Effect::kWater, LitRayKind::kWaterRay}};
  // Edges look at what is opaque, and so at more where less is clear.
  constexpr EffectSet kAllButEdges = Effect::kAll & ~Effect::kEdges;
  LitCounts all;
  world.draw(kAllButEdges, &all);
  for (const auto& [each_effect, kind] : kKinds) {
    const auto& effect = each_effect;
    CAPTURE(effect);
    const int index = static_cast<int>(kind);
    CHECK(all.rays[index] > 0);
    LitCounts without;
    world.draw(kAllButEdges & ~effect, &without);
    CHECK(without.rays[index] == 0);
    CHECK(without.hits[index] == 0);
    CHECK(without.node_visits[index] == 0);
    CHECK(without.rays[0] == all.rays[0]);
  }
  // Without any that sends rays on: none waits, and there is no place for one.
  LitCounts primary;
  world.draw(Effect::kDirectLight | Effect::kEmission | Effect::kFog | Effect::kSky | Effect::kDepthCue,
             &primary);
  for (int kind = 1; kind < kLitRayKinds; ++kind) {
    CHECK(primary.rays[kind] == 0);
    CHECK(primary.node_visits[kind] == 0);
  }
  CHECK(primary.pending_high_water == 0);
}

TEST_CASE("state: rays that wait take bytes only where the set sends any on, and never more than that") {
  static_assert(lit::pending_rays(Effect::kAll & ~Effect::kBranching) == 0);
  static_assert(lit::pending_rays(Effect::kMedia) == 0);
  static_assert(lit::pending_rays(Effect::kMirror) == 4);
  static_assert(lit_render_bytes(Effect::kDirectLight) <
                lit_render_bytes(Effect::kDirectLight | Effect::kMirror));
  static_assert(lit_render_bytes(Effect::kMirror) < lit_render_bytes(Effect::kMirror | Effect::kGlass));
  EveryEffect world;
  world.scene.bounces = kMaxBounces;
  LitCounts counts;
  world.draw(Effect::kAll, &counts);
  CHECK(counts.pending_high_water > 2);
  CHECK(counts.pending_high_water <= lit::pending_rays(Effect::kAll));
}

TEST_CASE("effects_of: every material and light calls for its own effect and nothing else") {
  LitScene scene;
  CHECK(effects_of(scene) == Effect::kNone);
  Surface one;
  scene.surfaces = {&one, 1};
  CHECK(effects_of(scene) == Effect::kNone);
  constexpr std::pair<SurfaceKind, EffectSet> kKinds[] = {{SurfaceKind::kMetal, Effect::kMirror},
                                                          {SurfaceKind::kGlass, Effect::kGlass},
                                                          {SurfaceKind::kEmit, Effect::kEmission},
                                                          {SurfaceKind::kMedia, Effect::kMedia}};
  for (const auto& [kind, effect] : kKinds) {
    one.kind = kind;
    CHECK(effects_of(scene) == effect);
    const bool none[256] = {};
    CHECK(effects_of(scene, &none) == Effect::kNone);
  }
  CHECK(effect_name(Effect::kAmbientOcclusion) == doctest::String("ambient-occlusion"));
  CHECK(effect_name(Effect::kGlass | Effect::kMirror) == doctest::String(""));
  CHECK(effect_name(1U << Effect::kCount) == doctest::String(""));
}

TEST_CASE("limits: too many lights, surfaces or bounces are an error, with nothing drawn") {
  EveryEffect world;
  std::vector<std::uint8_t> pixels(band_bytes(PixelFormat::kGray8, 48, 36), 0xA5);
  const std::vector<std::uint8_t> untouched = pixels;
  Band band{{pixels.data(), pixels.size()}, PixelFormat::kGray8, 0, 0, 36};
  const auto drawn = [&] {
    return render_lit_band(Effect::kAll, world.tree, world.camera, world.shading, world.scene, band);
  };
  const LitScene sound = world.scene;
  const std::vector<Light> lights(kMaxLights + 1, sun({0, 0, 1}));
  world.scene.lights = {lights.data(), lights.size()};
  CHECK(drawn() == Status::kOutOfRange);
  world.scene = sound;
  const std::vector<Surface> surfaces(kMaxSurfaces + 1);
  world.scene.surfaces = {surfaces.data(), surfaces.size()};
  CHECK(drawn() == Status::kOutOfRange);
  world.scene = sound;
  world.scene.bounces = kMaxBounces + 1;
  CHECK(drawn() == Status::kOutOfRange);
  world.scene = sound;
  band.first_row = 1;
  CHECK(drawn() == Status::kBadArgument);
  band.first_row = 0;
  band.pixels.size -= 1;
  CHECK(drawn() == Status::kOutOfMemory);
  CHECK(pixels == untouched);
}

TEST_CASE("a hundred lights: as bright as one of their sum") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 4}, 0);
  world.surfaces[0].albedo = {255, 200, 100};
  set_ambient(&world.scene, 0);
  world.lights.assign(kMaxLights, sun({0, 0, 1}, 2));
  world.finish();
  world.look({16 * 256, 16 * 256, 40 * 256}, {16 * 256, 16 * 256, 0});
  const Rgb8 many = world.middle(Effect::kDirectLight | Effect::kShadows);
  world.lights = {sun({0, 0, 1}, 200)};
  world.finish();
  CHECK(many == world.middle(Effect::kDirectLight | Effect::kShadows));
  CHECK(many.r == 199);
  LitCounts counts;
  world.lights.assign(kMaxLights, sun({0, 0, 1}, 2));
  world.finish();
  world.draw(Effect::kDirectLight | Effect::kShadows, &counts);
  CHECK(counts.rays[static_cast<int>(LitRayKind::kShadow)] == kMaxLights * counts.hits[0]);
}

TEST_CASE("a point light: falls off with the distance as documented") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 4}, 0);
  world.surfaces[0].albedo = {255, 255, 255};
  set_ambient(&world.scene, 0);
  // Straight below it, 16 voxels away: one and a half... (1 + 16 / 16)^2 = 4.
  world.lights = {lamp({16 * 256, 16 * 256, 20 * 256}, 256, 16)};
  world.finish();
  world.look({16 * 256, 16 * 256, 40 * 256}, {16 * 256, 16 * 256, 0}, 20, 49, 37);
  const Rgb8 color = world.middle(Effect::kDirectLight);
  CHECK(color.r >= 62);
  CHECK(color.r <= 64);
}

}  // namespace
