/// @file hidden.h
/// Finds what lists of surfaces leave out: voxels with six solid neighbours, which rays hit all the same.
///
/// Take the first voxel H that a ray hits, hidden. Either the ray begins in it; or it comes from a cell E that
/// is not solid. Were E beside H, H would not be hidden. So the ray passes planes of two or three axes at
/// once. Then some solid cell T, which differs from E in one or two of these axes, has a neighbour that is not
/// solid, so it is listed; and the ray touches T in that one point, without hitting it. (Of two axes: both
/// cells between E and H are beside H, so solid, and beside E. Of three: either one of the three cells beside
/// E is solid, and listed; or none is, and those beside H are listed.)
///
/// A touch is a tie: of the cross products that decide whether a ray hits a box (exact.h) one is just as large
/// as its bound, and none larger. Floats leave that to integers, always. So wherever integers find a tie, the
/// core is asked for that pixel. The pixels at which T is tested include it: their bounds hold for closed
/// boxes (frame.h). And where T is left out because its pixel is covered, what covers it is hit before H: in
/// the order of the octree, what a ray hits behind H comes after T.
///
/// For the same reasons a voxel may be left out of a picture whose three neighbours on the sides that face the
/// eye are solid: a ray that hits it first comes through an edge or corner, and T, which has a neighbour
/// towards the eye that is not solid, is not left out.
#ifndef THIMBLE_PLATFORM_WIDE_HIDDEN_H
#define THIMBLE_PLATFORM_WIDE_HIDDEN_H

#include <stdint.h>

#include "wide/kernels.h"

namespace thimble::wide {

/// The ways (BlockNode) in which rays from the eye, in that voxel, may run to a cube of the world. For rays
/// of a parallel camera the eye lies beyond all voxels.
inline unsigned ways_to(const int32_t (&eye_cell)[3], const uint32_t (&corner)[3], uint32_t side) {
  constexpr unsigned kUp[3] = {0x55, 0x33, 0x0F};
  unsigned ways = 0xFF;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t low = static_cast<int32_t>(corner[axis]);
    const int32_t high = low + static_cast<int32_t>(side);
    ways &= (eye_cell[axis] < high ? kUp[axis] : 0U) | (eye_cell[axis] >= low ? ~kUp[axis] : 0U);
  }
  return ways;
}

/// Writes what the core's ray hits at that pixel into the picture, if it hits anything; counts it.
void ask_core(const WideFrame& frame, const Depths& depths, int32_t x, int32_t y, Batch* batch);

/// The same for a ray that touches a listed voxel, of the batch's cube, with the key that it has in the
/// picture: unless something nearer is there already. `down`: the axes along which the ray runs downwards.
void ask_core_behind(const WideFrame& frame, const Depths& depths, int32_t x, int32_t y, uint32_t entry,
                     uint32_t key, uint32_t down, Batch* batch);

/// Where rays begin in solid voxels.
struct SolidStarts {
  struct Voxel {
    uint16_t at[3];
    uint8_t material;
  };
  /// Solid voxels that a perspective camera's eye lies in or touches.
  uint32_t count = 0;
  Voxel voxels[8];
  /// Whether all rays begin in these.
  bool are_all = false;
  /// Whether some rays of a parallel camera may begin in solid voxels.
  bool on_plane = false;
};

/// Of a frame over lists of a surface.
SolidStarts find_solid_starts(const CompactTree& tree, const WideFrame& frame);

/// Asks the core for the pixels of the rows y0 .. y1 - 1 whose rays begin in solid voxels.
void draw_plane_starts(const WideFrame& frame, const Depths& depths, int32_t y0, int32_t y1, Batch* batch);

}  // namespace thimble::wide

#endif
