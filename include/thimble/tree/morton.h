/// @file morton.h
/// Morton codes: a voxel's three indices interleaved (x in the lowest bit of each group of three), so that
/// sorted codes are the voxels in the order of the octree's leaves; and a sort for them in place.
#ifndef THIMBLE_TREE_MORTON_H
#define THIMBLE_TREE_MORTON_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/vec.h"

namespace thimble {

/// Code of the voxel (x, y, z), each 0 .. 2^21 - 1; 3 * level bits for a voxel of a world of that level.
constexpr uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z) {
  uint64_t code = 0;
  const uint32_t part[3] = {x, y, z};
  for (int axis = 0; axis < 3; ++axis) {
    uint64_t spread = part[axis] & 0x1FFFFFU;
    spread = (spread | spread << 32) & 0x001F00000000FFFFULL;
    spread = (spread | spread << 16) & 0x001F0000FF0000FFULL;
    spread = (spread | spread << 8) & 0x100F00F00F00F00FULL;
    spread = (spread | spread << 4) & 0x10C30C30C30C30C3ULL;
    spread = (spread | spread << 2) & 0x1249249249249249ULL;
    code |= spread << axis;
  }
  return code;
}

/// The voxel of a code.
constexpr Vec3i morton_voxel(uint64_t code) {
  Vec3i voxel;
  for (int axis = 0; axis < 3; ++axis) {
    uint64_t packed = (code >> axis) & 0x1249249249249249ULL;
    packed = (packed | packed >> 2) & 0x10C30C30C30C30C3ULL;
    packed = (packed | packed >> 4) & 0x100F00F00F00F00FULL;
    packed = (packed | packed >> 8) & 0x001F0000FF0000FFULL;
    packed = (packed | packed >> 16) & 0x001F00000000FFFFULL;
    packed = (packed | packed >> 32) & 0x1FFFFFU;
    voxel[axis] = static_cast<int32_t>(packed);
  }
  return voxel;
}

/// Sorts `keys` (fewer than 2^32) in place, ascending, by their lowest `key_bits` bits (the others are
/// equal). American flag sort, the most significant 6 bits first, 512 bytes of stack, no recursion: the runs
/// of one pass are found again by their common prefix in the next. Cost: at most key_bits / 6 + 1 passes,
/// linear. Source: McIlroy, Bostic, McIlroy, "Engineering Radix Sort", Computing Systems 6(1), 1993.
void sort_keys(Span<uint32_t> keys, int key_bits);
void sort_keys(Span<uint64_t> keys, int key_bits);

/// Drops repeats from sorted keys and returns how many are left, at the front. Of 64-bit keys with a material
/// in bits 0..7 (compact_tree.h) one a voxel is kept, that with the greatest material index.
size_t unique_keys(Span<uint32_t> keys);
size_t unique_keys(Span<uint64_t> keys);

}  // namespace thimble

#endif
