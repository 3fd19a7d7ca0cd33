/// Guesses from a few cells of the tree which order of drawing its boxes takes less time.
#pragma once

#include "wide/raster/frame.h"
#include "wide/raster/voxel_lists.h"

namespace thimble::wide {

/// Blocks whose voxels are at most so many pixels wide are drawn by tables (kernels/pick-inl.h).
inline constexpr float kTableVoxelPx = 1.8F;

/// A block is not drawn by a table where perspective moves a voxel by more pixels than this from where an affine
/// map puts it.
inline constexpr float kMostBentPx = 0.15F;

/// What drawing a frame is expected to take.
struct CostEstimate {
  /// Whether boxes hide one another so much that blocks pay. Blocks are drawn front to back, and left out when all
  /// their pixels are covered.
  bool blocks_pay = false;
  /// The work in the order that pays, in tests of a pixel and without painting; and how many pixels get painted.
  float work = 0;
  float painted_px = 0;
};

/// Takes about a hundredth of the frame's time: it looks at 65 cells at most.
CostEstimate estimate_cost(const VoxelLists& lists, const WideFrame& frame);

/// Whether a list of boxes, with its cost, is expected to be drawn faster than that of the surface, with its own.
bool boxes_pay(const CostEstimate& boxes, const CostEstimate& surface, bool perspective);

}  // namespace thimble::wide
