// Thimble in somebody else's program: a ball is built voxel by voxel, made compact, and drawn in bands of one
// row, all in 8 KiB that this file owns. Every failure is a status.
#include <cstdint>
#include <cstdio>

#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "thimble/tree/octree.h"

using namespace thimble;  // NOLINT

int main() {
  static std::uint8_t memory[8192];
  Arena arena{Bytes(memory)};
  Octree octree;
  Status status =
      Octree::make(5, arena.take(Octree::octree_bytes(700)), &octree);  // a world of 32 voxels a side
  for (std::int32_t i = 0; i < 32 * 32 * 32 && status == Status::kOk; ++i) {
    const Vec3i voxel{i & 31, (i >> 5) & 31, i >> 10};
    const Vec3i from{voxel.x - 16, voxel.y - 16, voxel.z - 16};
    if (from.x * from.x + from.y * from.y + from.z * from.z < 100) {
      status = octree.insert(voxel);
    }
  }
  std::size_t size = 0;
  const Bytes bytes = arena.take(compact_bytes(compact_shape(octree)));
  CompactTree tree;
  if (status == Status::kOk) {
    status = CompactTree::make(octree, bytes, nullptr, &size);
  }
  if (status == Status::kOk) {
    status = CompactTree::open(bytes, &tree);
  }

  PerspectiveView view;
  view.eye = {Q8::saturate(0), Q8::saturate(-24), Q8::saturate(36)};
  view.forward = look_at(view.eye, {Q8::saturate(16), Q8::saturate(16), Q8::saturate(16)});
  view.fov_degrees = Q16::saturate(32);
  view.width_px = 64;
  view.height_px = 32;
  Camera camera;
  if (status == Status::kOk) {
    status = camera.set(view, tree.level());
  }
  Shading shading;
  shading.mode = ShadeMode::kColor;
  Band band{arena.take(64), PixelFormat::kGray8, 0, 0, 1};
  for (; band.first_row < 32 && status == Status::kOk; ++band.first_row) {
    status = render_band(tree, camera, shading, band);
    for (const std::uint8_t gray : band.pixels) {
      std::putchar(" .:-=+*#%@"[gray * 9 / 255]);
    }
    std::putchar('\n');
  }
  std::printf("%s: %zu of %zu bytes used, the tree has %zu\n", status_text(status), arena.used_bytes(),
              arena.capacity_bytes(), size);
  return status == Status::kOk ? 0 : 1;
}
