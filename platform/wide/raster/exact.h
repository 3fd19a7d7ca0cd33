/// Decides in integers, by the core's rule, whether a ray hits an entry; and says how entries are packed.
#pragma once

#include <stdint.h>

namespace thimble::wide {

struct WideFrame;

/// The logarithm of an entry's side (voxel_lists.h), and its x without the bits that hold that.
inline int32_t level_of(uint32_t entry) {
  const uint32_t side = entry >> 30;
  return static_cast<int32_t>(side < 3 ? side : 3 + (entry & 7U));
}
inline uint32_t x_of(uint32_t entry) {
  return (entry >> 30) < 3 ? entry & 1023U : entry & 1016U;
}

/// The Morton code of a box of 2^level voxels a side with lowest corner `corner` (below 1024), mirrored in the axes
/// whose bits are set in `down`.
uint32_t mirrored_key(const uint32_t (&corner)[3], int32_t level, uint32_t down);

/// Mirrors a coordinate: the largest world is so many voxels long, less one.
inline constexpr uint32_t kMirror = 4095;

/// The sum of the coordinates of a voxel of the cube at `cube` (voxels), mirrored in the axes of `down`: 0 .. 3 * 4095.
inline uint32_t mirrored_sum(uint32_t entry, const uint32_t (&cube)[3], uint32_t down) {
  uint32_t sum = 0;
  for (unsigned axis = 0; axis < 3; ++axis) {
    sum += (cube[axis] | (entry >> (10 * axis) & 1023U)) ^ ((down >> axis & 1U) != 0 ? kMirror : 0U);
  }
  return sum;
}

/// The key of a cube's corner (in voxels), placed as in Depths::nearest and mirrored in the axes of `down`.
uint64_t cube_value(const uint32_t (&corner)[3], uint32_t down);

enum class Meeting : uint8_t {
  kMiss,
  kTouch,  ///< a point in common, ahead of the origin
  kHit,    ///< a positive length, at t >= 0
};

/// Decides how the ray of pixel (x, y) meets the entry of the cube at `cube` (voxels). Unless the ray misses, `down` gets
/// the axes along which it runs downwards, and `key` the entry's key mirrored in them.
Meeting meet_exactly(const WideFrame& frame, int32_t x, int32_t y, uint32_t entry, const uint32_t (&cube)[3],
                     uint32_t* key, uint32_t* down);

}  // namespace thimble::wide
