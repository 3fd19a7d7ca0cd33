/// @file dense_grid.h
/// The paper's first attempt: one bit for every unit of space.
///
/// Any width x height x depth that fits the bytes given. 800 x 600 x 1 takes 60,000 bytes; 800 x 600 x 800,
/// the paper's own sum, 384,000,000 units, takes 48,000,000. Voxel (x, y, z) is bit (z * height + y) * width
/// + x, the lowest bit of a byte first; rows are not padded.
#ifndef THIMBLE_TREE_DENSE_GRID_H
#define THIMBLE_TREE_DENSE_GRID_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"

namespace thimble {

/// Bytes of a grid of that many voxels on x, y and z, each 1 .. 4096; 0 beyond that range or when size_t
/// cannot hold it.
constexpr size_t dense_grid_bytes(const Vec3i& size) {
  constexpr int32_t kMaxSide = int32_t{1} << kMaxLevel;
  if (size.x < 1 || size.y < 1 || size.z < 1 || size.x > kMaxSide || size.y > kMaxSide || size.z > kMaxSide) {
    return 0;
  }
  const uint64_t voxels =
      static_cast<uint64_t>(size.x) * static_cast<uint64_t>(size.y) * static_cast<uint64_t>(size.z);
  const uint64_t bytes = (voxels + 7) / 8;
  return bytes <= SIZE_MAX ? static_cast<size_t>(bytes) : 0;
}

/// A grid over the caller's bytes. Everything here is constant time but `make`.
class DenseGrid {
 public:
  DenseGrid() = default;

  /// Makes `grid` an empty grid of `size` in the first dense_grid_bytes(size) of `bytes`, clearing them.
  /// `kOutOfRange` for a size beyond the limits, `kOutOfMemory` when `bytes` is too small; `grid` and `bytes`
  /// are then untouched.
  static Status make(const Vec3i& size, Bytes bytes, DenseGrid* grid);
  /// The same in an arena, which gives just those bytes; after an error it is as it was.
  static Status make(const Vec3i& size, Arena& arena, DenseGrid* grid) {
    return make_in(arena, dense_grid_bytes(size), 1, [&](Bytes bytes) { return make(size, bytes, grid); });
  }

  /// Marks voxel `at` as solid or empty. `kOutOfRange` outside the grid.
  Status set(const Vec3i& at, bool solid = true);
  /// Whether voxel `at` is solid; false outside the grid.
  bool test(const Vec3i& at) const { return contains(at) && solid_at(at); }

  const Vec3i& size() const { return size_; }
  size_t used_bytes() const { return dense_grid_bytes(size_); }
  /// Solid voxels.
  uint64_t voxel_count() const { return voxel_count_; }
  /// The level of the world that the ray's limits refer to: the least whose side holds the grid.
  int level() const { return level_; }
  /// A box that holds everything solid; it does not shrink when voxels are cleared.
  const VoxelBox& bounds() const { return bounds_; }

  bool contains(const Vec3i& at) const {
    return at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < size_.x && at.y < size_.y && at.z < size_.z;
  }
  /// Whether a voxel inside the grid is solid.
  bool solid_at(const Vec3i& at) const {
    const uint64_t index = bit_index(at);
    return ((uint32_t{bits_[static_cast<size_t>(index >> 3)]} >> (index & 7U)) & 1U) != 0;
  }

 private:
  uint64_t bit_index(const Vec3i& at) const {
    const uint32_t row =
        static_cast<uint32_t>(at.z) * static_cast<uint32_t>(size_.y) + static_cast<uint32_t>(at.y);
    return static_cast<uint64_t>(row) * static_cast<uint32_t>(size_.x) + static_cast<uint32_t>(at.x);
  }

  uint8_t* bits_ = nullptr;
  Vec3i size_;
  VoxelBox bounds_;
  uint64_t voxel_count_ = 0;
  int level_ = kMinLevel;
};

}  // namespace thimble

#endif
