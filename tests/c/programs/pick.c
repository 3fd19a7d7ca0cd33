/* Asks what is under a pixel, and says in words what went wrong. */
#include "thimble/thimble_c.h"

const char* program(const void* bytes, size_t size, thimble_hit_t* hit);

const char* program(const void* bytes, size_t size, thimble_hit_t* hit) {
  thimble_scene_t scene;
  thimble_camera_t camera;
  int32_t status = thimble_scene_open(&scene, bytes, size);
  if (status == THIMBLE_OK) {
    status = thimble_scene_camera(&scene, NULL, 128, 64, &camera);
  }
  if (status == THIMBLE_OK) {
    status = thimble_scene_pick(&scene, &camera, 64, 32, hit);
  }
  return thimble_status_text(status);
}
