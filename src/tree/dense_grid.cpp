#include "thimble/tree/dense_grid.h"

#include "compact_header.h"

namespace thimble {

Status DenseGrid::make(const Vec3i& size, Bytes bytes, DenseGrid* grid) {
  const size_t needed = dense_grid_bytes(size);
  if (needed == 0) {
    return Status::kOutOfRange;
  }
  if (needed > bytes.size) {
    return Status::kOutOfMemory;
  }
  for (size_t i = 0; i < needed; ++i) {
    bytes[i] = 0;
  }
  DenseGrid result;
  result.bits_ = bytes.data;
  result.size_ = size;
  for (int axis = 0; axis < 3; ++axis) {
    while ((int32_t{1} << result.level_) < size[axis]) {
      ++result.level_;
    }
  }
  *grid = result;
  return Status::kOk;
}

Status DenseGrid::set(const Vec3i& at, bool solid) {
  if (!contains(at)) {
    return Status::kOutOfRange;
  }
  if (solid_at(at) == solid) {
    return Status::kOk;
  }
  const uint64_t index = bit_index(at);
  uint8_t& byte = bits_[static_cast<size_t>(index >> 3)];
  byte = static_cast<uint8_t>(byte ^ 1U << (index & 7U));
  if (!solid) {
    --voxel_count_;
    return Status::kOk;
  }
  ++voxel_count_;
  grow_box(&bounds_, at, 0, 0);
  return Status::kOk;
}

}  // namespace thimble
