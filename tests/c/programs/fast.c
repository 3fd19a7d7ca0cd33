/* The same by the scene's brick map. */
#include "thimble/thimble_c.h"

int32_t program(const void* bytes, size_t size, uint8_t* pixels);

int32_t program(const void* bytes, size_t size, uint8_t* pixels) {
  thimble_scene_t scene;
  thimble_camera_t camera;
  thimble_bricks_t bricks;
  thimble_shading_t shading;
  const thimble_band_t band = {pixels, 512, 0, THIMBLE_FORMAT_GRAY4, 0, 8};
  int32_t status = thimble_scene_open(&scene, bytes, size);
  if (status == THIMBLE_OK) {
    status = thimble_scene_bricks(&scene, &bricks);
  }
  if (status == THIMBLE_OK) {
    status = thimble_scene_camera(&scene, NULL, 128, 64, &camera);
  }
  if (status == THIMBLE_OK) {
    status = thimble_scene_shading(&scene, &shading);
  }
  return status == THIMBLE_OK ? thimble_scene_render_fast(&scene, &bricks, &camera, &shading, &band) : status;
}
