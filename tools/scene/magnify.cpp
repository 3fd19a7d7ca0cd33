#include "scene/magnify.h"

namespace thimble::tools {
namespace {

constexpr int32_t least(int32_t a, int32_t b) {
  return a < b ? a : b;
}

// A row at full width, each channel times `step`.
void widen(const uint8_t* row, int step, int32_t width_px, int32_t columns, uint16_t* wide) {
  for (int32_t column = 0; column < columns; ++column) {
    const uint8_t* here = row + 3 * column;
    const uint8_t* next = row + 3 * least(column + 1, columns - 1);
    const int32_t end = least(step, width_px - column * step);
    for (int32_t i = 0; i < end; ++i) {
      for (int channel = 0; channel < 3; ++channel) {
        *wide++ = static_cast<uint16_t>(here[channel] * (step - i) + next[channel] * i);
      }
    }
  }
}

// A row between two widened ones, `j` of `step` rows below the upper. Everything fits 16 bits: a channel times
// 64, and the high half of a product, which vectors have an instruction for.
void mix(const uint16_t* above, const uint16_t* below, int step, int j, size_t count, uint8_t* to) {
  const auto far = static_cast<uint16_t>(j);
  const auto near = static_cast<uint16_t>(step - j);
  const auto area = static_cast<uint16_t>(step * step);
  const auto half = static_cast<uint16_t>(area / 2);
  // Off by at most 1/2048 of itself, which with `half` never reaches the next whole number.
  const auto share = static_cast<uint16_t>((65536 + area / 2) / area);
  for (size_t i = 0; i < count; ++i) {
    const auto sum = static_cast<uint16_t>(above[i] * near + below[i] * far + half);
    to[i] = static_cast<uint8_t>((static_cast<uint32_t>(sum) * share) >> 16);
  }
}

}  // namespace

void magnify_rows(const uint8_t* small, int step, int32_t width_px, int32_t height_px, int32_t first,
                  int32_t end, uint16_t* work, uint8_t* rgb) {
  const size_t row_bytes = 3 * static_cast<size_t>(width_px);
  if (step == 1) {
    const size_t before = row_bytes * static_cast<size_t>(first);
    __builtin_memcpy(rgb + before, small + before, row_bytes * static_cast<size_t>(end - first));
    return;
  }
  const int32_t columns = thinned_px(width_px, step);
  const int32_t rows = thinned_px(height_px, step);
  const auto widen_row = [&](int32_t row, uint16_t* wide) {
    widen(small + 3 * static_cast<size_t>(columns) * static_cast<size_t>(least(row, rows - 1)), step,
          width_px, columns, wide);
  };
  uint16_t* above = work + row_bytes;
  uint16_t* below = work;
  widen_row(first, below);
  for (int32_t row = first; row < end; ++row) {
    uint16_t* const upper = below;
    below = above;
    above = upper;
    widen_row(row + 1, below);
    const int32_t lines = least(step, height_px - row * step);
    for (int32_t j = 0; j < lines; ++j) {
      mix(above, below, step, j, row_bytes, rgb + row_bytes * static_cast<size_t>(row * step + j));
    }
  }
}

}  // namespace thimble::tools
