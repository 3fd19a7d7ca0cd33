/* What binding.py does, in C: the CRC-32 of a scene's picture and what is under its middle. */
#include <inttypes.h>
#include <stdio.h>

#include "scene.h"
#include "thimble/thimble_c.h"

int main(void) {
  static uint8_t pixels[128 * 64 / 2];
  thimble_scene_t scene;
  thimble_camera_t camera;
  thimble_shading_t shading;
  thimble_hit_t hit;
  const thimble_band_t band = {pixels, sizeof pixels, 0, THIMBLE_FORMAT_GRAY4, 0, 64};
  uint32_t crc = 0xFFFFFFFFU;
  if (thimble_scene_open(&scene, thimble_scene, sizeof thimble_scene) != THIMBLE_OK ||
      thimble_scene_camera(&scene, NULL, 128, 64, &camera) != THIMBLE_OK ||
      thimble_scene_shading(&scene, &shading) != THIMBLE_OK ||
      thimble_scene_render(&scene, &camera, &shading, &band) != THIMBLE_OK ||
      thimble_scene_pick(&scene, &camera, 64, 32, &hit) != THIMBLE_OK) {
    return 1;
  }
  for (size_t i = 0; i < sizeof pixels; ++i) {
    crc ^= pixels[i];
    for (int bit = 0; bit < 8; ++bit) {
      crc = crc >> 1 ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
    }
  }
  printf("%08" PRIx32 "\n%" PRId32 " %" PRId32 " %" PRId32 " %" PRId32 " %" PRId64 "\n", ~crc, hit.kind,
         hit.voxel.x, hit.voxel.y, hit.voxel.z, hit.t_q32);
  return 0;
}
