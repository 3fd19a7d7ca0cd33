/// @file octree.h
/// The tree that changes: an octree of voxels in a pool of 8-byte nodes that the caller provides.
///
/// Use it to build a scene voxel by voxel and to edit it; the compact tree made from it is what flash holds
/// and what is traced fastest.
///
/// A world is a cube of 2^level voxels a side, level 1 to 12. A node at level k stands for an aligned block
/// of 2^k voxels a side. Octants of a block are numbered with x as bit 0, y as bit 1 and z as bit 2, so
/// ascending octants are Morton order.
///
///   a solid block    no children: solid through, one material, at any level
///   an inner node    level >= 2: a mask of the octants that hold something; the children form a singly
///                    linked chain in octant order: octant o is popcount(mask & ((1 << o) - 1)) links along
///   a voxel node     level 1: the mask's bits are the 2 x 2 x 2 voxels themselves. One material serves all;
///                    only when they differ does a chain of level-0 nodes, one a voxel, hang on it
///
/// The tree is canonical: eight solid children of one material become one solid block at once, and what is
/// emptied disappears with its parents. A set of voxels has the same nodes whatever the order it came in
/// (until the tree coarsens), so a full world is one node, even when it was filled voxel by voxel.
///
/// Memory. All nodes have one size, so the pool cannot fragment, and an operation counts the nodes that it
/// needs before it writes the first: `kOutOfMemory` leaves the tree as it was. It is returned exactly when
/// the tree that would result has more nodes than the pool. The pool's bytes are not touched before they are
/// needed.
///
/// Coarsening. Where the caller asks for it, blocks are merged to solid ones instead. A merge of the block at
/// a node adds `added` voxels (the block's volume less what is solid in it) and saves `saved` nodes of 8
/// bytes (all below the node). The block with the least added / saved goes first, compared exactly; on a tie
/// the one that comes first in post-order (a block after all blocks inside it, otherwise Morton order); and
/// so on until enough is free. This is weakest-link pruning (Breiman, Friedman, Olshen, Stone: Classification
/// and Regression Trees, 1984, chapter 3), hence nested: what a larger pool merges, a smaller one merges too.
/// Nothing solid ever becomes empty. A merge that adds nothing (a solid block of several materials)
/// comes first, and costs only the difference between its materials. A merged block gets the material of the
/// largest solid piece of one material that was put into it (a solid block, the voxels of a voxel node of
/// one material, a single voxel; the lowest in Morton order on a tie), and is marked, because a hit on it
/// reports the block and not a voxel.
///
/// What it does not do: share equal subtrees, store empty space, keep normals. One writer, or many readers,
/// at a time.
#ifndef THIMBLE_TREE_OCTREE_H
#define THIMBLE_TREE_OCTREE_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"

namespace thimble {

/// A solid voxel: what bulk insertion takes.
struct Voxel {
  Vec3i position;        ///< 0 .. 2^level - 1 on every axis
  uint8_t material = 0;  ///< palette index
};

class Octree {
 public:
  /// "No node": where there is no root, no child, no next sibling.
  static constexpr uint32_t kNone = (uint32_t{1} << 27) - 1;
  /// The largest pool in nodes (1 GiB less one node); bytes beyond are left unused.
  static constexpr uint32_t kMaxNodes = kNone;
  static constexpr size_t kNodeBytes = 8;

  /// A node as others read it. Its level is not stored: the reader counts from `level()` at the root down.
  struct NodeView {
    uint8_t mask = 0;           ///< octants (level 1: voxels) that hold something; 0: solid through
    uint8_t material = 0;       ///< of a solid block, or of a voxel node without children
    bool merged = false;        ///< solid block that coarsening made: a hit reports its lowest corner
    bool has_children = false;  ///< true for inner nodes, and at level 1 when each voxel has its own material
    uint32_t first_child = kNone;  ///< head of the chain of children, in octant order
    uint32_t next = kNone;         ///< next sibling
    constexpr bool solid() const { return mask == 0; }
  };

  /// Bytes that hold a pool of `nodes` at any address (a span aligned to 4 bytes does with 3 fewer); SIZE_MAX
  /// when `size_t` cannot say it.
  static constexpr size_t octree_bytes(size_t nodes) {
    constexpr size_t kSlackBytes = sizeof(uint32_t) - 1;
    if (nodes > (SIZE_MAX - kSlackBytes) / kNodeBytes) {
      return SIZE_MAX;
    }
    return nodes * kNodeBytes + kSlackBytes;
  }

  Octree() = default;

  /// An empty world of 2^level voxels a side in `bytes`, which outlive the tree and belong to it. As many
  /// nodes as fit; none is a pool too, in which nothing can be inserted. Constant time; no byte is written.
  /// Also resets `set_coarsen` to false and all counts to 0. Errors: `kOutOfRange` for a level outside
  /// kMinLevel .. kMaxLevel, `octree` then being as it was.
  static Status make(int level, Bytes bytes, Octree* octree);
  /// The same with room for `nodes` nodes, of which the arena gives octree_bytes(nodes). Errors: also
  /// `kOutOfMemory`; the arena is then as it was, too.
  static Status make(int level, size_t nodes, Arena& arena, Octree* octree) {
    return make_in(arena, octree_bytes(nodes), sizeof(uint32_t), [&](Bytes bytes) {
      return nodes != 0 && bytes.empty() ? Status::kOutOfMemory : make(level, bytes, octree);
    });
  }

  /// Empties the tree, in constant time: also the high water and the added volume start from 0 again.
  void clear();

  /// Whether insertion coarsens the tree when the pool is full, instead of returning `kOutOfMemory`. It then
  /// frees at least 1/16 of the pool at a time, so that streaming stays in proportion to what is
  /// streamed. A pool of at least one node then takes everything: at worst the world ends as one solid block.
  /// What is inserted where the merging that it caused has just filled in counts as added volume.
  void set_coarsen(bool coarsen) { coarsen_ = coarsen; }

  // --- changing the tree -------------------------------------------------------------------------------

  /// Makes `voxel` solid, or gives it this material when it is solid already. Inside a merged block nothing
  /// changes, the material included. Cost: at most 12 levels of 8 links; near the previous insertion or
  /// removal only the levels that differ, so Morton order is fastest. At most 96 new nodes.
  /// Errors: `kOutOfRange` outside the world, `kOutOfMemory`; the tree is then as before.
  Status insert(Vec3i voxel, uint8_t material = 0) { return insert_block(voxel, 0, material); }

  /// Makes the aligned block of 2^block_level voxels a side with its lowest corner at `corner` solid with one
  /// material, whatever was in it (merged blocks inside become truly full; inside a merged block nothing
  /// changes). Cost: as `insert`, and the nodes that it replaces.
  /// Errors: `kOutOfRange` outside the world, `kBadArgument` when `corner` is no multiple of the side,
  /// `kOutOfMemory`; the tree is then as before.
  Status insert_block(Vec3i corner, int block_level, uint8_t material);

  /// Inserts voxels in the order given, best Morton order. `inserted` is how many were: all, or those before
  /// the first that failed, which stay.
  Status insert_all(Span<const Voxel> voxels, size_t& inserted);

  /// Makes every voxel of `box` solid, in aligned blocks and Morton order. Unlike the others it can stop
  /// half way at `kOutOfMemory`: the blocks done stay, and the call can be repeated when there is room.
  /// Errors: `kOutOfRange` (nothing changes) when the box leaves the world. Cost: about the box's surface.
  Status insert_box(const VoxelBox& box, uint8_t material);

  /// Makes `voxel` empty; nothing happens when it is. In a solid block of level k this takes 8 * (k - 1) new
  /// nodes, the siblings on each level; those of a merged block are merged blocks too, single voxels
  /// excepted. Never coarsens. `solid_added` keeps what merging added, removed since or not.
  /// Errors: `kOutOfRange` outside the world, `kOutOfMemory`; the tree is then as before.
  Status remove(Vec3i voxel);

  /// Coarsens until at least `nodes` nodes are free. Nothing happens when they are.
  /// Errors: `kOutOfMemory` when even a tree of one node would leave fewer; the tree is then as before.
  Status make_room(size_t nodes);

  /// Coarsens until the tree has at most `max_nodes` nodes, for whoever has to fit it elsewhere.
  /// Errors: `kOutOfMemory` for 0 nodes of a tree that is not empty; the tree is then as before.
  Status coarsen_to(size_t max_nodes);

  /// Prices of a node: step s, 0 .. kPriceSteps - 1, is 2^(s / 4 - 27) voxels of added volume, quarters in
  /// between linearly. For whoever has several trees (the parts of a world) to coarsen alike: blocks of the
  /// same price go from all.
  static constexpr int kPriceSteps = 252;
  /// How many nodes the tree would have after `coarsen_at(step)`. Changes nothing. One pass.
  uint32_t nodes_at(int step);
  /// Merges every block that adds at most the price for each node it saves, given what was merged inside it.
  /// One pass. Both take the nearest step for one out of range.
  void coarsen_at(int step);

  // --- asking ------------------------------------------------------------------------------------------

  /// Whether `voxel` is solid; false outside the world.
  bool test(Vec3i voxel) const;
  /// The material of `voxel`, or -1 when it is empty or outside the world.
  int material(Vec3i voxel) const;

  int level() const { return level_; }
  /// A box that holds everything solid. It grows with what is inserted and does not shrink with what is
  /// removed; once anything was coarsened it is the whole world.
  const VoxelBox& bounds() const { return bounds_; }
  bool empty() const { return used_ == 0; }
  /// Solid volume in voxels, 0 .. 2^36, added volume included.
  uint64_t voxels() const { return voxels_; }
  /// Volume in voxels that merging has added since `make` or `clear`.
  uint64_t solid_added() const { return solid_added_; }
  uint32_t capacity() const { return capacity_; }
  uint32_t nodes_used() const { return used_; }
  uint32_t nodes_free() const { return capacity_ - used_; }
  /// The most nodes ever used at a time since `make` or `clear`: also how much of the pool was ever written.
  uint32_t nodes_high_water() const { return fresh_; }
  size_t capacity_bytes() const { return size_t{capacity_} * kNodeBytes; }
  size_t used_bytes() const { return size_t{used_} * kNodeBytes; }
  size_t high_water_bytes() const { return size_t{fresh_} * kNodeBytes; }

  // --- reading nodes: the tracer, the builder of the compact tree ------------------------------------

  /// The root's index, or kNone in an empty tree. Indices are valid until the next change.
  uint32_t root() const { return used_ == 0 ? kNone : root_; }
  /// Node `index`. An index that was never a node's gives an empty-handed solid view: memory that
  /// something else damaged can make a wrong picture, not a read outside the pool.
  NodeView node(uint32_t index) const;
  /// The child of `parent` in `octant` (0..7), or kNone where it has none: at most 7 links.
  uint32_t child(const NodeView& parent, int octant) const;

 private:
  /// One node, in two words because a 32-bit chip then reads only the half that it needs (a walk along
  /// siblings only the second), and 4-byte alignment is enough.
  ///
  ///   link_mask   31            8 7        0      next_flags  31           5 4      3      2        0
  ///              | link, low 24  |   mask   |                |  next, 27    |chain |merged| link, high|
  ///
  /// `chain`: the link is the first child. Otherwise its low 8 bits are the material, and in a merged block
  /// the bits from 8 on are the rank of the piece that the material came from.
  struct Node {
    uint32_t link_mask;
    uint32_t next_flags;
  };
  static_assert(sizeof(Node) == kNodeBytes && alignof(Node) <= sizeof(uint32_t));

  /// added / saved, exactly. added <= 2^36 and saved <= 2^27, so products across stay below 2^64.
  struct Ratio {
    uint64_t added;
    uint32_t saved;
  };
  enum class Pass : uint8_t {
    kMeasure,      ///< writes nothing; takes ratios up to the limit
    kMergeBelow,   ///< merges every block below the limit
    kMergeWithin,  ///< merges blocks up to the limit until enough is free
  };

  static uint8_t mask_of(Node node) { return static_cast<uint8_t>(node.link_mask); }
  static uint32_t link_of(Node node) { return (node.link_mask >> 8) | ((node.next_flags & kLinkHigh) << 24); }
  static uint32_t next_of(Node node) { return node.next_flags >> kNextShift; }
  static bool is_merged(Node node) { return (node.next_flags & kMerged) != 0; }
  static bool has_children(Node node) { return (node.next_flags & kChain) != 0; }
  static uint8_t leaf_material(Node node) { return static_cast<uint8_t>(node.link_mask >> 8); }
  static constexpr uint32_t kLinkHigh = 7;
  static constexpr uint32_t kMerged = 8;
  static constexpr uint32_t kChain = 16;
  static constexpr int kNextShift = 5;

  void set_mask(uint32_t index, uint32_t mask);
  void set_link(uint32_t index, uint32_t link);
  void set_next(uint32_t index, uint32_t next);
  void make_leaf(uint32_t index, uint8_t material);
  void make_merged(uint32_t index, uint8_t material, uint8_t rank);
  static uint8_t leaf_rank(Node leaf, int level);

  uint32_t allocate();
  void release(uint32_t index);
  void release_chain(uint32_t first);
  uint32_t walk(uint32_t index, uint32_t links) const;
  void attach(uint32_t parent, uint32_t octant, uint32_t child);
  void detach(uint32_t parent, uint32_t octant);

  bool inside(Vec3i voxel) const;
  int cached_level(Vec3i voxel, int lowest) const;
  int descend(Vec3i voxel, uint32_t& index) const;
  uint64_t solid_volume(uint32_t index, int top_level) const;
  bool uniform_children(Node node, uint8_t material) const;

  uint32_t try_insert(Vec3i corner, int block_level, uint8_t material);
  uint32_t try_insert_voxel(uint32_t index, uint32_t octant, uint8_t material);
  void grow_bounds(Vec3i corner, int block_level);
  void insert_merged(Vec3i corner, int block_level, uint8_t material);
  void remove_voxel(uint32_t index, uint32_t octant);
  uint32_t build_path(Vec3i corner, int from_level, int block_level, uint8_t material);
  uint32_t split(uint32_t index, int level, uint32_t octant);
  void make_voxel_chain(uint32_t index);
  void drop_uniform_chain(uint32_t index);
  void collapse_above(int level);
  bool collapse(uint32_t index, int level);

  static Ratio threshold(uint32_t code);
  static uint32_t threshold_code(Ratio ratio);
  uint32_t pass(Pass kind, Ratio limit, uint32_t wanted, Ratio& next_ratio);
  uint32_t pass_at(Pass kind, int step);
  void free_nodes(uint32_t wanted);

  Node* nodes_ = nullptr;
  uint32_t capacity_ = 0;
  uint32_t used_ = 0;
  uint32_t fresh_ = 0;          ///< nodes from here on were never used
  uint32_t free_head_ = kNone;  ///< nodes given back, linked by `next`
  uint32_t root_ = kNone;
  uint64_t voxels_ = 0;
  uint64_t solid_added_ = 0;
  VoxelBox bounds_;
  /// The path to the last place changed: path_[k] is the node at level k above cursor_, valid for levels
  /// path_low_ .. level_ while the tree is not empty.
  Vec3i cursor_;
  uint32_t path_[kMaxLevel + 1] = {};
  uint32_t threshold_hint_ = 0;  ///< where the last search for a ratio ended; speeds up the next one only
  uint8_t path_low_ = 0;
  uint8_t level_ = kMinLevel;
  bool coarsen_ = false;
};

}  // namespace thimble

#endif
