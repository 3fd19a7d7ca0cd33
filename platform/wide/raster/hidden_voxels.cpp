#include "wide/raster/hidden_voxels.h"

#include <math.h>

#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/secondary_ray.h"
#include "wide/raster/exact.h"
#include "wide/raster/surface.h"

namespace thimble::wide {
namespace {

uint32_t down_of(const Ray& ray) {
  uint32_t down = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    down |= ray.direction[static_cast<int>(axis)] < 0 ? 1U << axis : 0U;
  }
  return down;
}

bool holds_something(const Depths& depths, int32_t x, int32_t y, size_t at) {
  return depths.gray_scale != nullptr ? depths.gray[at] != 0
                                      : (depths.covered[depths.word(x, y)] >> (x & 31) & 1U) != 0;
}

// The cell in which a ray spends its first length.
void find_start(const Ray& ray, int32_t (&cell)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    cell[axis] = (ray.origin[axis].raw - (ray.direction[axis] < 0 ? 1 : 0)) >> 8;
  }
}

}  // namespace

void ask_core(const WideFrame& frame, const Depths& depths, int32_t x, int32_t y, Batch* batch) {
  const Ray ray = frame.camera->ray(x, y);
  Hit hit;
  ++batch->counts.asked;
  if (closest_hit(*frame.hidden_in, ray, &hit) != Status::kOk || hit.kind != HitKind::kHit) {
    return;
  }
  const uint32_t down = down_of(ray);
  uint32_t corner[3];
  uint32_t within[3];
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t at = static_cast<uint32_t>(hit.voxel[axis]);
    within[axis] = at & 1023U;
    corner[axis] = at - within[axis];
  }
  const size_t at = depths.pixel(x, y);
  if (depths.gray_scale != nullptr) {
    const uint32_t entry = within[0] | within[1] << 10 | within[2] << 20;
    depths.nearest_sum[at] = static_cast<uint16_t>(mirrored_sum(entry, corner, down));
    depths.gray[at] = code_of(depths.gray_scale->code, hit, ray, *frame.camera, *depths.shading);
  } else {
    depths.nearest[at] = cube_value(corner, down) | uint64_t{mirrored_key(within, 0, down)} << kEntryBits |
                         (frame.first_hidden + hit.material);
  }
  if (depths.marks) {
    depths.covered[depths.word(x, y)] |= uint32_t{1} << (x & 31);
  }
}

void ask_core_behind(const WideFrame& frame, const Depths& depths, int32_t x, int32_t y, uint32_t entry,
                     uint32_t key, uint32_t down, Batch* batch) {
  const size_t at = depths.pixel(x, y);
  if (holds_something(depths, x, y, at)) {
    const uint64_t value = batch->cube_value[down] | uint64_t{key} << kEntryBits;
    const bool is_nearer = depths.gray_scale != nullptr
                               ? depths.nearest_sum[at] <= mirrored_sum(entry, batch->corner, down)
                               : depths.nearest[at] < value;
    if (is_nearer) {
      return;
    }
  }
  ask_core(frame, depths, x, y, batch);
}

SolidStarts find_solid_starts(const CompactTree& tree, const WideFrame& frame) {
  SolidStarts starts;
  const Camera& camera = *frame.camera;
  const VoxelBox& bounds = tree.bounds();
  if (!frame.perspective) {
    // All rays begin close to a plane: does it cut the box around what is solid?
    double first = 0;  // the first of the box's corners along the direction
    double size = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double step = camera.direction()[axis];
      size += fabs(step);
      first += step * 256 * (step < 0 ? bounds.high[axis] : bounds.low[axis]);
    }
    double last = -HUGE_VAL;  // the last place at which rays begin
    const Rectangle& tile = frame.tile;
    for (int corner = 0; corner < 4; ++corner) {
      const Ray ray =
          camera.ray((corner & 1) != 0 ? tile.x1 - 1 : tile.x0, (corner & 2) != 0 ? tile.y1 - 1 : tile.y0);
      double along = 0;
      for (int axis = 0; axis < 3; ++axis) {
        along += static_cast<double>(ray.origin[axis].raw) * camera.direction()[axis];
      }
      last = fmax(last, along);
    }
    starts.on_plane = last + 2 * size >= first;
    return starts;
  }
  int cells = 0;
  for (unsigned octant = 0; octant < 8; ++octant) {
    Vec3i cell;
    bool is_new = true;  // along an axis on which the eye lies in no plane it touches only one cell
    for (unsigned axis = 0; axis < 3; ++axis) {
      const bool is_lower = (octant >> axis & 1U) != 0;
      is_new = is_new && (!is_lower || (frame.eye[axis] & 255) == 0);
      cell[static_cast<int>(axis)] = frame.eye_cell[axis] - (is_lower ? 1 : 0);
    }
    if (!is_new) {
      continue;
    }
    ++cells;
    SolidStarts::Voxel& voxel = starts.voxels[starts.count];
    if (material_at(tree, cell, &voxel.material)) {
      for (int axis = 0; axis < 3; ++axis) {
        voxel.at[axis] = static_cast<uint16_t>(cell[axis]);
      }
      ++starts.count;
    }
  }
  starts.are_all = cells == static_cast<int>(starts.count);
  return starts;
}

void draw_plane_starts(const WideFrame& frame, const Depths& depths, int32_t y0, int32_t y1, Batch* batch) {
  const CompactTree& tree = *frame.hidden_in;
  int32_t known[3] = {0, 0, 0};  // a cell, and what is known of the block around it
  int level = -1;
  bool is_solid = false;
  for (int32_t y = y0; y < y1; ++y) {
    for (int32_t x = frame.tile.x0; x < frame.tile.x1; ++x) {
      int32_t cell[3];
      find_start(frame.camera->ray(x, y), cell);
      const int32_t apart = (cell[0] ^ known[0]) | (cell[1] ^ known[1]) | (cell[2] ^ known[2]);
      if (level < 0 || apart >> level != 0) {
        is_solid = solid_at(tree, cell, &level);
        for (int axis = 0; axis < 3; ++axis) {
          known[axis] = cell[axis];
        }
      }
      if (is_solid) {
        ask_core(frame, depths, x, y, batch);
      }
    }
  }
}

}  // namespace thimble::wide
