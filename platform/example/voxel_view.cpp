// A voxel model on your own display. Yours: a function that takes rows of pixels, and scene.h, made by
//   thimble bake MODEL.vox --size 128x64 -o scene.h
#include "thimble/bake/baked_scene.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"

#include "scene.h"

/// Sends finished rows to the display; the bytes are free again when it returns.
extern "C" void display_send(int first_row, int rows, const uint8_t* bytes, size_t size);
/// Draws a frame with the eye moved sideways by some 1/256 voxel; 0, or a number to look up in status.h.
extern "C" int voxel_view_draw(int32_t sideways_q8);

namespace {
using namespace thimble;
constexpr int32_t kWidth = 128;
constexpr int32_t kHeight = 64;
constexpr int32_t kBandRows = 8;
uint8_t memory[band_bytes(PixelFormat::kGray4, kWidth, kBandRows)];  // all the RAM it takes but stack
}  // namespace

int voxel_view_draw(int32_t sideways_q8) {
  BakedScene scene;
  Status status = BakedScene::open({thimble_scene, sizeof(thimble_scene)}, &scene);
  SceneCamera from = scene.camera();
  from.eye.x = Q8::from_raw(from.eye.x.raw + sideways_q8);
  from.forward = {};  // look at the target from there
  Camera camera;
  if (status == Status::kOk) {
    status = set_camera(from, kWidth, kHeight, scene.tree().level(), &camera);
  }
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = scene.palette();
  Arena arena{Bytes(memory)};  // with more than one thing in it, each takes its part
  Band band{arena.take(sizeof(memory), 1), PixelFormat::kGray4, 0, 0, kBandRows};
  for (; band.first_row < kHeight && status == Status::kOk; band.first_row += kBandRows) {
    status = render_band(scene.tree(), camera, shading, band);
    if (status == Status::kOk) {
      display_send(band.first_row, band.rows, band.pixels.data, band.pixels.size);
    }
  }
  return static_cast<int>(status);
}
