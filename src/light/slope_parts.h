// Reads the window of a slope off the tree, for a chip (slope.cpp) and for a host (slope_steps.cpp). Internal to src/.
#ifndef THIMBLE_SRC_LIGHT_SLOPE_PARTS_H
#define THIMBLE_SRC_LIGHT_SLOPE_PARTS_H

#include "../base/bits.h"
#include "../base/integers.h"
#include "thimble/light/host/optics.h"
#include "thimble/light/host/slope_window.h"

namespace thimble::lit {
namespace {

// A solid block; corner in voxels of the window, which the block may exceed.
inline void fill(const Vec3i& corner, int32_t side, SlopeWindow* window) {
  const int32_t from = greater(corner.x, 0);
  const unsigned bits = (1U << lesser(corner.x + side, kSlopeSide)) - (1U << from);
  for (int32_t z = greater(corner.z, 0); z < lesser(corner.z + side, kSlopeSide); ++z) {
    for (int32_t y = greater(corner.y, 0); y < lesser(corner.y + side, kSlopeSide); ++y) {
      window->rows[z][y] = static_cast<uint16_t>(window->rows[z][y] | bits);
    }
  }
}

// Octants of a node of half side `half` at `corner` (of the window) that reach into the window.
inline unsigned octants_inside(const Vec3i& corner, int32_t half) {
  constexpr uint8_t kLower[3] = {0x55, 0x33, 0x0F};
  unsigned octants = 0xFF;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t low = corner[axis];
    const bool lower = low < kSlopeSide && low + half > 0;
    const bool upper = low + half < kSlopeSide && low + 2 * half > 0;
    octants &= (lower ? kLower[axis] : 0U) | (upper ? 0xFFU & ~kLower[axis] : 0U);
  }
  return octants;
}

// The voxels of a node of level 1, which begins at an even place of the window and so lies inside.
inline void put_voxels(const CompactTree& tree, const Body& body, uint32_t index, unsigned mask,
                       const Vec3i& corner, SlopeWindow* window) {
  if (!body.holds_all()) {
    unsigned kept = 0;
    uint32_t number = tree.first_child(index);
    for (unsigned left = mask; left != 0; left &= left - 1, ++number) {
      kept |= body.holds(tree.voxel_material(number)) ? left & (0U - left) : 0U;
    }
    mask = kept;
  }
  for (int pair = 0; pair < 4; ++pair) {
    uint16_t& row = window->rows[corner.z + (pair >> 1)][corner.y + (pair & 1)];
    row = static_cast<uint16_t>(row | ((mask >> (2 * pair)) & 3U) << corner.x);
  }
}

// Reads the window off the tree: every node that reaches into it once. Levels fall with every step down, and
// an octant is taken off a list fixed on the way in, so that it ends whatever the tree holds.
inline uint32_t read_window(const CompactTree& tree, const Body& body, SlopeWindow* window) {
  struct OpenNode {
    uint32_t first_child;
    uint8_t mask;
    uint8_t left;
  } stack[kMaxLevel + 1];
  const Vec3i& low = window->low;
  uint32_t visits = 0;
  uint32_t index = 0;
  int level = tree.level();
  Vec3i place;  // of the node in the world
  for (;;) {
    if (index < tree.node_count()) {
      const uint8_t mask = tree.mask(index);
      const Vec3i corner{place.x - low.x, place.y - low.y, place.z - low.z};
      ++visits;
      if (mask == 0) {
        if (body.holds_all() || body.holds(tree.block_material(index))) {
          fill(corner, int32_t{1} << level, window);
        }
      } else if (level == 1) {
        put_voxels(tree, body, index, mask, corner, window);
      } else {
        const unsigned left = mask & octants_inside(corner, int32_t{1} << (level - 1));
        stack[level] = {tree.first_child(index), mask, static_cast<uint8_t>(left)};
        --level;
      }
    }
    // On to the next octant of the lowest node that has one left.
    do {
      ++level;
    } while (level <= tree.level() && stack[level].left == 0);
    if (level > tree.level()) {
      return visits;
    }
    OpenNode& open = stack[level];
    const unsigned octant = bits::lowest_bit(open.left);
    open.left = static_cast<uint8_t>(open.left & (open.left - 1U));
    index = open.first_child + bits::popcount8(open.mask & ((1U << octant) - 1U));
    --level;
    const int32_t side = int32_t{1} << level;
    for (int axis = 0; axis < 3; ++axis) {
      place[axis] = (place[axis] & ~(2 * side - 1)) | ((octant >> axis & 1U) != 0 ? side : 0);
    }
  }
}

}  // namespace
}  // namespace thimble::lit

#endif
