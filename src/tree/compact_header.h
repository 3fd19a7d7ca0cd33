// Byte offsets of a compact tree's header and sections (src/FORMAT.md), and what its writers and readers
// share. Internal to src/.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "../base/bits.h"
#include "thimble/tree/compact_tree.h"

namespace thimble {

// What the header of a compact tree and that of a shared one (extras) have alike.
namespace tree_header {

inline constexpr uint32_t kMagicMask = 0x00FFFFFF;  // all but the version
inline constexpr uint32_t kLevelOffset = 4;
inline constexpr uint32_t kFlagsOffset = 6;
inline constexpr uint32_t kMaterialOffset = 7;
inline constexpr uint32_t kSizeOffset = 8;
inline constexpr uint32_t kChecksumOffset = 12;
inline constexpr uint32_t kNodesOffset = 16;
inline constexpr uint32_t kBoundsMinOffset = 28;
inline constexpr uint32_t kBoundsMaxOffset = 34;
inline constexpr uint32_t kVoxelCountOffset = 40;
inline constexpr uint32_t kSolidAddedOffset = 48;

inline constexpr unsigned kManyMaterialsFlag = 1;
inline constexpr unsigned kMergedFlag = 2;
inline constexpr unsigned kKnownFlags = kManyMaterialsFlag | kMergedFlag;

inline void load_bounds(const uint8_t* base, VoxelBox* bounds) {
  for (int axis = 0; axis < 3; ++axis) {
    bounds->low[axis] = static_cast<int32_t>(bits::load16(base + kBoundsMinOffset + 2 * axis));
    bounds->high[axis] = static_cast<int32_t>(bits::load16(base + kBoundsMaxOffset + 2 * axis));
  }
}

inline void store_bounds(const VoxelBox& bounds, uint8_t* base) {
  for (int axis = 0; axis < 3; ++axis) {
    bits::store16(base + kBoundsMinOffset + 2 * axis, static_cast<uint32_t>(bounds.low[axis]));
    bits::store16(base + kBoundsMaxOffset + 2 * axis, static_cast<uint32_t>(bounds.high[axis]));
  }
}

// Whether they are those of an empty tree, or lie in a world of that level.
inline bool has_sound_bounds(const uint8_t* base, bool is_empty, int level) {
  for (int axis = 0; axis < 3; ++axis) {
    const uint32_t low = bits::load16(base + kBoundsMinOffset + 2 * axis);
    const uint32_t high = bits::load16(base + kBoundsMaxOffset + 2 * axis);
    if (!(is_empty ? low == 0 && high == 0 : low < high && high <= 1U << level)) {
      return false;
    }
  }
  return true;
}

}  // namespace tree_header

namespace compact_header {

using namespace tree_header;
inline constexpr uint32_t kMagic = 0x01424D54;  // "TMB", then the version, 1
inline constexpr uint32_t kRankShiftOffset = 5;
inline constexpr uint32_t kSolidBlocksOffset = 20;
inline constexpr uint32_t kVoxelBitsOffset = 24;
static_assert(kSolidAddedOffset + 8 == kCompactHeaderBytes);

}  // namespace compact_header

// Where each section starts, in bytes from the front. Only valid for a shape whose compact_bytes is not 0.
struct CompactSections {
  size_t masks;
  size_t ranks;
  size_t merged;
  size_t block_ranks;
  size_t materials;
};

constexpr CompactSections sections_of(const CompactShape& shape) {
  const size_t nodes = shape.nodes;
  const size_t blocks =
      (nodes >> shape.rank_shift) + ((nodes & ((size_t{1} << shape.rank_shift) - 1)) != 0 ? 1 : 0);
  CompactSections at{};
  at.masks = kCompactHeaderBytes;
  at.ranks = at.masks + ((nodes + 3) & ~size_t{3});
  at.merged = at.ranks + 4 * blocks;
  at.block_ranks = at.merged + (shape.merged ? ((nodes + 31) >> 5) * 4 : 0);
  at.materials = at.block_ranks + (shape.many_materials && shape.solid_blocks != 0 ? 4 * blocks : 0);
  return at;
}

// Which octant of its node of `level` holds a voxel.
constexpr unsigned octant_of(const Vec3i& voxel, int level) {
  const int shift = level - 1;
  return (static_cast<uint32_t>(voxel.x) >> shift & 1U) |
         (static_cast<uint32_t>(voxel.y) >> shift & 1U) << 1 |
         (static_cast<uint32_t>(voxel.z) >> shift & 1U) << 2;
}

// Whether a voxel lies in a world of 2^level.
constexpr bool is_in_world(const Vec3i& voxel, int level) {
  const uint32_t all =
      static_cast<uint32_t>(voxel.x) | static_cast<uint32_t>(voxel.y) | static_cast<uint32_t>(voxel.z);
  return (all >> level) == 0;
}

// Moves the corner of a block of `level` to that of the block in `octant` of the same parent.
constexpr void move_to_octant(unsigned octant, int level, Vec3i* corner) {
  const int32_t side = int32_t{1} << level;
  for (int axis = 0; axis < 3; ++axis) {
    (*corner)[axis] = ((*corner)[axis] & ~(2 * side - 1)) | ((octant >> axis & 1U) != 0 ? side : 0);
  }
}

// Calls leaf(node, corner, level) for what a tree that is not empty holds, in Morton order: solid blocks, and nodes of
// level `lowest`; also for numbers of no node, which a damaged tree has. `leaf` may be false to stop.
template <class Leaf>
[[gnu::always_inline]] inline void walk_leaves(const CompactTree& tree, int lowest, const Leaf& leaf) {
  struct OpenNode {
    uint32_t child;
    uint8_t rest;  // the octants of the children still to come
  } stack[kMaxLevel + 1];
  Vec3i corner;
  uint32_t node = 0;
  int level = tree.level();
  for (;;) {
    const uint8_t mask = node < tree.node_count() ? tree.mask(node) : uint8_t{0};
    stack[level] = {0, 0};
    if (mask != 0 && level > lowest) {
      stack[level] = {tree.first_child(node), mask};
    } else if (!leaf(node, corner, level)) {
      return;
    }
    while (stack[level].rest == 0) {
      if (++level > tree.level()) {
        return;
      }
    }
    OpenNode& open = stack[level];
    const unsigned octant = bits::lowest_bit(open.rest);
    open.rest = static_cast<uint8_t>(open.rest & (open.rest - 1));
    node = open.child++;
    move_to_octant(octant, --level, &corner);
  }
}

// The solid voxels of a tree whose masks are sound, depth first; `bounds` gets the least box that holds them.
uint64_t solid_volume(const CompactTree& tree, VoxelBox* bounds);

// Grows `box` (all zero at first) by what is solid in the node of `level` at `corner`: all of it for mask 0,
// else the voxels of a level-1 mask.
constexpr void grow_box(VoxelBox* box, const Vec3i& corner, int level, unsigned mask) {
  // Which of the lower and upper halves hold a voxel: bits of the mask with that axis' bit of the octant 0
  // or 1.
  constexpr unsigned kUpper[3] = {0xAA, 0xCC, 0xF0};
  const bool first = box->empty();
  for (int axis = 0; axis < 3; ++axis) {
    int32_t low = corner[axis];
    int32_t high = corner[axis] + (int32_t{1} << level);
    if (mask != 0) {
      if ((mask & ~kUpper[axis] & 0xFFU) == 0) {
        ++low;
      }
      if ((mask & kUpper[axis]) == 0) {
        --high;
      }
    }
    if (first || low < box->low[axis]) {
      box->low[axis] = low;
    }
    if (first || high > box->high[axis]) {
      box->high[axis] = high;
    }
  }
}

}  // namespace thimble
