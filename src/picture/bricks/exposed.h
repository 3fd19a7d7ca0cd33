// Finds the faces of a brick by which rays can enter, turned so that all rays go up on its axes a, b and c.
// Internal to src/.
#pragma once

#include "course.h"

namespace thimble::bricks {
namespace {

// The 64 voxels of a brick; bit a + 4 b + 16 c once they are turned.
struct Cells {
  uint32_t low;
  uint32_t high;
};

// The voxels of a brick whose neighbour towards the eye is empty on axis a, on b, on c, slab by slab.
struct Exposed {
  static constexpr int kSlabs = 4;
  int32_t place;  // the brick's offset in the directory, or -1
  alignas(4) Half on[3 * kSlabs];
};

// Puts the voxels of a brick slab by slab along c; `slabs` is aligned as a word.
[[gnu::always_inline]] inline void put_slabs(const Cells& cells, Half* slabs) {
  Word* const words = static_cast<Word*>(static_cast<void*>(slabs));
  words[0] = bits::kBigEndian ? cells.low << 16 | cells.low >> 16 : cells.low;
  words[1] = bits::kBigEndian ? cells.high << 16 | cells.high >> 16 : cells.high;
}

// Swaps the bits of `word` under `mask` with those `shift` above them.
constexpr uint32_t swap_bits(uint32_t word, int shift, uint32_t mask) {
  return (word >> shift & mask) | (word & mask) << shift;
}
// The same, but keeps the bits that neither mask takes.
constexpr uint32_t exchange(uint32_t word, int shift, uint32_t mask) {
  const uint32_t differ = (word ^ word >> shift) & mask;
  return word ^ differ ^ differ << shift;
}

Cells mirrored_cells(Cells cells, unsigned mirrored) {
  if ((mirrored & 1U) != 0) {
    cells.low = swap_bits(swap_bits(cells.low, 2, 0x33333333U), 1, 0x55555555U);
    cells.high = swap_bits(swap_bits(cells.high, 2, 0x33333333U), 1, 0x55555555U);
  }
  if ((mirrored & 2U) != 0) {
    cells.low = swap_bits(swap_bits(cells.low, 8, 0x00FF00FFU), 4, 0x0F0F0F0FU);
    cells.high = swap_bits(swap_bits(cells.high, 8, 0x00FF00FFU), 4, 0x0F0F0F0FU);
  }
  if ((mirrored & 4U) != 0) {
    const uint32_t low = cells.low;
    cells.low = cells.high >> 16 | cells.high << 16;
    cells.high = low >> 16 | low << 16;
  }
  return cells;
}

// Turns x + 4 y + 16 z into a + 4 b + 16 c, mirrored.
Cells turned(Cells cells, unsigned mirrored, int c) {
  if ((cells.low | cells.high) == 0) {
    return cells;
  }
  cells = mirrored_cells(cells, mirrored);
  if (c == 2) {
    return cells;
  }
  if (c == 0) {  // x and y change places
    cells.low = exchange(exchange(cells.low, 3, 0x0A0A0A0AU), 6, 0x00CC00CCU);
    cells.high = exchange(exchange(cells.high, 3, 0x0A0A0A0AU), 6, 0x00CC00CCU);
  }
  // The two upper coordinates change places: nibbles of a row with those of a column.
  cells.low = exchange(cells.low, 12, 0x0000F0F0U);
  cells.high = exchange(cells.high, 12, 0x0000F0F0U);
  const uint32_t differ = (cells.low >> 8 ^ cells.high) & 0x00FF00FFU;
  cells.low ^= differ << 8;
  cells.high ^= differ;
  return cells;
}

template <bool kDeep>
Cells cells_of(const Course& course, int32_t place) {
  const int32_t brick = 8 * static_cast<int32_t>(number_at<kDeep>(course.directory, place));
  return {word_at(course.bricks, brick), word_at(course.bricks, brick + 4)};
}

// The voxels of `own` that have no voxel in front of them on `axis`, in their own brick or in the one before.
Cells uncovered_on(int axis, bool mirrored, const Cells& own, const Cells& before) {
  if (axis == 2) {
    return mirrored ? Cells{own.low & ~(own.low >> 16 | own.high << 16),
                            own.high & ~(own.high >> 16 | before.low << 16)}
                    : Cells{own.low & ~(own.low << 16 | before.high >> 16),
                            own.high & ~(own.high << 16 | own.low >> 16)};
  }
  const int shift = axis == 0 ? 1 : 4;
  const uint32_t first = axis == 0 ? 0x11111111U : 0x000F000FU;
  const uint32_t last = first << 3 * shift;
  if (mirrored) {
    return {own.low & ~((own.low >> shift & ~last) | (before.low << 3 * shift & last)),
            own.high & ~((own.high >> shift & ~last) | (before.high << 3 * shift & last))};
  }
  return {own.low & ~((own.low << shift & ~first) | (before.low >> 3 * shift & first)),
          own.high & ~((own.high << shift & ~first) | (before.high >> 3 * shift & first))};
}

// Finds the exposed faces of the brick at `place` in the directory, the box's brick number `bricks` along a, b and c.
template <bool kDeep>
[[gnu::noinline, THIMBLE_HOT]] void find_exposed(const Course& course, int32_t place,
                                                 const int32_t (&bricks)[3], Exposed* exposed) {
  const Cells own = cells_of<kDeep>(course, place);
  exposed->place = place;
  for (int k = 0; k < 3; ++k) {
    const int axis = course.axis[k];
    const bool flipped = (course.mirrored >> axis & 1U) != 0;
    const Cells before = bricks[k] > 0 ? cells_of<kDeep>(course, place - course.stride[axis]) : Cells{0, 0};
    put_slabs(turned(uncovered_on(axis, flipped, own, before), course.mirrored, course.c),
              &exposed->on[Exposed::kSlabs * k]);
  }
}

}  // namespace
}  // namespace thimble::bricks
