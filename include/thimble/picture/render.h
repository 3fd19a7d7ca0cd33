/// @file render.h
/// A band of rows of the picture into the caller's bytes.
///
/// Each pixel is a function of the tree, the camera and the shading alone. So bands of any height, drawn in
/// any order, by one core or many, give the same picture as one whole frame; a board sends a few rows at a
/// time to its display and never holds a frame.
///
/// Several samples a pixel: the picture is traced k times as wide and k times as high, and squares of k x k
/// of its pixels are averaged.
///
///     Camera fine;                                    // the same view, k * width x k * height pixels
///     for (int32_t y = 0; y < height; ++y) {
///       render_band(tree, fine, shading, {fine_rows, PixelFormat::kRgb888, 0, y * k, k});
///       average_samples(fine_rows, k, width, y, format, row);
///     }
///
/// So the samples of pixel (px, py) lie at its fixed places px + (i + 1/2) / k, py + (j + 1/2) / k, i and j
/// from 0 to k - 1: a regular grid, the same on every machine and in every frame, with the one sample at the
/// centre for k = 1. Any engine that draws bands can draw them. Memory: one band of k fine rows,
/// `samples_bytes`.
///
/// The mean is taken of the numbers that a display is sent (not of light), channel by channel, rounded to the
/// nearest, halves up. With k = 1 it is the picture itself, byte for byte.
#ifndef THIMBLE_PICTURE_RENDER_H
#define THIMBLE_PICTURE_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../trace/trace.h"
#include "camera.h"
#include "pixel.h"
#include "shading.h"

namespace thimble {

/// Where a band goes: rows first_row .. first_row + rows - 1 of the picture, the first one at the front of
/// `pixels`.
struct Band {
  Bytes pixels;
  PixelFormat format = PixelFormat::kRgb888;
  /// Bytes from one row to the next (of kMono1Pages: from one page to the next), at least row_bytes(format,
  /// width); 0 means just that. Bytes between the rows are not touched.
  size_t stride_bytes = 0;
  int32_t first_row = 0;
  int32_t rows = 0;
};

/// Bytes for `rows` rows of `width_px` pixels without gaps, the rows rounded up to what the format keeps
/// together; SIZE_MAX when size_t cannot say it.
constexpr size_t band_bytes(PixelFormat format, int32_t width_px, int32_t rows) {
  const size_t one = row_bytes(format, width_px);
  const size_t all = static_cast<size_t>(rows);
  const size_t count = has_pages(format) ? all / 8 + (all % 8 != 0 ? 1 : 0) : all;
  return one != 0 && count > SIZE_MAX / one ? SIZE_MAX : one * count;
}

/// What a renderer keeps between bands besides the tree and the band: camera, shading and counters. The stack
/// of a ray is not in it (tests/budgets/stack.csv).
struct RenderCounts {
  uint64_t rays = 0;
  uint64_t hits = 0;
  uint64_t node_visits = 0;
  uint64_t step_limited = 0;  ///< rays stopped by TraceOptions::max_visits; their pixels look like misses
};
constexpr size_t render_bytes() {
  return sizeof(Camera) + sizeof(Shading) + sizeof(RenderCounts);
}

/// Draws the band. `counts` (may be null) is added to. The camera was set up for the structure's level.
/// Errors, with nothing drawn: kBadArgument (camera without pixels or for another level, rows outside the
/// picture or no multiple of `band_row_multiple`, stride too small, Width::k32 for rays that it does not
/// take), kOutOfMemory (pixels too small).
Status render_band(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});
Status render_band(const Octree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});
Status render_band(const SharedTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});
Status render_band(const DenseGrid& grid, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});

/// Draws the band with 32-bit products only, as `closest_hit_32` traces: no code and no stack of the 64-bit
/// path. Errors: also kBadArgument for a camera with rays that it does not take (`accepts_32`).
Status render_band_32(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                      RenderCounts* counts = nullptr, uint32_t max_visits = UINT32_MAX);

/// Samples a pixel are 1, 4, 9, ... 64: the squares of 1 .. kMaxSamplesAcross.
inline constexpr int kMaxSamplesAcross = 8;
/// Bound on the difference between a channel of a mean and the exact one, in 1/256 of 1/255.
inline constexpr int kSampleMeanErrorQ8 = 128;

/// Bytes of the `across` fine rows, in kRgb888, that make one row of `width_px` pixels; SIZE_MAX when size_t
/// cannot say it.
constexpr size_t samples_bytes(int32_t width_px, int across) {
  return band_bytes(PixelFormat::kRgb888, width_px * across, across);
}

/// Averages `fine_rows` (kRgb888, samples_bytes(width_px, across), without gaps) into row `y` of the picture
/// and stores it in `row` (row_bytes(format, width_px)), which must not overlap them. Rows that share their
/// bytes (kMono1Pages) are averaged into them from the first down: it clears them. Cost: 3 * across^2
/// additions and three 32-bit divisions a pixel.
/// Errors, with nothing written: kOutOfRange (across, width_px * across beyond kMaxPicturePx), kOutOfMemory
/// (either span too small).
Status average_samples(ConstBytes fine_rows, int across, int32_t width_px, int32_t y, PixelFormat format,
                       Bytes row);

}  // namespace thimble

#endif
