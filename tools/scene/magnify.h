/// A picture of every n-th pixel, stretched to the whole one. Integers, and nothing of a system: the page draws by it, too.
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace thimble::tools {

inline constexpr int kMostStep = 8;

/// Columns or rows of a picture of every `step`-th pixel of `size_px`.
constexpr int32_t thinned_px(int32_t size_px, int step) {
  return (size_px + step - 1) / step;
}

/// Numbers of work.
constexpr size_t magnify_work(int32_t width_px) {
  return 6 * static_cast<size_t>(width_px);
}
/// `small` holds the pixels (i * step, j * step) of a picture of that size, r, g, b each; those between get
/// straight mixtures of the four around them: here those that belong to the rows `first` .. `end` - 1 of `small`.
/// `step` 1 .. kMostStep.
void magnify_rows(const uint8_t* small, int step, int32_t width_px, int32_t height_px, int32_t first,
                  int32_t end, uint16_t* work, uint8_t* rgb);

}  // namespace thimble::tools
