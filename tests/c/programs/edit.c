/* Builds a world, makes it compact, and draws a band of it. */
#include "thimble/thimble_c.h"

int32_t program(uint8_t* pool, size_t size, uint8_t* pixels);

int32_t program(uint8_t* pool, size_t size, uint8_t* pixels) {
  thimble_octree_t octree;
  thimble_tree_t tree;
  thimble_view_t view;
  thimble_camera_t camera;
  thimble_shading_t shading;
  const thimble_band_t band = {pixels, 512, 0, THIMBLE_FORMAT_GRAY4, 0, 8};
  int32_t status = thimble_octree_make(&octree, 5, pool, size / 2);
  if (status == THIMBLE_OK) {
    status = thimble_octree_insert(&octree, 3, 4, 5, 1);
  }
  if (status == THIMBLE_OK) {
    status = thimble_octree_erase(&octree, 3, 4, 6);
  }
  if (status == THIMBLE_OK) {
    status = thimble_tree_make(&tree, &octree, pool + size / 2, size - size / 2);
  }
  thimble_view_default(&view);
  view.eye_q8.y = -9000;
  thimble_shading_default(&shading);
  if (status == THIMBLE_OK) {
    status = thimble_camera_set(&camera, &view, 128, 64, 5);
  }
  return status == THIMBLE_OK ? thimble_tree_render(&tree, &camera, &shading, &band) : status;
}
