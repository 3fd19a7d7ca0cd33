/// Finds the hits on what lists of surfaces leave out: voxels with six solid neighbours. Rays can hit these all the
/// same.
///
/// Let the first voxel that a ray hits, H, be hidden. Either the ray begins in H, or it comes from a cell E that is not
/// solid. E is not beside H, else H would not be hidden; so the ray crosses planes of two or three axes at once to come
/// from E to H. Then there is a solid cell T which differs from E in one or two of these axes and has a neighbour that
/// is not solid. T is listed, and the ray touches T in that one point without hitting it. (With two axes, both cells
/// between E and H are beside H, so solid, and beside E. With three, either one of the three cells beside E is solid,
/// and listed; or none is, and the three beside H are listed.)
///
/// A touch is a tie: of the cross products that decide whether a ray hits a box (exact.h) one equals its bound, and
/// none is larger. Floats always leave a tie to integers, and wherever integers find one, the core traces that
/// pixel. T is tested at that pixel, since its bounds hold for closed boxes (frame.h). Where T is not tested because
/// the pixel is covered, what covers the pixel is hit before H: in the order of the octree, what a ray hits behind H
/// comes after T.
///
/// For the same reasons a picture may leave out a voxel whose three neighbours on the sides that face the eye are
/// solid: a ray that hits that voxel first comes through an edge or a corner, and T, which has a neighbour towards
/// the eye that is not solid, is not left out.
#pragma once

#include <stdint.h>

#include "wide/raster/kernels.h"

namespace thimble::wide {

/// The ways (BlockNode) in which rays from the eye, which is in `eye_cell` (frame.h), may run to a cube of the world.
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

/// Traces the pixel's ray by the core, and writes what it hits, if anything, into the picture. Counts the pixel.
void ask_core(const WideFrame& frame, const Depths& depths, int32_t x, int32_t y, Batch* batch);

/// Does the same for a ray that touches a listed voxel of the batch's cube, unless the picture already holds something
/// nearer than the voxel's `key`. `down` holds the axes along which the ray runs downwards.
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
  /// Whether all rays begin in these voxels.
  bool are_all = false;
  /// Whether some rays of a parallel camera may begin in solid voxels.
  bool on_plane = false;
};

/// Finds these for a frame that is drawn from lists of a surface.
SolidStarts find_solid_starts(const CompactTree& tree, const WideFrame& frame);

/// Asks the core for the pixels of the rows y0 .. y1 - 1 whose rays begin in solid voxels.
void draw_plane_starts(const WideFrame& frame, const Depths& depths, int32_t y0, int32_t y1, Batch* batch);

}  // namespace thimble::wide
