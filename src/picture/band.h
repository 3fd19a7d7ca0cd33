// What every renderer does with a band: asks whether it can be drawn, and goes through its pixels. Internal
// to src/.
#pragma once

#include <stddef.h>

#include "ray_range.h"
#include "thimble/base/status.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"

namespace thimble {

/// Returns the errors of `render_band`; `stride` gets the bytes from row to row.
Status check_band(const Camera& camera, int level, const Band& band, size_t* stride);

/// The same for a picture of `width` x `height` pixels (0 x 0: of none), whatever it comes from.
Status check_rows(int32_t width, int32_t height, const Band& band, size_t* stride);

/// Whether rays may be traced with `width` in a world of 2^level: kBadArgument when it is k32 and that does
/// not take all rays of the camera.
Status check_width(const Camera& camera, int level, Width width);

/// Draws the rows of a band that `check_band` accepts and adds to `counts` (may be null). Pixels whose rays
/// certainly miss `bounds` are background; each other one calls `pixel(ray, &hit, &color)`, whose
/// only error is kBadArgument.
template <class Pixel>
static Status draw_rows(const Camera& camera, const VoxelBox& bounds, const Band& band, size_t stride,
                        Rgb8 background, RenderCounts* counts, Pixel&& pixel) {
  constexpr int32_t kRunPx = 32;  // pixels of a row that are tested together
  const int32_t width = camera.width_px();
  const size_t line_bytes = row_bytes(band.format, width);
  RenderCounts done;
  for (int32_t row = 0; row < band.rows; ++row) {
    const int32_t y = band.first_row + row;
    uint8_t* line = band.pixels.data + stride * row_place(band.format, row);
    for (size_t i = 0; i < line_bytes && begins_bytes(band.format, row); ++i) {
      line[i] = 0;
    }
    for (int32_t run = 0; run < width; run += kRunPx) {
      const int32_t end = run + kRunPx < width ? run + kRunPx : width;
      const bool missed = all_miss({camera.ray(run, y), camera.ray(end - 1, y)}, bounds);
      RowRays rays(camera, run, y);
      for (int32_t x = run; x < end; ++x, rays.next()) {
        if (missed) {
          store_pixel(line, x, y, band.format, background);
          continue;
        }
        Hit hit;
        Rgb8 color;
        if (pixel(rays.ray(), &hit, &color) != Status::kOk) {
          return Status::kBadArgument;
        }
        store_pixel(line, x, y, band.format, color);
        done.node_visits += hit.visits;
        done.hits += hit.kind == HitKind::kHit ? 1U : 0U;
        done.step_limited += hit.kind == HitKind::kStepLimit ? 1U : 0U;
      }
    }
    done.rays += static_cast<uint32_t>(width);
  }
  if (counts != nullptr) {
    counts->rays += done.rays;
    counts->hits += done.hits;
    counts->node_visits += done.node_visits;
    counts->step_limited += done.step_limited;
  }
  return Status::kOk;
}

}  // namespace thimble
