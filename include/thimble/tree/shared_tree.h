/// @file shared_tree.h
/// The read-only octree in which equal subtrees are stored once: a directed acyclic graph (DAG), traced as
/// the other structures are.
///
/// "Reusing similar data with pointers", in the paper's words. Where a compact tree (compact_tree.h) takes
/// one byte a node and no pointers, here a node is stored once however often it occurs, but must say where
/// its children are. So it wins where a scene repeats itself (models, solid bodies, walls) and loses where it
/// does not (points strewn at random): build both and compare.
///
/// It holds what the compact tree holds that it was made from, exactly: the same voxels, merged blocks and
/// materials, so every ray gets the same hit with the same count of visits. Geometry is shared; materials
/// cannot be without losing what tells two places apart, so they lie beside the graph, one byte a leaf (a
/// solid block or a voxel) in Morton order. In a scene of several materials each node above level 2 holds how
/// many leaves are below it, and the leaves passed on the way down to a hit give its material's place.
///
/// Sources: Kaempe, Sintorn, Assarsson, "High Resolution Sparse Voxel DAGs", ACM Transactions on Graphics 32
/// (4), 2013: merging from the leaves up. Dado, Kol, Bauszat, Thiery, Eisemann, "Geometry and Attribute
/// Compression for Voxel Scenes", Computer Graphics Forum 35 (2), 2016: attributes beside the graph, found by
/// counting leaves. src/FORMAT.md gives every byte.
///
/// What it does not do: share mirrored subtrees, compress materials, change.
#ifndef THIMBLE_TREE_SHARED_TREE_H
#define THIMBLE_TREE_SHARED_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "compact_tree.h"

namespace thimble {

/// Bytes before the list of levels.
inline constexpr size_t kSharedHeaderBytes = 64;
/// Bytes before the first node: the header and where each level from 2 up begins.
constexpr size_t shared_front_bytes(int level) {
  return kSharedHeaderBytes + 4 * static_cast<size_t>(level - 1);
}

/// Bytes that certainly hold the shared tree of any compact tree of `shape`; SIZE_MAX when size_t cannot say
/// it. Nothing may be shared: then each mask costs at most two bytes and a count of four, each child but the
/// voxels a link of four.
constexpr size_t shared_tree_bytes(const CompactShape& shape) {
  const uint64_t bytes =
      shared_front_bytes(shape.level) + uint64_t{10} * shape.nodes + 3 +
      (shape.many_materials ? (uint64_t{shape.solid_blocks} + shape.voxel_bits + 3) & ~uint64_t{3} : 0);
  return bytes <= SIZE_MAX ? static_cast<size_t>(bytes) : SIZE_MAX;
}

/// Bytes of a workspace, at any address, that certainly suffices to share any compact tree of so many nodes;
/// SIZE_MAX when size_t cannot say it. It is a hash table of all different nodes: an eighth is heads of
/// chains, the rest records of 12 bytes and 4 for each child. A tree that shares much does with much less:
/// `SharedBuild::work_bytes` says with how much, and anything larger does as well.
constexpr size_t shared_work_bytes(uint32_t compact_nodes) {
  // The way down takes 8 words a level. Of w words more, w / 8 + 1 are heads; the others must hold 3 words a
  // node and one a child, and every node but the root is a child.
  const uint64_t words = uint64_t{5} * compact_nodes + 8 * (kMaxLevel + 2) + 2;
  const uint64_t bytes = 4 * words + sizeof(uint32_t) - 1;
  return bytes <= SIZE_MAX ? static_cast<size_t>(bytes) : SIZE_MAX;
}

/// Bytes of workspace that `SharedTree::validate` takes for a tree of `size_bytes`: a bit for each.
constexpr size_t shared_check_bytes(size_t size_bytes) {
  return size_bytes / 8 + 1;
}

/// What building a shared tree took.
struct SharedBuild {
  size_t bytes = 0;       ///< of the tree
  size_t work_bytes = 0;  ///< the least workspace, 4-byte aligned, that would have done
};

/// A view of a shared tree's bytes, which outlive it. Copy it freely.
///
/// `open` checks the header; whatever the other bytes hold, tracing reads nothing outside them and ends
/// (src/LAWS.md, law 4): every link is compared with the bytes that hold nodes, and each step goes down one
/// level. Whether the picture is right is `validate`'s question.
class SharedTree {
 public:
  SharedTree() = default;

  /// Writes `tree` with equal subtrees shared to the front of `out` and opens it as `shared` (null: only the
  /// bytes are wanted); `build` (may be null) gets sizes, `bytes` also when only `out` is too small. `work`
  /// is the hash table, scratch: its bytes change whatever happens, and what is in it does not matter; `out`
  /// must overlap neither it nor the tree. The result is a function of the tree's voxels, materials and
  /// merged blocks alone, not of the sizes given.
  ///
  /// `kOutOfMemory` when either is too small, `kDamaged` for a tree whose masks call for other counts than
  /// its header says, `kOutOfRange` for 2^31 bytes of nodes or 2^32 leaves; `out`, `shared` and `build` (but
  /// for its `bytes`) are then untouched. shared_tree_bytes and shared_work_bytes say what certainly
  /// suffices. Cost: one pass over the tree's nodes with a look into the table each, and one over the records
  /// a level.
  static Status make(const CompactTree& tree, Bytes out, Bytes work, SharedTree* shared,
                     SharedBuild* build = nullptr);

  /// Looks at `bytes` (at least the tree; more may follow). Constant time. On anything but `kOk`
  /// (`kDamaged`), `tree` is as it was.
  static Status open(ConstBytes bytes, SharedTree* tree);

  /// Reads every byte: checksum, nodes one after the other level by level, links that lead to a node of the
  /// level below, counts of leaves and nodes. Returns nullptr for a sound tree, otherwise a short English
  /// phrase saying what is wrong; "the workspace is too small" when `work` has less than
  /// shared_check_bytes(size) of a tree of that size (nothing is then said about the tree). `place` (may be
  /// null) gets the byte offset. Not looked at beyond the checksum: bounds, voxel count and solid added,
  /// which no reader relies on to be safe.
  static const char* validate(ConstBytes bytes, Bytes work, uint32_t* place = nullptr);

  int level() const { return level_; }
  bool empty() const { return root_ == kNowhere; }
  /// Different nodes of level 2 and above, solid blocks not counted: they are links without a node, and nodes
  /// of level 1 are bytes of their parents.
  uint32_t node_count() const { return node_count_; }
  /// Solid blocks and voxels, each as often as it occurs.
  uint32_t leaf_count() const { return leaf_count_; }
  /// Solid volume in voxels, merged blocks included.
  uint64_t voxel_count() const;
  /// Voxels that coarsening added (src/LAWS.md, law 1), 0 for an exact tree.
  uint64_t solid_added() const;
  bool many_materials() const { return materials_ != nullptr; }
  bool merged() const { return merged_bytes_ != 0; }
  uint8_t uniform_material() const { return uniform_material_; }
  /// The least box of voxels that holds everything solid.
  const VoxelBox& bounds() const { return bounds_; }
  size_t size_bytes() const { return size_bytes_; }
  const uint8_t* bytes() const { return base_; }
  /// Bytes of a link, 1 to 4, and of a count of leaves, 0 (one material) to 4.
  int link_bytes() const { return link_bytes_; }
  int count_bytes() const { return count_bytes_; }

  /// Bytes of this tree if it had several materials: counts, and one byte a leaf. Its own size where it has.
  /// One pass over the nodes.
  uint64_t bytes_with_materials() const;

  /// The material of the leaf that holds `voxel` of the world; 0 where nothing is solid. At most 7 siblings
  /// to count on each of 12 levels.
  uint8_t material(const Vec3i& voxel) const;

  // What the tracer needs. A node is known by a reference: the byte offset of its mask, or kInline with the
  // mask itself in bits 0 .. 7 (level 1 and solid blocks, which have mask 0) and whether it is merged in
  // bit 8.

  static constexpr uint32_t kInline = uint32_t{1} << 31;
  static constexpr uint32_t kMergedBit = 256;
  static constexpr uint32_t kNowhere = kInline - 1;

  uint32_t root() const { return root_; }
  /// The child mask of the node; 0 is a solid block. False for a reference that leads nowhere, which only a
  /// damaged tree has.
  bool load(uint32_t node, uint8_t* mask) const {
    if ((node & kInline) != 0) {
      *mask = static_cast<uint8_t>(node);
      return true;
    }
    if (node < first_node_ || node >= nodes_end_) {
      return false;
    }
    *mask = base_[node];
    return true;
  }
  /// The child of `node`, whose mask has the bit of `octant`. Anything but a node above level 1 has no
  /// children: kNowhere.
  uint32_t child(uint32_t node, uint32_t mask, unsigned octant) const;

 private:
  uint32_t leaves_of(uint32_t node) const;
  uint32_t load_number(uint32_t at, unsigned bytes) const;

  const uint8_t* base_ = nullptr;
  const uint8_t* materials_ = nullptr;
  uint32_t root_ = kNowhere;
  uint32_t first_node_ = 0;
  uint32_t level_3_ = 0;  // nodes from here on have links, those before have masks
  uint32_t nodes_end_ = 0;
  uint32_t node_count_ = 0;
  uint32_t leaf_count_ = 0;
  size_t size_bytes_ = 0;
  VoxelBox bounds_;
  uint8_t level_ = kMinLevel;
  uint8_t link_bytes_ = 1;
  uint8_t count_bytes_ = 0;
  uint8_t merged_bytes_ = 0;  // 1 in a tree with merged blocks: the byte behind each mask
  uint8_t uniform_material_ = 0;
};

}  // namespace thimble

#endif
