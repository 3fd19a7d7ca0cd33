#include "thimble/render.h"

namespace thimble {
namespace {

template <class Structure>
Status draw(const Structure& structure, const Camera& camera, const Shading& shading, const Band& band,
            RenderCounts* counts, const TraceOptions& options) {
  const int32_t width = camera.width_px();
  if (width == 0 || camera.level() != structure.level() || band.first_row < 0 || band.rows < 0 ||
      band.rows > camera.height_px() - band.first_row) {
    return Status::kBadArgument;
  }
  const size_t line_bytes = row_bytes(band.format, width);
  const size_t stride = band.stride_bytes == 0 ? line_bytes : band.stride_bytes;
  if (stride < line_bytes) {
    return Status::kBadArgument;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  const size_t rows_above = static_cast<size_t>(band.rows) - 1;
  if (line_bytes > band.pixels.size || rows_above > (band.pixels.size - line_bytes) / stride) {
    return Status::kOutOfMemory;
  }
  if (options.width == Width::k32) {
    // Directions are affine in the pixel, origins too: the corners are the extremes.
    for (unsigned corner = 0; corner < 4; ++corner) {
      const Ray ray =
          camera.ray((corner & 1U) != 0 ? width - 1 : 0, (corner & 2U) != 0 ? camera.height_px() - 1 : 0);
      if (!accepts_32(ray, structure.level())) {
        return Status::kBadArgument;
      }
    }
  }

  RenderCounts done;
  for (int32_t row = 0; row < band.rows; ++row) {
    const int32_t y = band.first_row + row;
    uint8_t* line = band.pixels.data + stride * static_cast<size_t>(row);
    for (size_t i = 0; i < line_bytes; ++i) {
      line[i] = 0;
    }
    RowRays rays(camera, 0, y);
    for (int32_t x = 0; x < width; ++x, rays.next()) {
      const Ray ray = rays.ray();
      Hit hit;
      if (closest_hit(structure, ray, &hit, options) != Status::kOk) {
        return Status::kBadArgument;
      }
      store_pixel(line, x, y, band.format, shade(hit, ray, camera, shading));
      done.node_visits += hit.visits;
      done.hits += hit.kind == HitKind::kHit ? 1U : 0U;
      done.step_limited += hit.kind == HitKind::kStepLimit ? 1U : 0U;
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

}  // namespace

Status render_band(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts, const TraceOptions& options) {
  return draw(tree, camera, shading, band, counts, options);
}
Status render_band(const Octree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts, const TraceOptions& options) {
  return draw(tree, camera, shading, band, counts, options);
}
Status render_band(const DenseGrid& grid, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts, const TraceOptions& options) {
  return draw(grid, camera, shading, band, counts, options);
}

}  // namespace thimble
