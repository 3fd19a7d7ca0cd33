/// Counts, then writes, the list of a tree's surface: the voxels that have a neighbour which is not solid, in Morton
/// order; and says what lists are made of.
///
/// The tree is read in words of 4 x 4 x 4 voxels, a bit each in Morton order. Six shifts of a word and of its
/// neighbours say which of its voxels are hidden; neighbours are looked up only where the word itself leaves that open.
/// Solid blocks are cut only where one of their faces is not known to be covered, so the work grows with the surface,
/// not with the volume.
#pragma once

#include <stdint.h>

#include "thimble/tree/compact_tree.h"
#include "wide/raster/voxel_lists.h"

namespace thimble::wide {

/// Packs the entry of a box of 2^level voxels a side (voxel_lists.h).
inline uint32_t packed(const uint32_t (&corner)[3], int level) {
  const uint32_t within = (uint32_t{1} << kCubeLevel) - 1;
  const uint32_t x = corner[0] & within;
  const uint32_t y = corner[1] & within;
  const uint32_t z = corner[2] & within;
  const uint32_t side = level < 3 ? static_cast<uint32_t>(level) : 3;
  const uint32_t more = level < 3 ? 0 : static_cast<uint32_t>(level - 3);
  return x | more | y << 10 | z << 20 | side << 30;
}
inline uint16_t packed_short(const uint32_t (&corner)[3]) {
  return static_cast<uint16_t>((corner[0] & 31U) | (corner[1] & 31U) << 5 | (corner[2] & 31U) << 10);
}

/// Where a list is written. `materials` and `merged` are null where the tree has none.
struct ListTo {
  uint32_t* entries;
  uint16_t* short_entries;  ///< null, or in place of `entries`
  BlockNode* nodes;
  uint8_t* materials;
  uint8_t* merged;
};

/// How large the list of a surface is.
struct SurfaceCount {
  uint64_t entries = 0;
  /// Where each level's nodes begin, the root's first; so [level - 1] is the number of nodes of that level and above.
  /// Levels below 2 have none.
  uint32_t level_begin[kMaxLevel + 2] = {};
};

/// Whether the voxel is solid; false outside the world. Sets `level` to that of a block around the voxel that is wholly
/// solid or wholly empty.
bool solid_at(const CompactTree& tree, const int32_t (&voxel)[3], int* level);

/// The most voxels of a 2 x 2 x 2 cube with this mask that can have six solid neighbours: those whose three neighbours
/// in the cube are solid.
unsigned most_hidden(unsigned mask);

/// Both functions take trees of level 2 or more that are not empty and were not coarsened, and whose masks add up level
/// by level, and the tree's own first node of each level. They trust nothing else: the directory may be damaged.
SurfaceCount count_surface(const CompactTree& tree, const uint32_t* level_begin);
void write_surface(const CompactTree& tree, const uint32_t* level_begin, const SurfaceCount& count,
                   int block_level, const ListTo& to);

}  // namespace thimble::wide
