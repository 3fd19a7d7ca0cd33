/// @file choice.h
/// Which order of drawing boxes takes less time, from a few cells of the tree.
#ifndef THIMBLE_PLATFORM_HOST_WIDE_CHOICE_H
#define THIMBLE_PLATFORM_HOST_WIDE_CHOICE_H

#include "host/wide/frame.h"
#include "host/wide/voxel_lists.h"

namespace thimble::wide {

/// Blocks of single voxels of so few pixels are looked up in tables (kernels.cpp).
inline constexpr float kTableVoxelPx = 2.0F;

/// Whether boxes hide one another enough for blocks to pay, which are drawn front to back and left out when
/// all their pixels are covered. Takes about a hundredth of the frame's time: it looks at 65 cells at most.
bool blocks_pay(const VoxelLists& lists, const Frame& frame);

}  // namespace thimble::wide

#endif
