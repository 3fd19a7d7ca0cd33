// What a brick map and a world that is edited share. Internal to src/.
#ifndef THIMBLE_SRC_TREE_BRICK_PARTS_H
#define THIMBLE_SRC_TREE_BRICK_PARTS_H

#include <stdint.h>

#include "thimble/tree/compact_tree.h"

namespace thimble::brick_parts {

// A mixed brick's origin: number of its first node of level 1 and, in the highest byte, its child mask; then
// the materials of voxels and of solid blocks before those of the brick.
inline constexpr uint32_t kOriginBytes = 12;
inline constexpr uint32_t kChildBits = 24;

// The 64 bits of a brick whose node of level 2 is `node`.
uint64_t bits_of_node(const CompactTree& tree, uint32_t node);
void store_origin(const CompactTree& tree, uint32_t node, uint8_t* origin);

}  // namespace thimble::brick_parts

#endif
