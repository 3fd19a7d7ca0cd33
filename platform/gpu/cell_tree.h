/// @file cell_tree.h
/// A tree of cells for the GPU, made from a compact tree: a node has 4 x 4 x 4 children and a mask of 64 bits, in three
/// words (kernel/cells.inc has the layout). A ray takes fewer, wider steps down than in an octree.
///
/// It costs 1.3 times the compact tree's bytes for solid models and some five times for dust.
#ifndef THIMBLE_PLATFORM_GPU_CELL_TREE_H
#define THIMBLE_PLATFORM_GPU_CELL_TREE_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "thimble/tree/compact_tree.h"

namespace thimble::gpu {

struct CellTree {
  int levels = 1;                       ///< the world is 4^levels voxels a side
  std::vector<std::uint32_t> words;     ///< three a node, the root first
  std::vector<std::uint8_t> materials;  ///< of the voxels, where the tree has several
  std::size_t bytes() const { return 4 * words.size() + materials.size(); }
};

/// Makes it, in at most `most_bytes`. False: it would take more, the tree has merged blocks (whose corners a cell does
/// not tell), or its bytes are damaged. The empty tree has no node.
bool make_cell_tree(const CompactTree& tree, std::size_t most_bytes, CellTree* made);

}  // namespace thimble::gpu

#endif
