/// @file choice.h
/// Which order of drawing boxes takes less time, from a few cells of the tree.
#ifndef THIMBLE_PLATFORM_HOST_WIDE_CHOICE_H
#define THIMBLE_PLATFORM_HOST_WIDE_CHOICE_H

#include "wide/frame.h"
#include "wide/voxel_lists.h"

namespace thimble::wide {

/// Blocks of single voxels of so few pixels are looked up in tables (kernels.cpp).
inline constexpr float kTableVoxelPx = 1.8F;

/// But not where perspective moves what is in them by more pixels than that from where an affine map has it.
inline constexpr float kMostBentPx = 0.15F;

/// What is to be expected of a frame.
struct Outlook {
  static constexpr int kParts = 32;
  /// Whether boxes hide one another enough for blocks to pay, which are drawn front to back and left out when
  /// all their pixels are covered.
  bool blocks_pay = false;
  /// How the work is spread over so many equal parts of the tile's rows, about, from the first down: with
  /// the list as it stands, and with blocks.
  float flat[kParts] = {};
  float blocks[kParts] = {};
};

/// Takes about a hundredth of the frame's time: it looks at 65 cells at most. `by_rows`: whether the work of
/// the parts is asked for.
Outlook outlook_of(const VoxelLists& lists, const Frame& frame, bool by_rows);

}  // namespace thimble::wide

#endif
