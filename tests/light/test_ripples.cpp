// Ripples on water (Effect::kRipples), and what depth takes from light there.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/lit_world.h"
#include "thimble/base/crc32.h"

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

TEST_CASE("ripples: a world without water, or water as clear as air -> the picture without them") {
  Basin basin;
  CHECK(basin.draw((kPool & ~Effect::kWater) | Effect::kRipples) == basin.draw(kPool & ~Effect::kWater));
  basin.scene.water_material.index_q12 = kMinIndexQ12;
  CHECK(basin.draw(kPool | Effect::kRipples) == basin.draw(kPool));
}

TEST_CASE("water: what comes up through d voxels of it has halved density * (1 - albedo) * d times") {
  // Straight down on a floor that a lamp-less ambient light makes white: what is left is what water leaves.
  for (const int depth : {2, 7, 20}) {
    CAPTURE(depth);
    LitWorld world;
    world.box({0, 0, 0}, {32, 32, 2}, 1);
    world.surfaces[1].albedo = {255, 255, 255};
    world.scene.has_water = true;
    world.scene.water = still_water({0, 0, 2}, 32, 32, depth * 256);
    Surface& water = world.scene.water_material;
    water.albedo = {55, 155, 255};
    water.density_q8 = 40;
    water.index_q12 = kMinIndexQ12;  // nothing is mirrored
    world.finish();
    set_ambient(&world.scene, 256);
    world.look({16 * 256 + 128, 16 * 256 + 128, 31 * 256}, {16 * 256 + 128, 16 * 256 + 129, 0}, 2, 8, 8);
    const Rgb8 seen = world.middle(Effect::kDirectLight | Effect::kWater);
    const Rgb8 dry = world.middle(Effect::kDirectLight);
    const auto left = [&](int channel, int albedo) {
      return channel * std::exp2(-40.0 / 256 * (255 - albedo) / 255 * depth);
    };
    CHECK(std::abs(seen.r - left(dry.r, 55)) < 1.5);
    CHECK(std::abs(seen.g - left(dry.g, 155)) < 1.5);
    CHECK(seen.b == dry.b);
  }
}

}  // namespace thimble::testing
