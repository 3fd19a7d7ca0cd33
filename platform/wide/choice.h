/// @file choice.h
/// Guesses which order of drawing boxes takes less time, from a few cells of the tree.
#ifndef THIMBLE_PLATFORM_WIDE_CHOICE_H
#define THIMBLE_PLATFORM_WIDE_CHOICE_H

#include "wide/frame.h"
#include "wide/voxel_lists.h"

namespace thimble::wide {

/// Blocks whose single voxels take so few pixels a side are looked up in tables (kernels/pick-inl.h).
inline constexpr float kTableVoxelPx = 1.8F;

/// But not blocks in which perspective moves a voxel by more pixels than this from where an affine map has
/// it.
inline constexpr float kMostBentPx = 0.15F;

/// What is to be expected of a frame.
struct Outlook {
  static constexpr int kParts = 32;
  /// Whether boxes hide one another so much that blocks pay: these are drawn front to back, and left out
  /// when all their pixels are covered.
  bool blocks_pay = false;
  /// How the work is spread, about, over equal parts of the tile's rows, from the first down: in the order
  /// of the list, and with blocks.
  float flat[kParts] = {};
  float blocks[kParts] = {};
  /// The work in the order that pays, in tests of a pixel, without painting; and how many pixels are painted.
  float work = 0;
  float painted_px = 0;
};

/// Takes about a hundredth of the frame's time: it looks at 65 cells at most. `by_rows`: whether to find
/// the work of the parts.
Outlook outlook_of(const VoxelLists& lists, const WideFrame& frame, bool by_rows);

/// Whether a list of boxes is drawn faster than that of the surface, of which these are the outlooks.
bool boxes_pay(const Outlook& boxes, const Outlook& surface, bool perspective);

}  // namespace thimble::wide

#endif
