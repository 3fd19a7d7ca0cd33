/// The boxes of a compact tree as flat lists in Morton order, which an object-order renderer reads.
///
/// An entry is one solid box, packed into 32 bits:
///
///     bits  0..9    x     lowest corner, in voxels, within the aligned cube of 1024 a side that holds it
///     bits 10..19   y
///     bits 20..29   z
///     bits 30..31   side  0, 1, 2: 2^side voxels; 3: 2^(3 + the low three bits of x) voxels, corner 8-aligned
///
/// Lists of single voxels alone are drawn faster than blocks of several sizes. So where a tree holds solid blocks, or
/// voxels so crowded that many are hidden, only its surface is listed: voxels with six solid neighbours are left out.
/// A ray enters such a voxel either because it begins there, or through an edge or corner, between two listed voxels
/// that it touches without hitting them; hidden_voxels.h says how these pixels are found. Where little would be left out (a
/// quarter at most) all voxels are listed. Trees that were coarsened are listed as their boxes: a merged block stays one.
///
/// Lists of single voxels of one material, in worlds of several cubes where voxels are dense, hold short entries of 16
/// bits, which take half the memory and are looked at twice as many at a time:
///
///     bits  0..4    x     within the aligned cube of 32 a side
///     bits  5..9    y
///     bits 10..14   z
///
/// A node covers a run of entries. The lists keep the nodes of `block_level` and above with their runs, so that whole
/// blocks can be skipped, or drawn front to back. A list of boxes has the tree's nodes; a list of a surface has nodes
/// of its own, also within solid blocks, and only such as have entries.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::wide {

/// Worlds above this level are several cubes of entries.
inline constexpr int kCubeLevel = 10;
/// The side of the cube within which short entries count.
inline constexpr int kShortLevel = 5;

/// So many zeros follow the entries, so that whole vectors can be read up to the end.
inline constexpr uint32_t kEntriesAhead = 64;

/// A surface has fewer entries than this, since the numbers after them stand for materials 0 .. 255.
inline constexpr uint64_t kMostSurface = (uint64_t{1} << 28) - 256;

/// A node of the lists at block level or above.
struct BlockNode {
  uint32_t first_entry;
  uint32_t entries;
  uint32_t first_child;  ///< number of its first child
  /// In lists with blocks: the sum over the node's entries of the area of a face, in square voxels, modulo 2^32. In
  /// other lists: the mask of its children; and from bit 8 on a bit for each of the eight ways in which rays run (bit
  /// 8 + way, where bit a of `way` means downwards along axis a), which says whether rays that run so may see any of
  /// its voxels. They see none that has solid neighbours on all three sides that face the eye (hidden_voxels.h).
  uint32_t area_or_mask;
};

/// Which lists are made.
enum class ListKind : uint8_t {
  kFastest,  ///< the lists that are drawn fastest
  kBoxes,    ///< only the tree's boxes, cut into voxels where that adds at most an eighth
};

/// The lists of one tree, in bytes that the caller gave: 4 bytes a box (2 where entries are short), 1 more with several materials, 1 more with
/// merged blocks, and 16 bytes a node of block_level and above. Of these nodes there is at most one for 16 boxes, or
/// 4096, or one for 4 boxes up to 65536.
class VoxelLists {
 public:
  /// Makes the lists; takes `bytes(tree, kind)` from the arena. Goes over the masks once and over the boxes once;
  /// over a surface twice. Errors: kOutOfMemory, with nothing taken, when they do not fit; kDamaged for a tree that
  /// does not validate.
  static Status make(const CompactTree& tree, Arena* arena, VoxelLists* lists,
                     ListKind kind = ListKind::kFastest);
  /// The most bytes that `make` takes. Reads all masks, and walks the surface once.
  static size_t bytes(const CompactTree& tree, ListKind kind = ListKind::kFastest);

  const CompactTree& tree() const { return tree_; }
  /// How many boxes there are.
  size_t size() const { return entries_.size + short_entries_.size; }
  /// One of these is empty.
  Span<const uint32_t> entries() const { return entries_; }
  Span<const uint16_t> short_entries() const { return short_entries_; }
  /// Materials of the entries; empty where the tree has one material. In a list of a surface all 256 materials follow,
  /// in order.
  Span<const uint8_t> materials() const { return materials_; }
  /// 1 for entries that coarsening made: a hit on such an entry is a hit on the block, not on a voxel of it. Empty
  /// where the tree has no such block.
  Span<const uint8_t> merged() const { return merged_; }
  Span<const BlockNode> nodes() const { return nodes_; }
  int block_level() const { return block_level_; }
  /// Whether any entry is larger than one voxel.
  bool has_blocks() const { return has_blocks_; }
  /// Whether voxels with six solid neighbours are left out. A hidden voxel that a ray hits all the same is numbered
  /// size() + its material.
  bool is_surface() const { return is_surface_; }

  /// The mask of a node's children that have entries; at the block level the children themselves are not kept.
  unsigned children(uint32_t node) const {
    return has_blocks_ ? tree_.mask(node) : nodes_[node].area_or_mask & 0xFFU;
  }
  /// The ways, out of eight, in which rays must run so that a voxel of the node may be the first that they hit
  /// (BlockNode).
  unsigned facing(const BlockNode& node) const {
    return has_blocks_ ? 0xFFU : node.area_or_mask >> 8 & 0xFFU;
  }
  uint32_t face_area(const BlockNode& node) const { return has_blocks_ ? node.area_or_mask : node.entries; }

 private:
  CompactTree tree_;
  Span<const uint32_t> entries_;
  Span<const uint16_t> short_entries_;
  Span<const uint8_t> materials_;
  Span<const uint8_t> merged_;
  Span<const BlockNode> nodes_;
  int block_level_ = 0;
  bool has_blocks_ = false;
  bool is_surface_ = false;
};

}  // namespace thimble::wide
