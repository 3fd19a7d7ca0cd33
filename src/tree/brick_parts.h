// What a brick map and a world that is edited share. Internal to src/.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "../base/bits.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::brick_parts {

// A mixed brick's origin: number of its first node of level 1 and, in the highest byte, its child mask; then
// the materials of voxels and of solid blocks before those of the brick.
inline constexpr uint32_t kOriginBytes = 12;
inline constexpr uint32_t kChildBits = 24;

constexpr size_t up8(size_t bytes) {
  return (bytes + 7) & ~size_t{7};
}

// Bits of a brick whose octants (as bits) `octant` and voxels of it `mask` are solid.
inline uint64_t spread(unsigned octant, unsigned mask) {
  uint64_t brick = 0;
  const unsigned corner = (octant & 1U) * 2 + (octant >> 1 & 1U) * 8 + (octant >> 2) * 32;
  for (unsigned bit = 0; bit < 8; ++bit) {
    if ((mask >> bit & 1U) != 0) {
      brick |= uint64_t{1} << (corner + (bit & 1U) + (bit >> 1 & 1U) * 4 + (bit >> 2) * 16);
    }
  }
  return brick;
}

// The 64 bits of a brick whose node of level 2 is `node`. Inline, as store_origin: a call costs the small boards stack.
[[gnu::always_inline]] inline uint64_t bits_of_node(const CompactTree& tree, uint32_t node) {
  const unsigned mask = tree.mask(node);
  if (mask == 0) {
    return ~uint64_t{0};
  }
  uint64_t brick = 0;
  uint32_t child = tree.first_child(node);
  for (unsigned octant = 0; octant < 8; ++octant) {
    if ((mask >> octant & 1U) != 0) {
      if (child < tree.node_count()) {
        const unsigned voxels = tree.mask(child);
        brick |= spread(octant, voxels == 0 ? 0xFFU : voxels);
      }
      ++child;
    }
  }
  return brick;
}

[[gnu::always_inline]] inline void store_origin(const CompactTree& tree, uint32_t node, uint8_t* origin) {
  const uint32_t child = tree.first_child(node);
  bits::store32(origin, child | uint32_t{tree.mask(node)} << kChildBits);
  const bool known = child < tree.node_count();
  bits::store32(origin + 4, known ? tree.first_child(child) - tree.node_count() : 0);
  bits::store32(origin + 8, known ? tree.blocks_before(child) : 0);
}

// Whether one of a brick's 64 bits, that of the voxel, is set.
inline bool has_voxel(const uint8_t* brick, const Vec3i& voxel) {
  const int bit = (voxel.x & 3) + 4 * (voxel.y & 3) + 16 * (voxel.z & 3);
  return (brick[bit >> 3] >> (bit & 7) & 1) != 0;
}

// The material of voxel `bit` of the brick whose node of level 2 is `node`.
[[gnu::always_inline]] inline uint8_t material_in_node(const CompactTree& tree, uint32_t node, unsigned bit) {
  const unsigned octant = (bit >> 1 & 1U) | (bit >> 3 & 1U) << 1 | (bit >> 5 & 1U) << 2;
  const unsigned voxel = (bit & 1U) | (bit >> 2 & 1U) << 1 | (bit >> 4 & 1U) << 2;
  if (node >= tree.node_count()) {
    return 0;
  }
  const unsigned mask = tree.mask(node);
  if (mask == 0) {
    return tree.block_material(node);
  }
  const uint32_t child = tree.first_child(node) + bits::popcount8(mask & ((1U << octant) - 1));
  if (child >= tree.node_count()) {
    return 0;
  }
  const unsigned voxels = tree.mask(child);
  if (voxels == 0) {
    return tree.block_material(child);
  }
  return tree.voxel_material(tree.first_child(child) + bits::popcount8(voxels & ((1U << voxel) - 1)));
}

// The one material of all that can be seen of a brick, 0 where nothing is; -1 for several. `node` is the brick's, `brick`
// its bits, `at` its lowest voxel as `is_solid(voxel)` counts. A voxel is seen where one of its 26 neighbours is empty: a
// ray may come through an edge or a corner between solid ones.
template <class IsSolid>
[[gnu::always_inline]] inline int material_seen(const CompactTree& tree, uint32_t node, uint64_t brick,
                                                const Vec3i& at, const IsSolid& is_solid) {
  const auto is_seen = [&](const Vec3i& voxel) {
    for (int32_t z = voxel.z - 1; z <= voxel.z + 1; ++z) {
      for (int32_t y = voxel.y - 1; y <= voxel.y + 1; ++y) {
        for (int32_t x = voxel.x - 1; x <= voxel.x + 1; ++x) {
          if (!is_solid(Vec3i{x, y, z})) {
            return true;
          }
        }
      }
    }
    return false;
  };
  int material = -1;
  for (int32_t bit = 0; bit < 64; ++bit) {
    if ((brick >> bit & 1U) != 0 && is_seen({at.x + (bit & 3), at.y + (bit >> 2 & 3), at.z + (bit >> 4)})) {
      const int own = material_in_node(tree, node, static_cast<unsigned>(bit));
      if (material >= 0 && material != own) {
        return -1;
      }
      material = own;
    }
  }
  return material < 0 ? 0 : material;
}

}  // namespace thimble::brick_parts
