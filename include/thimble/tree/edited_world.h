/// @file edited_world.h
/// A compact tree and its brick map that change: voxels are set and cleared while the world is drawn, on a
/// chip too, in the caller's bytes.
///
/// Worlds have level 8 at most; with THIMBLE_DEEP_WORLDS (brick_map.h), 10.
///
/// `make` copies a compact tree (from flash, say) into bytes with room to grow. From then on `tree()` and
/// `map()` are views for everything that draws or traces, and after each edit they are what a tree and a map
/// built anew would be: same voxels, same materials, same pictures and hits. What an edit does to what was made of them:
///
///   copies of `tree()`, `map()`    stale: fetch them again; a frame with a map and a tree of two times is kDamaged
///   SunBricks                      belong to no map until they are followed (map_render.h), so a frame is right without;
///                                  of level 9 and 10 as well, where what they hold is bytes of a plane, not bits of bricks
///   AnytimeFrame, bands            of the world as it was; begin again
///   BakedScene, Octree, flash      copies, of the world as it was; `pack` writes the tree as bytes for flash
///   wide::VoxelLists, RayMap, what is kept on a GPU, NodeColors    copies as well: make them anew, of level 9 and 10 of
///                                  what `pack` wrote, as they read nodes in order; `changed()` says where
///   cameras, lights, palettes      are not concerned
///
/// `tree().bytes()` is a header, whose checksum is the stamp that tells a world of before an edit from one of after.
///
/// Work of an edit, up to level 8: no loop but over the nodes, materials and bricks that there are. It moves at most all of
/// them by some places, once for each level that gains or loses nodes (seldom more than one, at most
/// `level()`), and counts nodes anew from the first that changed. Nodes that it may add: 8 a level, where
/// a large solid block is opened. In the demonstration's world (64 voxels a side, 5,700 nodes, 17,000 leaves)
/// an edit takes at most 540,000 instructions on a Cortex-M3, a fifth of a frame. Stack below 500 bytes.
/// Of level 9 and 10 nothing moves but the children of a node and the voxels of a brick: some thousand instructions whatever
/// there is in the world, 30,000 where a page of 64 bricks comes.
#ifndef THIMBLE_TREE_EDITED_WORLD_H
#define THIMBLE_TREE_EDITED_WORLD_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "brick_map.h"
#include "compact_tree.h"

namespace thimble {

/// How much a world can hold. Of level 9 and 10 nodes are taken by eights, for all children of one, and those of level 1
/// and leaves belong to their brick: `nodes` are those above, and `leaves` are 0.
struct EditRoom {
  uint32_t nodes = 0;   ///< of the tree
  uint32_t leaves = 0;  ///< solid blocks and voxels of level 1: a material each
  uint32_t bricks = 0;  ///< cells of 4 x 4 x 4 voxels that are neither empty nor solid of one material
  uint32_t pages = 0;   ///< of level 9 and 10: cells of 16 x 16 x 16 voxels that are neither
};

/// Materials of which whole bricks can be solid.
inline constexpr uint32_t kSolidBrickKinds = 32;

/// The most room: a node's number takes 24 bits, a brick's 16 with some to spare, and a node has 8 leaves at most. Of level
/// 9 and 10 nodes and eight times the bricks are below 2^24, and pages are 131,070 at most.
inline constexpr EditRoom kMostEditRoom{(uint32_t{1} << 24) - 1, uint32_t{1} << 27, 65000, 131070};

/// Bytes of a world of 2^level voxels a side with that room, kMinBrickMapLevel to kMaxBrickMapLevel; 0 for another level and
/// for more than the most room.
constexpr size_t packed_world_bytes(int level, const EditRoom& room) {
  if (level < kMinBrickMapLevel || level > kMaxBrickMapLevel || room.nodes > kMostEditRoom.nodes ||
      room.leaves > kMostEditRoom.leaves || room.bricks > kMostEditRoom.bricks) {
    return 0;
  }
  const auto up = [](size_t bytes) { return (bytes + 7) & ~size_t{7}; };
  const size_t blocks = (size_t{room.nodes} >> kDefaultRankShift) + 1;
  const size_t cells = size_t{1} << (3 * (level - 2));
  return up(kCompactHeaderBytes) + up(size_t{room.nodes} + 8) + 2 * up(4 * blocks) + up(room.leaves) +
         up(2 * cells) + 8 * (1 + size_t{room.bricks} + kSolidBrickKinds) + up(12 * size_t{room.bricks}) +
         kSolidBrickKinds;
}

/// The same of level 9 and 10: 9 bytes a node, 144 a brick, 1,428 a page, and 0.5 or 1 MiB.
constexpr size_t deep_world_bytes(int level, const EditRoom& room) {
  const uint64_t slots = ((uint64_t{room.nodes} + 7) & ~uint64_t{7}) + 8 * uint64_t{room.bricks};
  if (level <= kMaxBrickMapLevel || level > kMaxDeepMapLevel || slots > kMostEditRoom.nodes ||
      64 * uint64_t{room.pages} > kMaxDeepBricks - 64) {
    return 0;
  }
  const auto up = [](size_t bytes) { return (bytes + 7) & ~size_t{7}; };
  const size_t last = (size_t{1} << (level - 4)) - 1;
  const size_t cells = last * (1 + 64 + 4096) + 1;
  const size_t pages = room.pages;
  const auto nodes = static_cast<size_t>(slots);
  return up(kCompactHeaderBytes + 16) + (nodes + 8) + 2 * up(4 * nodes) + up(256 + 72 * size_t{room.bricks}) +
         up(4 * cells) + up(68 * (1 + kSolidBrickKinds + pages)) + (1 + pages) * (8 * 64 + 16 + 64) +
         12 * 64 * pages;
}

/// Bytes of a world of 2^level voxels a side with that room; 0 for a level below kMinBrickMapLevel or above
/// kMaxDeepMapLevel, and for more than the most room.
constexpr size_t edited_world_bytes(int level, const EditRoom& room) {
  return level > kMaxBrickMapLevel ? deep_world_bytes(level, room) : packed_world_bytes(level, room);
}

/// What edits of many voxels changed, in the caller's bytes, so that they can be taken back: 8 bytes a voxel and 8 an
/// edit. Of one world, between whose edits nothing else changes it. Copies share the bytes.
class EditJournal {
 public:
  EditJournal() = default;
  /// An empty one in `bytes`, at any address, which outlive it.
  explicit EditJournal(Bytes bytes) : bytes_(bytes) {}

  /// Voxels and edits that it holds room for, and that it holds.
  size_t capacity() const { return bytes_.size / kEntryBytes; }
  size_t size() const { return size_; }
  /// Forgets the edits, which then stay.
  void clear() { size_ = 0; }

 private:
  friend class EditedWorld;
  static constexpr size_t kEntryBytes = 8;

  Bytes bytes_;
  size_t size_ = 0;
};

/// What of a box is edited: all of it, or the voxels whose centre lies in the ellipsoid that touches its sides, in a cube
/// a ball.
enum class EditShape : uint8_t { kBox, kBall };

/// A world that changes. It is the one owner of its bytes: a copy of it would change them behind its back.
class EditedWorld {
 public:
  EditedWorld() = default;

  /// What `tree` takes: the least room with which `make` succeeds. One pass over the bricks of the world. Of level 9 and 10
  /// solid pages of more than kSolidBrickKinds materials take room besides.
  static EditRoom room_of(const CompactTree& tree);
  /// Bytes of a world of that room; 0 where `make` takes none of that tree, whatever the room.
  static size_t least_bytes(const CompactTree& tree);
  /// The most room that `bytes` bytes hold for `tree`, shared out in the proportions that digging wants; none
  /// (all 0) where they do not hold the tree, or the tree has more than 65,000 bricks.
  static EditRoom room_in(const CompactTree& tree, size_t bytes);

  /// Copies `tree` into `bytes` (at a multiple of 8, at least edited_world_bytes of the room). Some 1,000
  /// instructions a brick of the world. Errors, with `world` unchanged: `kOutOfRange` (levels that no brick map
  /// has, more than the most room), `kBadArgument` (a coarsened tree, whose blocks are
  /// no voxels; an odd address), `kOutOfMemory` (bytes or room too small, or, with `bytes` written, more than
  /// kSolidBrickKinds materials of solid bricks).
  static Status make(const CompactTree& tree, const EditRoom& room, Bytes bytes, EditedWorld* world);

  /// Makes `voxel` solid with `material`, whatever it was. Errors, with nothing changed: `kOutOfRange`
  /// (outside the world), `kOutOfMemory` (no room: `free_room()` says for what).
  Status set(const Vec3i& voxel, uint8_t material);
  /// Makes `voxel` empty, whatever it was. Errors as `set`: opening a solid block takes room, too.
  Status clear(const Vec3i& voxel);

  /// Makes all voxels of a shape solid with `material`, or empty with kEmpty, as one edit, which `undo` takes back. What
  /// lies outside the world is passed over. Costs a `set` or a `clear` for each voxel that changes, a look for each
  /// other. `journal` is of this world. Errors, with every voxel as it was: `kOutOfRange` (a side of more than
  /// kMostEditSide, a corner beyond +-2^20), `kBadArgument` (a material outside of -1 .. 255), `kOutOfMemory` (no room in the
  /// world or in the journal).
  Status edit(const VoxelBox& box, EditShape shape, int material, EditJournal* journal);
  /// Takes the journal's last edit back. Errors, with nothing changed: `kBadArgument` for a journal without a whole edit.
  Status undo(EditJournal* journal);
  static constexpr int kEmpty = -1;
  static constexpr int32_t kMostEditSide = 512;

  /// A box that holds all voxels that changed since `make` or `forget_changes`, for what is kept of the world elsewhere
  /// (SunBricks::follow, a copy on a GPU); and the map's stamp of that time.
  const VoxelBox& changed() const { return changed_; }
  uint32_t changed_from() const { return changed_from_; }
  void forget_changes() {
    changed_ = {};
    changed_from_ = map_.stamp();
  }

  /// The material of `voxel`; kEmpty where nothing is, and outside the world.
  int material(const Vec3i& voxel) const;

  /// Of level 9 and 10 node_count() are places, of which many are free, and nodes are not in order
  /// (CompactTree::nodes_in_order).
  const CompactTree& tree() const { return tree_; }
  const BrickMap& map() const { return map_; }
  int level() const { return tree_.level(); }
  EditRoom room() const { return room_; }
  EditRoom free_room() const;
  bool empty() const { return tree_.empty(); }
  /// A box that holds all that is solid: it grows with what is set, and stays when voxels are cleared.
  const VoxelBox& bounds() const { return tree_.bounds(); }

  /// Writes the tree as CompactTree::make would for these voxels, byte for byte, to the front of `out`;
  /// `size` (may be null) gets its bytes, also when `out` is too small (`kOutOfMemory`, nothing written).
  Status pack(Bytes out, size_t* size = nullptr) const;

 private:
  friend struct DeepWorld;
  struct Place;

  void look_at_sections(const CompactTree& tree, int rank_shift);
  uint32_t child_of(uint32_t node, unsigned octant) const;
  bool find(const Vec3i& voxel, int to_level, Place* place) const;
  int material_within(const Vec3i& voxel) const;
  Status make_voxel(const Vec3i& voxel, int material);
  void take_back(EditJournal* journal, size_t to);
  Status check_room(const Vec3i& voxel, int material, bool* changes) const;
  void insert_nodes(uint32_t at, uint32_t count);
  void remove_nodes(uint32_t at, uint32_t count);
  void move_leaves(uint32_t at, uint32_t removed, uint32_t inserted, uint8_t material);
  void change_blocks(uint32_t at, uint32_t removed, uint32_t inserted, uint8_t material);
  void change_voxels(uint32_t at, uint32_t removed, uint32_t inserted, uint8_t material);
  void count_from(uint32_t node);
  void add_root(uint8_t material);
  void remove_root();
  void open_block(uint32_t node, int level, unsigned mask);
  void close_node(uint32_t node, int level);
  void add_child(uint32_t node, int level, unsigned octant, uint8_t material);
  void remove_child(uint32_t node, int level, unsigned octant);
  bool is_uniform(uint32_t node, int level, uint8_t material) const;
  uint8_t* cell_of(const Vec3i& voxel) const;
  uint32_t kind_of(uint8_t material) const;
  Status update_cell(const Vec3i& voxel);
  void write_header(int64_t voxels);
  Status note_change(const Vec3i& voxel, int64_t voxels);

  CompactTree tree_;
  BrickMap map_;
  VoxelBox changed_;
  uint32_t changed_from_ = 0;
  EditRoom room_;
  uint8_t* header_ = nullptr;
  uint8_t* masks_ = nullptr;
  uint8_t* ranks_ = nullptr;
  uint8_t* block_ranks_ = nullptr;
  uint8_t* leaves_ = nullptr;
  uint8_t* cells_ = nullptr;
  uint8_t* bricks_ = nullptr;
  uint8_t* origins_ = nullptr;
  uint8_t* kinds_ = nullptr;
  uint32_t kind_count_ = 0;
  uint32_t free_brick_ = 0;  ///< the first of a chain; 0: none
  uint32_t free_bricks_ = 0;
};

}  // namespace thimble

#endif
