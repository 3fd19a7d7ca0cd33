// Ripples on water (Effect::kRipples), and what depth takes from light there.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/lit_world.h"
#include "thimble/base/memory.h"

namespace thimble::testing {
namespace {

constexpr EffectSet kPool = Effect::kDirectLight | Effect::kWater | Effect::kSky;

int brightness_of(const Rgb8& color) {
  return color.r + color.g + color.b;
}

// A basin of stone, 14 voxels of water in it, seen from above and from a side.
class Basin : public LitWorld {
 public:
  Basin() {
    box({0, 0, 0}, {32, 32, 2}, 1);
    surfaces[1].albedo = {200, 190, 170};
    lights = {sun({-3, 8, 6})};
    scene.has_sky = true;
    scene.has_water = true;
    scene.water = still_water({0, 0, 2}, 32, 32, 14 * 256);
    finish();
    look({16 * 256, -26 * 256, 34 * 256}, {16 * 256, 18 * 256, 14 * 256}, 40, 96, 72);
  }
};

std::uint32_t crc_of(const std::vector<Rgb8>& picture) {
  return crc32({reinterpret_cast<const std::uint8_t*>(picture.data()), 3 * picture.size()});
}

}  // namespace

TEST_CASE("ripples: the sun is seen in water where without there is sky alone, and they run with the phase") {
  Basin basin;
  LitCounts without;
  LitCounts with;
  const std::vector<Rgb8> flat = basin.draw(kPool, &without);
  const std::vector<Rgb8> rippled = basin.draw(kPool | Effect::kRipples, &with);
  int brighter = 0;
  std::size_t changed = 0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    brighter += brightness_of(rippled[i]) > brightness_of(flat[i]) + 60 ? 1 : 0;
    changed += rippled[i] == flat[i] ? 0U : 1U;
  }
  CHECK(brighter > 20);
  CHECK(changed > flat.size() / 4);
  // What is seen of water is the same: its surface is where it was.
  CHECK(with.rays[0] == without.rays[0]);
  CHECK(with.hits[0] == without.hits[0]);
  basin.scene.ripple_phase = 3;
  CHECK(basin.draw(kPool | Effect::kRipples) != rippled);
  CHECK(basin.draw(kPool) == flat);
  // One picture on every machine.
  CHECK(crc_of(rippled) == 0xD22445DC);
}

TEST_CASE(
    "ripples: by their definition in real numbers -> the sun stands in the water where they send rays into "
    "it") {
  Basin basin;
  basin.surfaces[1].albedo = {0, 0, 0};  // what is bright is the sun's
  basin.scene.has_sky = false;
  basin.shading.background = {0, 0, 0};
  basin.scene.ripple_phase = 21;
  const Vec3i down{0, 400, -300};
  OrthographicView view{
      LitWorld::point({16 * 256 + 31, -10 * 256 + 7, 36 * 256}), down, {}, Q14::saturate(20), 96, 72};
  REQUIRE(basin.camera.set(view, basin.tree.level()) == Status::kOk);
  basin.lights = {sun({20, 400, 310})};
  basin.finish();
  const auto unit = [](double x, double y, double z) {
    const double length = std::sqrt(x * x + y * y + z * z);
    return std::array<double, 3>{x / length, y / length, z / length};
  };
  const std::array<double, 3> towards = unit(20, 400, 310);
  const std::array<double, 3> looks = unit(0, 400, -300);
  struct Wave {
    double x, y, runs, steep;
  };
  constexpr Wave kWaves[] = {{4, 2, 1, 9}, {-6, 9, -3, 4}, {5, -14, 4, 3}, {16, 12, -5, 2}};
  const std::vector<Rgb8> seen = basin.draw(Effect::kDirectLight | Effect::kWater | Effect::kRipples);
  int bright = 0;
  int black = 0;
  for (int y = 0; y < 72; ++y) {
    for (int x = 0; x < 96; ++x) {
      const Ray ray = basin.camera.ray(x, y);
      const double t = (16 * 256 - ray.origin.z.raw) / double(ray.direction.z);
      const double at[] = {(ray.origin.x.raw + t * ray.direction.x) / 256,
                           (ray.origin.y.raw + t * ray.direction.y) / 256};
      double slope[2] = {};
      double before = 0;
      for (const Wave& wave : kWaves) {
        // A crest every 64 / |(x, y)| voxels; shifted by what the one before is.
        const double turn = (wave.x * at[0] + wave.y * at[1]) / 64 + wave.runs * 21 / 256 + before / 256;
        before = 127 * std::cos(2 * M_PI * turn);
        slope[0] += before * wave.steep * wave.x / 8;
        slope[1] += before * wave.steep * wave.y / 8;
      }
      const std::array<double, 3> normal = unit(-slope[0], -slope[1], 16384);
      const double along = looks[0] * normal[0] + looks[1] * normal[1] + looks[2] * normal[2];
      double cosine = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        cosine += (looks[i] - 2 * along * normal[i]) * towards[i];
      }
      const double degrees = std::acos(cosine) * 180 / M_PI;
      const bool is_bright = brightness_of(seen[static_cast<std::size_t>(y * 96 + x)]) > 0;
      CAPTURE(x);
      CAPTURE(y);
      CAPTURE(degrees);
      CHECK((degrees > 5.5 || is_bright));
      CHECK((degrees < 8.5 || !is_bright));
      bright += is_bright ? 1 : 0;
      black += is_bright ? 0 : 1;
    }
  }
  CHECK(bright > 300);
  CHECK(black > 300);

  // Neither from a lamp, nor brighter than from a sun of 4.
  basin.lights = {lamp({20 * 256, 100 * 256, 90 * 256})};
  basin.finish();
  for (const Rgb8& color : basin.draw(Effect::kDirectLight | Effect::kWater | Effect::kRipples)) {
    REQUIRE(brightness_of(color) == 0);
  }
  std::vector<Rgb8> strong[2];
  for (int i = 0; i < 2; ++i) {
    basin.lights = {sun({20, 400, 310}, i == 0 ? 1024 : 5000)};
    basin.finish();
    strong[i] = basin.draw(Effect::kDirectLight | Effect::kWater | Effect::kRipples);
  }
  CHECK(strong[0] == strong[1]);
}

TEST_CASE("ripples: after the last bounce, and from behind a ripple -> the water as it is without") {
  Basin basin;
  basin.lights = {};
  basin.surfaces[1] = surface(SurfaceKind::kMetal, {255, 255, 255});
  basin.finish();
  basin.scene.bounces = 0;
  CHECK(basin.draw(kPool | Effect::kRipples) == basin.draw(kPool));
  basin.scene.bounces = 2;
  LitCounts with;
  LitCounts without;
  constexpr EffectSet kMirrors = kPool | Effect::kMirror;
  CHECK(basin.draw(kMirrors | Effect::kRipples, &with) != basin.draw(kMirrors, &without));
  // In, back from the floor, and straight out: none splits a third time.
  constexpr int kWaterRays = static_cast<int>(LitRayKind::kWaterRay);
  CHECK(without.rays[kWaterRays] > 96 * 72);
  CHECK(with.rays[kWaterRays] < without.rays[kWaterRays] * 21 / 20);

  // Along the water, half a degree down: half of the ripples are seen from behind, and not one from below.
  Basin flat;
  flat.lights = {};
  flat.finish();
  OrthographicView view{
      LitWorld::point({16 * 256, -100 * 256, 17 * 256}), {0, 1000, -9}, {}, Q14::saturate(24), 96, 4};
  REQUIRE(flat.camera.set(view, flat.tree.level()) == Status::kOk);
  const std::vector<Rgb8> plain = flat.draw(kPool);
  const std::vector<Rgb8> rippled = flat.draw(kPool | Effect::kRipples);
  int same = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    same += plain[i] == rippled[i] ? 1 : 0;
  }
  CHECK(same > 310);  // of 384
  CHECK(same < 380);
}

TEST_CASE("ripples: from below, light that comes through is as bright as through still water, on the whole") {
  Basin basin;
  basin.lights = {};
  basin.finish();
  basin.scene.sky = {{200, 200, 200}, {200, 200, 200}, {200, 200, 200}};
  basin.scene.water_material.density_q8 = 0;
  basin.surfaces[1].albedo = {0, 0, 0};
  OrthographicView view;
  view.eye = LitWorld::point({16 * 256, 10 * 256, 8 * 256});
  view.forward = {0, 933, 1000};  // 43 degrees: out there 65
  view.span = Q14::saturate(9);
  view.width_px = 96;
  view.height_px = 40;
  REQUIRE(basin.camera.set(view, basin.tree.level()) == Status::kOk);
  double sums[2] = {};
  for (int i = 0; i < 2; ++i) {
    for (const Rgb8& color : basin.draw(i == 0 ? kPool : kPool | Effect::kRipples)) {
      sums[i] += brightness_of(color);
    }
  }
  CHECK(sums[0] > 0);
  const double share = sums[1] / sums[0];
  CHECK(share > 0.97);
  CHECK(share < 1.04);
}

TEST_CASE("ripples: a world without water, or water as clear as air -> the picture without them") {
  Basin basin;
  CHECK(basin.draw((kPool & ~Effect::kWater) | Effect::kRipples) == basin.draw(kPool & ~Effect::kWater));
  basin.scene.water_material.index_q12 = kMinIndexQ12;
  CHECK(basin.draw(kPool | Effect::kRipples) == basin.draw(kPool));
}

}  // namespace thimble::testing
