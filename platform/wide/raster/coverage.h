/// @file coverage.h
/// Says how a picture is laid out (Depths), and which parts of it are wholly covered.
#ifndef THIMBLE_PLATFORM_WIDE_RASTER_COVERAGE_H
#define THIMBLE_PLATFORM_WIDE_RASTER_COVERAGE_H

#include "wide/raster/kernels.h"

namespace thimble::wide {

/// How many strips of 32 columns a picture has.
inline size_t strips_of(int32_t width_px) {
  return static_cast<size_t>(width_px + 31) / 32;
}
/// Words of Depths::covered. There is one strip more than the picture has, since pixels are looked up together with
/// those to their right.
inline size_t covered_words(int32_t width_px, int32_t rows) {
  return (strips_of(width_px) + 1) * static_cast<size_t>(rows);
}

/// A patch is as wide as a strip, and so many rows high.
inline constexpr int32_t kPatchRows = 16;
inline size_t patches_of(int32_t rows) {
  return static_cast<size_t>(rows + kPatchRows - 1) / kPatchRows;
}

/// Whether all pixels of `where` are covered. `full` remembers which patches were seen full (a byte each, strip by
/// strip), so that large rectangles cost little.
bool all_covered(const Depths& depths, const Rectangle& where, uint8_t* full);

}  // namespace thimble::wide

#endif
