// Water that moves round a stone: 32 x 32 columns, the scene and a band in 12 KiB. A finger touches it
// now and then.
#include "../display.h"
#include "thimble/light/render.h"
#include "thimble/thimble.h"
using namespace thimble;

namespace {

constexpr int32_t kSide = 32;
constexpr EffectSet kEffects = Effect::kDirectLight | Effect::kShadows | Effect::kWater | Effect::kSky;
uint8_t memory[12 * 1024];

/// The solid world: a floor, and a stone that reaches out of the water.
Status build(Arena& arena, CompactTree* tree) {
  Octree octree;
  Status status = Octree::make(5, 200, arena, &octree);
  if (status == Status::kOk) {
    status = octree.insert_box({{0, 0, 0}, {kSide, kSide, 4}}, 1);
  }
  if (status == Status::kOk) {
    status = octree.insert_box({{18, 18, 4}, {24, 24, 16}}, 2);
  }
  return status == Status::kOk ? CompactTree::make(octree, arena, tree) : status;
}

/// Still water four voxels deep on the floor; there is none where the stone stands.
Status pour(Arena& arena, Water* water) {
  uint8_t blocked[kSide * kSide / 8] = {};
  for (int32_t y = 18; y < 24; ++y) {
    for (int32_t x = 18; x < 24; ++x) {
      blocked[(y * kSide + x) / 8] |= static_cast<uint8_t>(1U << (x % 8));
    }
  }
  WaterConfig config;
  config.width = kSide;
  config.depth = kSide;
  config.rest_q8 = 4 * 256;
  config.least_q8 = 1 * 256;
  config.greatest_q8 = 8 * 256;
  config.blocked = ConstBytes(blocked);
  return Water::make(config, arena.take(water_bytes(kSide, kSide)), water);
}

Status aim(Camera* camera) {
  PerspectiveView view;
  view.eye = {Q8::saturate(-8), Q8::saturate(-22), Q8::saturate(24)};
  view.forward = look_at(view.eye, {Q8::saturate(17), Q8::saturate(15), Q8::saturate(6)});
  view.fov_degrees = Q16::saturate(34);
  view.width_px = kDisplayWidth;
  view.height_px = kDisplayHeight;
  return camera->set(view, 5);
}

}  // namespace

int main() {
  Arena arena{Bytes(memory)};
  CompactTree tree;
  Water water;
  Camera camera;
  Status status = build(arena, &tree);
  status = status == Status::kOk ? pour(arena, &water) : status;
  status = status == Status::kOk ? aim(&camera) : status;

  Surface surfaces[3];  // by material: 0 is not used, 1 the floor, 2 the stone
  surfaces[1].albedo = {196, 176, 130};
  surfaces[2].albedo = {150, 146, 140};
  const Light sun;
  LitScene scene;
  scene.surfaces = {surfaces, 3};
  scene.lights = {&sun, 1};
  scene.has_water = true;
  const Shading shading;
  Band band{arena.take(band_bytes(PixelFormat::kGray4, kDisplayWidth, kDisplayBandRows)), PixelFormat::kGray4,
            0, 0, kDisplayBandRows};

  for (uint32_t frame = 0; status == Status::kOk && display_wait(frame); ++frame) {
    if (frame % 64 == 8) {
      status = water.touch(10 * 256, 10 * 256, 4 * 256, 2 * 256);
    }
    water.step();  // costs nothing once the water lies still
    scene.water = water.surface({0, 0, 4});
    for (band.first_row = 0; band.first_row < kDisplayHeight && status == Status::kOk;
         band.first_row += kDisplayBandRows) {
      status = render_lit_band<kEffects>(tree, camera, shading, scene, band);
      if (status == Status::kOk) {
        display_send(band.first_row, band.rows, band.pixels.data, band.pixels.size);
      }
    }
  }
  return static_cast<int>(status);
}
