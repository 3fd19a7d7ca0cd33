#include "viewer/magnify.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <vector>

namespace thimble::tools::viewer {
namespace {

// A row at full width, each channel times `step`.
void widen(const std::uint8_t* row, int step, std::int32_t width_px, std::int32_t columns,
           std::uint16_t* wide) {
  for (std::int32_t column = 0; column < columns; ++column) {
    const std::uint8_t* here = row + 3 * column;
    const std::uint8_t* next = row + 3 * std::min(column + 1, columns - 1);
    const std::int32_t end = std::min(step, width_px - column * step);
    for (std::int32_t i = 0; i < end; ++i) {
      for (int channel = 0; channel < 3; ++channel) {
        *wide++ = static_cast<std::uint16_t>(here[channel] * (step - i) + next[channel] * i);
      }
    }
  }
}

// A row between two widened ones, `j` of `step` rows below the upper. Everything fits 16 bits: a channel times
// 64, and the high half of a product, which vectors have an instruction for.
void mix(const std::uint16_t* above, const std::uint16_t* below, int step, int j, std::size_t count,
         std::uint8_t* to) {
  const auto far = static_cast<std::uint16_t>(j);
  const auto near = static_cast<std::uint16_t>(step - j);
  const auto area = static_cast<std::uint16_t>(step * step);
  const auto half = static_cast<std::uint16_t>(area / 2);
  // Off by at most 1/2048 of itself, which with `half` never reaches the next whole number.
  const auto share = static_cast<std::uint16_t>((65536 + area / 2) / area);
  for (std::size_t i = 0; i < count; ++i) {
    const auto sum = static_cast<std::uint16_t>(above[i] * near + below[i] * far + half);
    to[i] = static_cast<std::uint8_t>((static_cast<std::uint32_t>(sum) * share) >> 16);
  }
}

}  // namespace

void magnify_rows(const std::uint8_t* small, int step, std::int32_t width_px, std::int32_t height_px,
                  std::int32_t first, std::int32_t end, std::uint8_t* rgb) {
  const auto row_bytes = 3 * static_cast<std::size_t>(width_px);
  if (step == 1) {
    const std::size_t from = row_bytes * static_cast<std::size_t>(first);
    std::memcpy(rgb + from, small + from, row_bytes * static_cast<std::size_t>(end - first));
    return;
  }
  const std::int32_t columns = thinned_px(width_px, step);
  const std::int32_t rows = thinned_px(height_px, step);
  const auto small_row = [&](std::int32_t row) {
    return small + 3 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(std::min(row, rows - 1));
  };
  std::vector<std::uint16_t> above(row_bytes);
  std::vector<std::uint16_t> below(row_bytes);
  widen(small_row(first), step, width_px, columns, below.data());
  for (std::int32_t row = first; row < end; ++row) {
    above.swap(below);
    widen(small_row(row + 1), step, width_px, columns, below.data());
    const std::int32_t lines = std::min(step, height_px - row * step);
    for (std::int32_t j = 0; j < lines; ++j) {
      mix(above.data(), below.data(), step, j, row_bytes,
          rgb + row_bytes * static_cast<std::size_t>(row * step + j));
    }
  }
}

void magnify(const std::uint8_t* small, int step, std::int32_t width_px, std::int32_t height_px,
             std::uint8_t* rgb) {
  magnify_rows(small, step, width_px, height_px, 0, thinned_px(height_px, step), rgb);
}

}  // namespace thimble::tools::viewer
