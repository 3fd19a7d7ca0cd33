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

}  // namespace

void magnify(const std::uint8_t* small, int step, std::int32_t width_px, std::int32_t height_px,
             std::uint8_t* rgb) {
  const auto row_bytes = 3 * static_cast<std::size_t>(width_px);
  if (step == 1) {
    std::memcpy(rgb, small, row_bytes * static_cast<std::size_t>(height_px));
    return;
  }
  const std::int32_t columns = thinned_px(width_px, step);
  const std::int32_t rows = thinned_px(height_px, step);
  const auto small_row = [&](std::int32_t row) {
    return small + 3 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(std::min(row, rows - 1));
  };
  std::vector<std::uint16_t> above(row_bytes);
  std::vector<std::uint16_t> below(row_bytes);
  widen(small_row(0), step, width_px, columns, below.data());
  const auto area = static_cast<std::uint32_t>(step * step);
  const std::uint32_t share = (65536 + area / 2) / area;  // off by less than half a step of a channel
  for (std::int32_t row = 0; row < rows; ++row) {
    above.swap(below);
    widen(small_row(row + 1), step, width_px, columns, below.data());
    const std::int32_t end = std::min(step, height_px - row * step);
    for (std::int32_t j = 0; j < end; ++j) {
      std::uint8_t* to = rgb + row_bytes * static_cast<std::size_t>(row * step + j);
      const auto far = static_cast<std::uint32_t>(j);
      const auto near = static_cast<std::uint32_t>(step - j);
      for (std::size_t i = 0; i < row_bytes; ++i) {
        to[i] = static_cast<std::uint8_t>(
            std::min<std::uint32_t>(((above[i] * near + below[i] * far) * share + 32768) >> 16, 255));
      }
    }
  }
}

}  // namespace thimble::tools::viewer
