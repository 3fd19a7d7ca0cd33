/// @file render.h
/// A band of rows of the picture into the caller's bytes.
///
/// Each pixel is a function of the tree, the camera and the shading alone. So bands of any height, drawn in
/// any order, by one core or many, give the same picture as one whole frame; a board sends a few rows at a
/// time to its display and never holds a frame.
#ifndef THIMBLE_RENDER_H
#define THIMBLE_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/camera.h"
#include "thimble/pixel.h"
#include "thimble/shading.h"
#include "thimble/span.h"
#include "thimble/status.h"
#include "thimble/trace.h"

namespace thimble {

/// Where a band goes: rows first_row .. first_row + rows - 1 of the picture, the first one at the front of
/// `pixels`.
struct Band {
  Bytes pixels;
  PixelFormat format = PixelFormat::kRgb888;
  /// Bytes from one row to the next, at least row_bytes(format, width); 0 means just that. Bytes between the
  /// rows are not touched.
  size_t stride_bytes = 0;
  int32_t first_row = 0;
  int32_t rows = 0;
};

/// Bytes for `rows` rows of `width_px` pixels without gaps; SIZE_MAX when size_t cannot say it.
constexpr size_t band_bytes(PixelFormat format, int32_t width_px, int32_t rows) {
  const size_t one = row_bytes(format, width_px);
  const size_t count = static_cast<size_t>(rows);
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
/// picture, stride too small, Width::k32 for rays that it does not take), kOutOfMemory (pixels too small).
Status render_band(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});
Status render_band(const Octree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});
Status render_band(const DenseGrid& grid, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts = nullptr, const TraceOptions& options = {});

/// Draws the band with 32-bit products only, as `closest_hit_32` traces: no code and no stack of the 64-bit
/// path. Errors: also kBadArgument for a camera with rays that it does not take (`accepts_32`).
Status render_band_32(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                      RenderCounts* counts = nullptr, uint32_t max_visits = UINT32_MAX);

}  // namespace thimble

#endif
