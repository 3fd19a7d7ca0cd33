// A baked model on a display, in C99: what ../baked_scene does in C++. scene.h is made by
//   thimble bake MODEL.vox --size 128x64 -o scene.h
#include "../display.h"
#include "scene.h"
#include "thimble/thimble_c.h"

static uint8_t pixels[kDisplayWidth / 2 * kDisplayBandRows];

// Draws a frame with the eye moved sideways by some 1/256 voxel.
static int32_t draw(const thimble_scene_t* scene, int32_t sideways_q8) {
  thimble_view_t view;
  thimble_camera_t camera;
  thimble_shading_t shading;
  thimble_band_t band = {pixels, sizeof pixels, 0, THIMBLE_FORMAT_GRAY4, 0, kDisplayBandRows};
  int32_t status = thimble_scene_view(scene, &view);
  if (status == THIMBLE_OK && sideways_q8 != 0) {
    view.eye_q8.x += sideways_q8;
    view.forward = (thimble_vec3_t){0, 0, 0};  // look at the target from there
  }
  if (status == THIMBLE_OK)
    status = thimble_scene_camera(scene, &view, kDisplayWidth, kDisplayHeight, &camera);
  if (status == THIMBLE_OK) status = thimble_scene_shading(scene, &shading);
  for (; band.first_row < kDisplayHeight && status == THIMBLE_OK; band.first_row += kDisplayBandRows) {
    status = thimble_scene_render(scene, &camera, &shading, &band);
    if (status == THIMBLE_OK) display_send(band.first_row, band.rows, pixels, sizeof pixels);
  }
  return status;
}

int main(void) {
  thimble_scene_t scene;
  int32_t status = thimble_scene_open(&scene, thimble_scene, sizeof thimble_scene);
  for (uint32_t frame = 0; status == THIMBLE_OK && display_wait(frame); ++frame) {
    status = draw(&scene, (int32_t)(frame % 256) * 32);
  }
  return (int)status;  // 0, or a number for thimble_status_text
}
