// A baked model on a display: nothing in RAM but a band of rows, 512 bytes. scene.h is made by
//   thimble bake MODEL.vox --size 128x64 -o scene.h
#include "../display.h"
#include "scene.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/picture/render.h"
using namespace thimble;

namespace {

uint8_t pixels[band_bytes(PixelFormat::kGray4, kDisplayWidth, kDisplayBandRows)];

/// Draws a frame with the eye moved sideways by some 1/256 voxel.
Status draw(const BakedScene& scene, int32_t sideways_q8) {
  SceneCamera from = scene.camera();
  if (sideways_q8 != 0) {
    from.eye.x = Q8::from_raw(from.eye.x.raw + sideways_q8);
    from.forward = {};  // look at the target from there
  }
  Camera camera;
  Status status = set_camera(from, kDisplayWidth, kDisplayHeight, scene.tree().level(), &camera);
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = scene.palette();
  Band band{Bytes(pixels), PixelFormat::kGray4, 0, 0, kDisplayBandRows};
  for (; band.first_row < kDisplayHeight && status == Status::kOk; band.first_row += kDisplayBandRows) {
    status = render_band(scene.tree(), camera, shading, band);
    if (status == Status::kOk) {
      display_send(band.first_row, band.rows, band.pixels.data, band.pixels.size);
    }
  }
  return status;
}

}  // namespace

int main() {
  BakedScene scene;
  Status status = BakedScene::open({thimble_scene, sizeof(thimble_scene)}, &scene);
  for (uint32_t frame = 0; status == Status::kOk && display_wait(frame); ++frame) {
    status = draw(scene, static_cast<int32_t>(frame % 256) * 32);
  }
  return static_cast<int>(status);
}
