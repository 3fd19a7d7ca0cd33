/// @file magnify.h
/// A picture of every n-th pixel, stretched to the whole one.
#ifndef THIMBLE_TOOLS_VIEWER_MAGNIFY_H
#define THIMBLE_TOOLS_VIEWER_MAGNIFY_H

#include <cstdint>

namespace thimble::tools::viewer {

inline constexpr int kMostStep = 8;

/// Columns or rows of a picture of every `step`-th pixel of `size_px`.
constexpr std::int32_t thinned_px(std::int32_t size_px, int step) {
  return (size_px + step - 1) / step;
}

/// `small` holds the pixels (i * step, j * step) of a picture of that size, r, g, b each; those between get
/// straight mixtures of the four around them. `step` 1 .. kMostStep.
void magnify(const std::uint8_t* small, int step, std::int32_t width_px, std::int32_t height_px,
             std::uint8_t* rgb);
/// The part of it that belongs to the rows `first` .. `end` - 1 of `small`.
void magnify_rows(const std::uint8_t* small, int step, std::int32_t width_px, std::int32_t height_px,
                  std::int32_t first, std::int32_t end, std::uint8_t* rgb);

}  // namespace thimble::tools::viewer

#endif
