#include "wide/raster/exact.h"

#include "thimble/picture/camera.h"
#include "thimble/tree/compact_tree.h"
#include "wide/raster/kernels.h"

namespace thimble::wide {

uint32_t mirrored_key(const uint32_t (&corner)[3], int32_t level, uint32_t down) {
  uint32_t place[3];
  for (unsigned axis = 0; axis < 3; ++axis) {
    const uint32_t flip = (down >> axis & 1U) != 0 ? 1023U : 0U;
    place[axis] = (corner[axis] ^ flip) >> level << level;
  }
  return static_cast<uint32_t>(morton_code(place[0], place[1], place[2]));
}

uint64_t cube_value(const uint32_t (&corner)[3], uint32_t down) {
  uint64_t key = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const uint32_t cube = corner[axis] >> 10 ^ ((down >> axis & 1U) != 0 ? 3U : 0U);
    key |= uint64_t{cube & 1U} << (30 + axis) | uint64_t{cube >> 1 & 1U} << (33 + axis);
  }
  return key << kEntryBits;
}

// Let c be the box's centre less the origin, and d the direction. The ray passes the lower plane of axis a before the
// upper plane of axis b, and that of b before that of a, exactly when |c_a d_b - c_b d_a| < half (|d_a| + |d_b|). Where
// both sides are equal, the ray touches an edge. Along an axis with d = 0 the ray must lie between the planes, or in
// the lower one. Centres are below 2^25 in 1/512 voxel, directions have 20 bits.
Meeting meet_exactly(const WideFrame& frame, int32_t x, int32_t y, uint32_t entry, const uint32_t (&cube)[3],
                     uint32_t* key, uint32_t* down) {
  const Ray ray = frame.camera->ray(x, y);
  const int32_t level = level_of(entry);
  const uint32_t corner[3] = {x_of(entry), entry >> 10 & 1023U, entry >> 20 & 1023U};
  const int64_t half = int64_t{256} << level;
  int64_t center[3];
  int64_t direction[3];
  int64_t size[3];
  *down = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const int i = static_cast<int>(axis);
    direction[axis] = ray.direction[i];
    size[axis] = direction[axis] < 0 ? -direction[axis] : direction[axis];
    center[axis] = int64_t{512} * (cube[axis] + corner[axis]) + half - int64_t{2} * ray.origin[i].raw;
    *down |= direction[axis] < 0 ? 1U << axis : 0U;
    if (size[axis] == 0) {
      if (center[axis] > half || center[axis] <= -half) {
        return Meeting::kMiss;
      }
      continue;
    }
    // The farther plane must lie ahead.
    if ((direction[axis] < 0 ? -center[axis] : center[axis]) <= -half) {
      return Meeting::kMiss;
    }
  }
  Meeting meeting = Meeting::kHit;
  for (unsigned a = 0; a < 3; ++a) {
    const unsigned b = a == 2 ? 0 : a + 1;
    if (size[a] == 0 || size[b] == 0) {
      continue;
    }
    const int64_t cross = center[a] * direction[b] - center[b] * direction[a];
    const int64_t beyond = (cross < 0 ? -cross : cross) - half * (size[a] + size[b]);
    if (beyond > 0) {
      return Meeting::kMiss;
    }
    meeting = beyond == 0 ? Meeting::kTouch : meeting;
  }
  *key = mirrored_key(corner, level, *down);
  return meeting;
}

}  // namespace thimble::wide
