#include "wide/raster/workspace.h"

#include <string.h>

#include <new>

namespace thimble::wide {

bool all_covered(const Depths& depths, const Rectangle& where, uint8_t* full) {
  const int32_t first = where.x0 >> 5;
  const int32_t last = (where.x1 - 1) >> 5;
  const uint32_t head = UINT32_MAX << (where.x0 & 31);
  const uint32_t tail = UINT32_MAX >> (31 - ((where.x1 - 1) & 31));
  const auto are_full = [&](int32_t word, uint32_t wanted, int32_t y0, int32_t y1) {
    const uint32_t* at = depths.covered + depths.word(32 * word, y0);
    for (int32_t y = y0; y < y1; ++y, ++at) {
      if ((*at & wanted) != wanted) {
        return false;
      }
    }
    return true;
  };
  const int32_t y_end = where.y1 - depths.first_row;
  for (int32_t y = where.y0 - depths.first_row; y < y_end;) {
    const int32_t patch_y = y / kPatchRows;
    const int32_t next = (patch_y + 1) * kPatchRows;
    const int32_t end = next < y_end ? next : y_end;
    uint8_t* const flags = full + patch_y;
    const size_t stride = patches_of(depths.rows);
    for (int32_t word = first; word <= last; ++word) {
      uint8_t* const flag = flags + static_cast<size_t>(word) * stride;
      if (*flag != 0) {
        continue;
      }
      uint32_t wanted = UINT32_MAX;
      wanted &= word == first ? head : wanted;
      wanted &= word == last ? tail : wanted;
      if (!are_full(word, wanted, y + depths.first_row, end + depths.first_row)) {
        return false;
      }
      if (end == next &&
          are_full(word, UINT32_MAX, next - kPatchRows + depths.first_row, next + depths.first_row)) {
        *flag = 1;
      }
    }
    y = end;
  }
  return true;
}

size_t Workspace::bytes(int32_t width_px, int32_t rows, int threads) {
  return strips_of(width_px) * static_cast<size_t>(rows) * 32 * sizeof(uint64_t) +
         covered_words(width_px, rows) * sizeof(uint32_t) + strips_of(width_px) * patches_of(rows) +
         static_cast<size_t>(threads) * (sizeof(Batch) + 64) + 192;
}

Workspace::Workspace(Bytes memory, const Layout& layout)
    : strips_(strips_of(layout.width_px)), rows_(layout.rows) {
  Arena arena(memory);
  depths_ = make_depths(layout, &arena);
  full_patches_ = arena.take(strips_ * patches_of(rows_), 1).data;
  const Bytes batches = arena.take(static_cast<size_t>(layout.threads) * sizeof(Batch), alignof(Batch));
  for (int thread = 0; thread < layout.threads; ++thread) {
    new (batches.data + static_cast<size_t>(thread) * sizeof(Batch)) Batch;
  }
  batches_ = std::launder(reinterpret_cast<Batch*>(batches.data));
}

Depths Workspace::make_depths(const Layout& layout, Arena* arena) const {
  const size_t pixels = strips_ * static_cast<size_t>(rows_) * 32;
  const Bytes nearest = arena->take(pixels * sizeof(uint64_t), 64);
  Depths depths;
  depths.nearest = reinterpret_cast<uint64_t*>(nearest.data);
  depths.gray_scale = layout.gray_scale;
  depths.shading = layout.shading;
  depths.nearest_sum = reinterpret_cast<uint16_t*>(nearest.data);
  depths.gray = nearest.data + pixels * sizeof(uint16_t);
  depths.covered =
      reinterpret_cast<uint32_t*>(arena->take(covered_words(layout.width_px, rows_) * sizeof(uint32_t)).data);
  depths.marks = layout.by_blocks || layout.gray_scale == nullptr;
  // Sparse pictures do not use the marks, so their bytes hold a byte and a number for each piece, of 32 that its marks
  // would take.
  depths.is_touched = nullptr;
  depths.touched = nullptr;
  if (layout.is_sparse) {
    const size_t pieces = pixels / (32 * kPieceWords) + 1;
    depths.touched = depths.covered;
    depths.is_touched = reinterpret_cast<uint8_t*>(depths.covered + 1 + pieces);
    depths.touched[0] = 0;
    memset(depths.is_touched, 0, pieces);
  }
  depths.rows = rows_;
  depths.first_row = layout.first_row;
  return depths;
}

void Workspace::clear(int32_t first, int32_t rows) const {
  for (size_t strip = 0; strip < strips_; ++strip) {
    const size_t word = depths_.word(static_cast<int32_t>(32 * strip), depths_.first_row + first);
    if (depths_.marks) {
      memset(depths_.covered + word, 0, static_cast<size_t>(rows) * sizeof(uint32_t));
    }
    if (depths_.gray_scale != nullptr && depths_.is_touched == nullptr) {
      memset(depths_.gray + 32 * word, 0, static_cast<size_t>(rows) * 32);
    }
    memset(full_patches_ + strip * patches_of(rows_) + static_cast<size_t>(first / kPatchRows), 0,
           patches_of(rows));
  }
}

}  // namespace thimble::wide
