#include "wide/raster/coverage.h"

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

}  // namespace thimble::wide
