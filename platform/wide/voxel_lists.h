/// @file voxel_lists.h
/// The boxes of a compact tree as flat lists in Morton order: what an object-order renderer reads.
///
/// An entry is one solid box, packed into 32 bits:
///
///     bits  0..9    x     lowest corner, in voxels, within the aligned cube of 1024 a side that holds it
///     bits 10..19   y
///     bits 20..29   z
///     bits 30..31   side  0, 1, 2: 2^side voxels; 3: 2^(3 + the low three bits of x) voxels, corner
///     8-aligned
///
/// Where a tree has so few solid blocks that splitting them into voxels adds at most an eighth to its
/// boxes, they are given as single voxels, since lists of nothing else are drawn faster. Blocks that
/// coarsening made stay blocks.
///
/// Every node of the tree covers a run of entries. The lists keep the nodes of `block_level` and above with
/// their runs, so that whole blocks can be skipped, or drawn front to back.
#ifndef THIMBLE_PLATFORM_WIDE_VOXEL_LISTS_H
#define THIMBLE_PLATFORM_WIDE_VOXEL_LISTS_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::wide {

/// Worlds above this level are several cubes of entries.
inline constexpr int kCubeLevel = 10;

/// So many zeros stand behind the entries, so that vectors can be read to the end.
inline constexpr uint32_t kEntriesAhead = 64;

/// A node of the tree at block level or above.
struct BlockNode {
  uint32_t first_entry;
  uint32_t entries;
  uint32_t first_child;  ///< number of its first child; the mask is the tree's
  uint32_t face_area;    ///< the sum over its entries of the area of a face, in square voxels, modulo 2^32
};

/// The lists of one tree, in bytes that the caller gave. 4 bytes a box, 1 more with many materials, 1 more
/// with merged blocks, and 16 bytes a node of block_level and above, of which there are at most one in 16
/// boxes, or 4096, or one in 4 boxes up to 65536.
class VoxelLists {
 public:
  /// Makes the lists; takes `bytes(tree)` from the arena. One pass over the masks and one over the boxes.
  /// kOutOfMemory, with nothing taken, when they do not fit; kDamaged for a tree that does not validate.
  static Status make(const CompactTree& tree, Arena* arena, VoxelLists* lists);
  /// What `make` takes at most. Reads all masks.
  static size_t bytes(const CompactTree& tree);

  const CompactTree& tree() const { return tree_; }
  Span<const uint32_t> entries() const { return entries_; }
  /// Materials of the entries; empty where the tree has one material.
  Span<const uint8_t> materials() const { return materials_; }
  /// 1 for entries that coarsening made: a hit on one is a hit on the block, not on a voxel of it. Empty
  /// where the tree has none.
  Span<const uint8_t> merged() const { return merged_; }
  Span<const BlockNode> nodes() const { return nodes_; }
  int block_level() const { return block_level_; }
  /// The sum over all entries of the area of a face, in square voxels.
  uint64_t face_area() const { return face_area_; }
  /// Whether any entry is more than one voxel.
  bool has_blocks() const { return has_blocks_; }

 private:
  CompactTree tree_;
  Span<const uint32_t> entries_;
  Span<const uint8_t> materials_;
  Span<const uint8_t> merged_;
  Span<const BlockNode> nodes_;
  uint64_t face_area_ = 0;
  int block_level_ = 0;
  bool has_blocks_ = false;
};

}  // namespace thimble::wide

#endif
