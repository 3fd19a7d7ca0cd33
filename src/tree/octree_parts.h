/// What the two halves of the mutable octree, editing and coarsening, share. Not installed.
#pragma once

#include <stdint.h>

#include "thimble/base/vec.h"

namespace thimble {

/// Voxels in a block of each level: 8^level. A table, because a 32-bit chip calls a helper for 64-bit shifts.
inline constexpr uint64_t kVolume[kMaxLevel + 1] = {
    uint64_t{1} << 0,  uint64_t{1} << 3,  uint64_t{1} << 6,  uint64_t{1} << 9,  uint64_t{1} << 12,
    uint64_t{1} << 15, uint64_t{1} << 18, uint64_t{1} << 21, uint64_t{1} << 24, uint64_t{1} << 27,
    uint64_t{1} << 30, uint64_t{1} << 33, uint64_t{1} << 36};

/// Bits set in an 8-bit mask, without a library's helper.
constexpr uint32_t count_bits(uint32_t mask) {
  mask -= (mask >> 1) & 0x55;
  mask = (mask & 0x33) + ((mask >> 2) & 0x33);
  return (mask + (mask >> 4)) & 0x0F;
}

}  // namespace thimble
