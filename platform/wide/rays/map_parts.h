/// @file map_parts.h
/// What map_build.cpp and media_build.cpp share: the cubes and leaves of a map's numbering, and the walk down the tree.
#ifndef THIMBLE_PLATFORM_WIDE_RAYS_MAP_PARTS_H
#define THIMBLE_PLATFORM_WIDE_RAYS_MAP_PARTS_H

#include <algorithm>

#include "wide/rays/ray_map.h"

namespace thimble::wide {

inline constexpr int kChunkLevel = 4;
inline constexpr int kLeafLevel = 2;
inline constexpr unsigned kLeaves = 64;              // of a chunk
inline constexpr uint32_t kEmptyCube = 0x11111111U;  // before it is known how far it reaches
inline constexpr uint64_t kMostWords = uint64_t{1}
                                       << 28;  // of chunks, so that a cube says where its own begins

/// How large a map is, and where each level of the tree begins.
struct MapShape {
  uint32_t level_begin[kMaxLevel + 1];
  uint32_t block_begin[kMaxLevel + 1];  // the number of the first solid block of each level
  uint64_t top = 0;                     // cubes
  uint64_t words = 0;                   // of chunks
};

struct Corner {
  uint32_t x;
  uint32_t y;
  uint32_t z;
};

inline Corner child_corner(const Corner& corner, unsigned octant, int level) {
  const uint32_t half = uint32_t{1} << (level - 1);
  return {corner.x + ((octant & 1U) != 0 ? half : 0), corner.y + ((octant & 2U) != 0 ? half : 0),
          corner.z + ((octant & 4U) != 0 ? half : 0)};
}

// The number of a cell in its cube of 4^3 cells.
inline unsigned bit_of(const Corner& corner, int level) {
  return ((corner.x >> level) & 3U) | ((corner.y >> level) & 3U) << 2 | ((corner.z >> level) & 3U) << 4;
}

// Spreads the mask of a node of level 1 to the bits of a leaf, of which the node has the first voxel.
inline uint64_t spread(unsigned mask) {
  return uint64_t{mask & 3U} | uint64_t{(mask >> 2) & 3U} << 4 | uint64_t{(mask >> 4) & 3U} << 16 |
         uint64_t{(mask >> 6) & 3U} << 20;
}

/// Walks the tree depth first, which meets the nodes, blocks and voxels of each level in the order in which they stand,
/// and hands `taker` what is solid:
///
///     take_block(corner, level, material)   a block of a chunk's size or larger
///     take_leaf(corner, voxels, material)   within a chunk: bits of the leaf at `corner`, of one block
///     take_voxels(corner, mask, number)     single voxels: the mask of their node, and the number of the first
///     take_chunk(corner, node)              behind all that a chunk holds; in a smaller world it is the root
template <class Taker>
class TreeWalk {
 public:
  TreeWalk(const CompactTree& tree, const MapShape& shape, Taker* taker)
      : tree_(tree), taker_(*taker), next_voxel_(tree.node_count()) {
    std::copy(shape.level_begin, shape.level_begin + kMaxLevel + 1, next_node_);
    std::copy(shape.block_begin, shape.block_begin + kMaxLevel + 1, next_block_);
  }

  void run() {
    if (tree_.level() < kChunkLevel) {
      enter_chunk(tree_.level(), {0, 0, 0});
    } else {
      enter(tree_.level(), {0, 0, 0});
    }
  }

 private:
  void enter(int level, const Corner& corner) {
    if (level == kChunkLevel && tree_.mask(next_node_[level]) != 0) {
      enter_chunk(level, corner);
      return;
    }
    visit(
        level, [&](unsigned octant) { enter(level - 1, child_corner(corner, octant, level)); },
        [&](uint8_t material) { taker_.take_block(corner, level, material); });
  }

  void enter_chunk(int level, const Corner& corner) {
    const uint32_t node = next_node_[level];
    collect(level, corner);
    taker_.take_chunk(corner, node);
  }

  void collect(int level, const Corner& corner) {
    const unsigned mask = tree_.mask(next_node_[level]);
    if (level == 1 && mask != 0) {
      ++next_node_[1];
      taker_.take_voxels(corner, mask, next_voxel_);
      next_voxel_ += static_cast<uint32_t>(__builtin_popcount(mask));
      return;
    }
    visit(
        level, [&](unsigned octant) { collect(level - 1, child_corner(corner, octant, level)); },
        [&](uint8_t material) {
          if (level < kLeafLevel) {
            taker_.take_leaf(corner, spread(0xFF) << bit_of(corner, 0), material);
            return;
          }
          const uint32_t side = uint32_t{1} << (level - kLeafLevel);
          for (uint32_t i = 0; i < side * side * side; ++i) {
            taker_.take_leaf(
                {corner.x + i % side * 4, corner.y + i / side % side * 4, corner.z + i / side / side * 4},
                ~uint64_t{0}, material);
          }
        });
  }

  // Calls enter_child(octant) for each child of the next node of `level`, or enter_block(material) where it is solid.
  template <class EnterChild, class EnterBlock>
  void visit(int level, const EnterChild& enter_child, const EnterBlock& enter_block) {
    unsigned mask = tree_.mask(next_node_[level]++);
    if (mask == 0) {
      enter_block(tree_.material_of_block(next_block_[level]++));
    }
    for (; mask != 0; mask &= mask - 1) {
      enter_child(static_cast<unsigned>(__builtin_ctz(mask)));
    }
  }

  const CompactTree& tree_;
  Taker& taker_;
  uint32_t next_node_[kMaxLevel + 1];
  uint32_t next_block_[kMaxLevel + 1];
  uint32_t next_voxel_;
};

/// The media of a map. Each has a numbering of cubes of its own, in which everything but the medium is solid.
struct MediaShape {
  uint8_t layers = 0;
  uint8_t materials[kMostMedia];  // the layers' materials, in order
  uint64_t words = 0;             // of their chunks
};

/// Finds which of `materials` the tree holds, as many as there may be layers.
MediaShape measure_media(const CompactTree& tree, const MapShape& shape, Span<const uint8_t> materials);

/// Writes the cubes of all layers, one layer after the other, at `top`, and their chunks from word
/// `next_word` on.
void write_media(const CompactTree& tree, const MapShape& shape, const MediaShape& media, uint32_t* top,
                 uint64_t* chunks, uint64_t next_word);

inline bool has_nodes(const CompactTree& tree) {
  return tree.many_materials() || tree.merged();
}
/// Whether chunks say where the tree keeps the materials of their voxels.
inline bool has_tags(const CompactTree& tree) {
  return tree.many_materials() && !tree.merged();
}
inline int map_level(const CompactTree& tree) {
  return std::max(tree.level(), kChunkLevel);
}

}  // namespace thimble::wide

#endif
