// The grid of bits that `walk` walks through.
#include <stdexcept>

#include "reference/reference.h"

namespace thimble::reference {

namespace {

constexpr int kCellSide = 64;
constexpr int kBrickSide = 8;

// Position within an 8 x 8 x 8 arrangement, x fastest.
std::size_t index_in_8_cubed(int x, int y, int z) {
  const int index = x + 8 * (y + 8 * z);
  return static_cast<std::size_t>(index);
}

std::size_t brick_in_cell(const Voxel& voxel) {
  return index_in_8_cubed(voxel[0] / kBrickSide % 8, voxel[1] / kBrickSide % 8, voxel[2] / kBrickSide % 8);
}

std::size_t bit_in_brick(const Voxel& voxel) {
  return index_in_8_cubed(voxel[0] % kBrickSide, voxel[1] % kBrickSide, voxel[2] % kBrickSide);
}

}  // namespace

BitGrid::BitGrid(const Voxel& size) : size_(size), cells_{} {
  std::size_t cell_count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (size[axis] < 1 || size[axis] > kMaxSide) {
      throw std::invalid_argument("reference: side of the grid out of range");
    }
    cells_[axis] = (size[axis] + kCellSide - 1) / kCellSide;
    cell_count *= static_cast<std::size_t>(cells_[axis]);
  }
  cell_of_.assign(cell_count, kNone);
}

BitGrid::BitGrid(const Voxel& size, const std::vector<Voxel>& voxels) : BitGrid(size) {
  for (const Voxel& voxel : voxels) {
    set(voxel);
  }
}

bool BitGrid::contains(const Voxel& voxel) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (voxel[axis] < 0 || voxel[axis] >= size_[axis]) {
      return false;
    }
  }
  return true;
}

std::size_t BitGrid::cell_index(const Voxel& voxel) const {
  const int x = voxel[0] / kCellSide;
  const int y = voxel[1] / kCellSide;
  const int z = voxel[2] / kCellSide;
  const int index = x + cells_[0] * (y + cells_[1] * z);
  return static_cast<std::size_t>(index);
}

void BitGrid::set(const Voxel& voxel, bool solid) {
  if (!contains(voxel)) {
    throw std::out_of_range("reference: voxel outside the grid");
  }
  if (test(voxel) == solid) {
    return;
  }
  std::int32_t& cell = cell_of_[cell_index(voxel)];
  if (cell == kNone) {
    cell = static_cast<std::int32_t>(cell_table_.size());
    cell_table_.emplace_back().fill(kNone);
  }
  std::int32_t& brick = cell_table_[static_cast<std::size_t>(cell)][brick_in_cell(voxel)];
  if (brick == kNone) {
    brick = static_cast<std::int32_t>(bricks_.size());
    bricks_.emplace_back().fill(0);
  }
  const std::size_t bit = bit_in_brick(voxel);
  bricks_[static_cast<std::size_t>(brick)][bit / 64] ^= std::uint64_t{1} << (bit % 64);
  count_ += solid ? 1 : -1;
}

bool BitGrid::test(const Voxel& voxel) const {
  return contains(voxel) && empty_log2_side(voxel) < 0;
}

int BitGrid::empty_log2_side(const Voxel& voxel) const {
  const std::int32_t cell = cell_of_[cell_index(voxel)];
  if (cell == kNone) {
    return 6;
  }
  const std::int32_t brick = cell_table_[static_cast<std::size_t>(cell)][brick_in_cell(voxel)];
  if (brick == kNone) {
    return 3;
  }
  const std::size_t bit = bit_in_brick(voxel);
  const bool solid = (bricks_[static_cast<std::size_t>(brick)][bit / 64] >> (bit % 64) & 1) != 0;
  return solid ? -1 : 0;
}

}  // namespace thimble::reference
