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

/// Whether boxes hide one another so much that blocks pay: they are drawn front to back, and left out when all their
/// pixels are covered. Takes about a hundredth of the frame's time: it looks at 65 cells at most.
bool blocks_pay(const VoxelLists& lists, const WideFrame& frame);

}  // namespace thimble::wide
