// A room with a lamp, a mirror and glass, drawn with the effects that it was baked for and no others: what it
// does not call for is not in the image. scene.h is made by
//   thimble bake tools/gallery/scenes/room.scene --size 128x64 -o scene.h
#include "../display.h"
#include "scene.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
using namespace thimble;

int main() {
  static uint8_t pixels[band_bytes(PixelFormat::kGray4, kDisplayWidth, kDisplayBandRows)];
  BakedScene scene;
  BakedLighting lighting;
  Camera camera;
  Status status = BakedScene::open({thimble_scene, sizeof(thimble_scene)}, &scene);
  if (status == Status::kOk) {
    status = BakedLighting::open(scene.section(SectionKind::kLighting), scene.tree().level(), &lighting);
  }
  if (status == Status::kOk) {
    status = set_camera(scene.camera(), kDisplayWidth, kDisplayHeight, scene.tree().level(), &camera);
  }
  Shading shading;
  shading.palette = scene.palette();
  Band band{Bytes(pixels), PixelFormat::kGray4, 0, 0, kDisplayBandRows};
  for (uint32_t frame = 0; status == Status::kOk && display_wait(frame); ++frame) {
    for (band.first_row = 0; band.first_row < kDisplayHeight && status == Status::kOk;
         band.first_row += kDisplayBandRows) {
      status = render_lit_band<THIMBLE_SCENE_EFFECTS>(scene.tree(), camera, shading, lighting.scene, band);
      if (status == Status::kOk) {
        display_send(band.first_row, band.rows, band.pixels.data, band.pixels.size);
      }
    }
  }
  return static_cast<int>(status);
}
