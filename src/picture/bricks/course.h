// What the rays of one frame share, and what those share whose directions have the same signs and fastest axis.
// Internal to src/.
#pragma once

#include "layout.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::bricks {
namespace {

struct Inks;

// What a ray returns: the ink of what it hits, the hit, whether there is a hit; or, for rays from a face, the hit
// if it is near, or the hit that a mirror shows.
enum class Aim : uint8_t { kInk, kSight, kShadow, kNear, kMirror };

// What all pixels of a band share.
struct BrickFrame {
  const CompactTree& tree;
  const BrickMap& map;
  const Camera& camera;
  const Shading& shading;
  PixelFormat format;
  bool halfwords;  // pixels are halfwords, and aligned as such
  uint32_t background;
  Vec3i side;    // of the box, in bricks
  Vec3i stride;  // of the directory, in bytes
  Vec3i eye;     // from the box's lowest corner, in 1/256 voxel
  // Added to the first direction of a tile (or quad), these give the least and the greatest of all of it: see `Fan`.
  Vec3i tile_low;
  Vec3i tile_high;
  Vec3i quad_low;
  Vec3i quad_high;
};

// What all rays share whose directions have the same signs and the same fastest axis. Where they start changes from
// tile to tile.
struct Course {
  static constexpr Aim kAim = Aim::kInk;
  static constexpr bool kDeep = false;
  const BrickFrame* frame;
  Inks* inks;
  int32_t origin[3];  // the eye, mirrored; on a and b kOutsideQ8 more
  const uint8_t* directory;
  const uint8_t* bricks;
  int32_t stride[3];  // of the directory, in bytes
  int32_t
      next_brick[3];  // equals `stride`; a second copy, so that the compiler does not hold it in a register
  uint32_t flip[3];   // 3 where mirrored
  uint32_t face[3];
  int32_t base;        // offset of slab 0 in the directory, in bytes
  uint32_t base_left;  // counts of bricks in slab 0
  int c;               // the fastest axis
  unsigned mirrored;   // bit a: axis a is mirrored
  bool exact_ties;     // a voxel entered through an edge is itself the hit: it is no part of a merged block
  // Where the rays start.
  uint32_t waiting;  // kWaiting where they may start outside of the box
  uint32_t plane;    // distance from the origin to the first plane of c, in 1/256 voxel; not below 0
  uint32_t behind;   // distance back to the plane of c before the origin, where that lies between two planes
  uint32_t first;    // the first voxel on c, shifted to its place
  int32_t start;     // offset in the directory, to which that of a and b is added
  uint32_t left;     // counts of bricks, to which those of a and b are added
  // The camera's affine function, mirrored.
  Camera::Vec3Q32 step_x;
  Camera::Vec3Q32 step_y;
  // Read seldom, so last.
  int axis[3];          // a, b and c
  uint32_t most_cells;  // so many cells times a direction times 256 stay below 2^31
  bool wide;            // products of directions and rests take more than 31 bits
#ifdef THIMBLE_FAST_RAM
  uint32_t last[3];     // the last voxel of a brick, shifted to its place
  int32_t one_step[3];  // what a step adds to a voxel's place
  bool far;             // the rays start far from anything: their beam became too wide to be followed
#endif

  void set_signs() {}  // where the signs are data (SightCourse), sets these
};

// The same in worlds of level 9 and 10.
struct DeepCourse : Course {
  [[maybe_unused]] static constexpr bool kDeep = true;
  uint32_t empty_page;  // what the directory says of pages that are empty
};

// Origins lie so far outside on a and b.
[[gnu::always_inline]] inline int32_t outside_q8(const Course& course, int axis) {
  return axis == course.c ? 0 : kOutsideQ8;
}

// Sets all members but those that say where the rays start, for rays that go up on all axes. (Tiles side by side seldom
// differ in c, so that this is not in fast RAM.)
template <bool kDeep = false>
[[gnu::noinline]] void set_course(Course& course, int c) {
  const BrickFrame& frame = *course.frame;
  const VoxelBox& box = frame.map.box();
  course.c = c;
  course.axis[0] = c == 0 ? 1 : 0;
  course.axis[1] = c == 2 ? 1 : 2;
  course.axis[2] = c;
  course.mirrored = 0;
  course.base = 0;
  course.base_left = 0;
  int32_t stride = 2;
  const Camera::Affine& affine = frame.camera.affine();
  for (int axis = 0; axis < 3; ++axis) {
    if constexpr (kDeep) {
      stride = deep_place::kStride[axis];
    }
    const int32_t side = frame.side[axis];
    course.origin[axis] =
        frame.camera.eye()[axis].raw - box.low[axis] * (4 * Q8::kOne) + outside_q8(course, axis);
    course.stride[axis] = stride;
    course.next_brick[axis] = stride;
    const int32_t from = -outside_q8(course, axis) / (4 * Q8::kOne);
    course.base += stride * from;
    course.base_left += static_cast<uint32_t>(512 - side + from) << 10 * axis;
    course.flip[axis] = 0;
#ifdef THIMBLE_FAST_RAM
    course.last[axis] = 3U << kPlaceShift[axis];
    course.one_step[axis] = 1 << kPlaceShift[axis];
#endif
    course.face[axis] = static_cast<uint32_t>(2 * axis);
    course.step_x[axis] = affine.step_x[axis];
    course.step_y[axis] = affine.step_y[axis];
    stride *= side;
  }
}

// Mirrors an axis of a course, or takes that back.
[[THIMBLE_HOT]] void flip_axis(Course& course, int axis) {
  const int32_t side = course.frame->side[axis];
  const int32_t outside = outside_q8(course, axis);
  course.mirrored ^= 1U << axis;
  course.base += (side - 1 + outside / (2 * Q8::kOne)) * course.stride[axis];
  course.origin[axis] = side * (4 * Q8::kOne) + 2 * outside - course.origin[axis];
  course.stride[axis] = -course.stride[axis];
  course.next_brick[axis] = course.stride[axis];
  course.flip[axis] ^= 3U;
#ifdef THIMBLE_FAST_RAM
  course.last[axis] ^= 3U << kPlaceShift[axis];
  course.one_step[axis] = -course.one_step[axis];
#endif
  course.face[axis] ^= 1U;
  course.step_x[axis] = -course.step_x[axis];
  course.step_y[axis] = -course.step_y[axis];
}

// Lets the rays start in slab `slab` of voxels along c.
[[THIMBLE_HOT]] void set_start(Course& course, int32_t slab) {
  const int32_t distance = slab * Q8::kOne - course.origin[course.c];
  course.plane = distance > 0 ? static_cast<uint32_t>(distance) : 0;
  course.behind = distance > 0 ? 0 : static_cast<uint32_t>(-distance);
  course.first = ((static_cast<uint32_t>(slab) & 3U) ^ course.flip[course.c]) << kPlaceShift[course.c];
  course.start = course.base + course.stride[course.c] * (slab >> 2);
  course.left = (course.base_left + (static_cast<uint32_t>(slab >> 2) << 10 * course.c)) | course.waiting |
                (distance <= 0 ? kInside : 0);
}

}  // namespace
}  // namespace thimble::bricks
