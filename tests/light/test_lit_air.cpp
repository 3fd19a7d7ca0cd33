// What lies between and behind things: sky and depth cue, against their formulas in doubles.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/lit_world.h"

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
