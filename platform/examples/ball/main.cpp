// platform/examples/ball/main.cpp
// A ball in 8 KiB: built voxel by voxel, made compact, and drawn in bands of one row.
#include "thimble/thimble.h"
using namespace thimble;

extern "C" int putchar(int character);  // a terminal is the display here; yours takes the band's bytes

int main() {
  static uint8_t memory[8192];  // the core asks for no other
  Arena arena{Bytes(memory)};
  Octree octree;
  Status status = Octree::make(5, 700, arena, &octree);  // 32 voxels a side, a pool of 700 nodes
  for (int32_t i = 0; i < 32 * 32 * 32 && status == Status::kOk; ++i) {
    const int32_t x = i % 32 - 16, y = i / 32 % 32 - 16, z = i / 1024 - 16;
    if (x * x + y * y + z * z < 100) status = octree.insert({x + 16, y + 16, z + 16});
  }
  CompactTree tree;  // what is traced; it takes just the bytes that it needs
  if (status == Status::kOk) status = CompactTree::make(octree, arena, &tree);
  PerspectiveView view;
  view.eye = {Q8::saturate(0), Q8::saturate(-24), Q8::saturate(36)};
  view.forward = {16, 40, -20};
  view.fov_degrees = Q16::saturate(32);
  view.width_px = 32;
  view.height_px = 32;
  Camera camera;
  if (status == Status::kOk) status = camera.set(view, tree.level());
  Shading shading;
  shading.mode = ShadeMode::kColor;
  for (Band band{arena.take(32), PixelFormat::kGray8, 0, 0, 1}; band.first_row < 32; ++band.first_row) {
    if (status == Status::kOk) status = render_band(tree, camera, shading, band);
    for (const uint8_t gray : band.pixels) {
      putchar(" .:-=+*#%@"[gray * 9 / 255]);
      putchar(" .:-=+*#%@"[gray * 9 / 255]);  // characters are twice as high as wide
    }
    putchar('\n');
  }
  return static_cast<int>(status);  // 0, or a number to look up in thimble/base/status.h
}
