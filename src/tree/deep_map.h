// Brick maps of worlds of level 9 and 10: a directory of two levels. Internal to src/; src/FORMAT.md gives the bytes,
// README.md the reasons.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/tree/brick_map.h"

namespace thimble {

#ifdef THIMBLE_DEEP_WORLDS
inline constexpr bool kDeepWorlds = true;
#else
inline constexpr bool kDeepWorlds = false;
#endif
inline constexpr int kMostMapLevel = kDeepWorlds ? kMaxDeepMapLevel : kMaxBrickMapLevel;

// A place in the box, in bricks: x + y * 2^8 + z * 2^16. So a step along an axis is the same number everywhere, as in
// the directories of other maps. Pages are 4 x 4 x 4 bricks.
namespace deep_place {

inline constexpr int32_t kStride[3] = {1, 1 << 8, 1 << 16};
inline constexpr int32_t kPageSide = 4;
inline constexpr int kPageLevel = 4;  // of the node that is a page
inline constexpr uint32_t kPageEntries = 64;

// Of the brick round a voxel, both counted from the box's corner.
[[gnu::always_inline]] constexpr uint32_t of_voxel(const Vec3i& voxel) {
  return static_cast<uint32_t>(voxel.x >> 2) | static_cast<uint32_t>(voxel.y >> 2) << 8 |
         static_cast<uint32_t>(voxel.z >> 2) << 16;
}
// The place's page in the table: x / 4 + y / 4 * 2^6 + z / 4 * 2^12.
[[gnu::always_inline]] constexpr uint32_t page_of(uint32_t place) {
  return (place >> 2 & 0x3FU) | (place >> 4 & 0xFC0U) | (place >> 6 & 0x3F000U);
}
// Its entry in the page: x + 4 y + 16 z of what is left.
[[gnu::always_inline]] constexpr uint32_t entry_of(uint32_t place) {
  return (place & 3U) | (place >> 6 & 12U) | (place >> 12 & 48U);
}

}  // namespace deep_place

// A page is one number, to which its entries are added: 0 is the empty brick, others are counted from 1.
inline constexpr uint32_t kPageBytes = 4 + deep_place::kPageEntries;

// What BrickMap does for these worlds.
struct DeepMap {
  static constexpr bool is_deep(int level) {
    return kDeepWorlds && level > kMaxBrickMapLevel && level <= kMaxDeepMapLevel;
  }
  // Whether the bytes begin as such a map does.
  static bool is_one(ConstBytes bytes);
  static Status open(ConstBytes bytes, BrickMap* map);
  static const char* validate(ConstBytes bytes);
  static Status make(const CompactTree& tree, Bytes out, size_t* size);
  static size_t most_bytes(const CompactTree& tree);
  // Where the materials of a mixed brick begin; null for others.
  static const uint8_t* origin(const BrickMap& map, uint32_t number);
};

}  // namespace thimble
