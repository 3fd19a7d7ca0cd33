#include "thimble/picture/render.h"

#include "../trace/path_cache.h"
#include "band.h"
#include "ray_range.h"

namespace thimble {
namespace {

// Pixels of a row that are tested together.
constexpr int32_t kRunPx = 32;

// How the rays of a band are traced: any of them, or those that take 32 bits.
struct AnyRay {
  const TraceOptions& options;
  PathCache cache{};

  bool only_32() const { return options.width == Width::k32; }
  template <class Structure>
  Status operator()(const Structure& structure, const Ray& ray, Hit* hit) {
    return closest_hit(structure, ray, hit, options, &cache);
  }
};
struct NarrowRay {
  uint32_t max_visits;
  DirectionPath<uint32_t> cache{};

  bool only_32() const { return true; }
  Status operator()(const CompactTree& tree, const Ray& ray, Hit* hit) {
    return closest_hit_32(tree, ray, hit, max_visits, &cache);
  }
};

template <class Structure, class Trace>
Status draw(const Structure& structure, const Camera& camera, const Shading& shading, const Band& band,
            RenderCounts* counts, Trace&& trace) {
  size_t stride = 0;
  const Status status = check_band(camera, structure.level(), band, &stride);
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  const int32_t width = camera.width_px();
  const size_t line_bytes = row_bytes(band.format, width);
  if (trace.only_32()) {
    // Directions are affine in the pixel, origins too: the corners are the extremes.
    for (unsigned corner = 0; corner < 4; ++corner) {
      const Ray ray =
          camera.ray((corner & 1U) != 0 ? width - 1 : 0, (corner & 2U) != 0 ? camera.height_px() - 1 : 0);
      if (!accepts_32(ray, structure.level())) {
        return Status::kBadArgument;
      }
    }
  }

  const Rgb8 background = shade(Hit{}, Ray{}, camera, shading);
  RenderCounts done;
  for (int32_t row = 0; row < band.rows; ++row) {
    const int32_t y = band.first_row + row;
    uint8_t* line = band.pixels.data + stride * static_cast<size_t>(row);
    for (size_t i = 0; i < line_bytes; ++i) {
      line[i] = 0;
    }
    for (int32_t run = 0; run < width; run += kRunPx) {
      const int32_t end = run + kRunPx < width ? run + kRunPx : width;
      const bool missed = all_miss({camera.ray(run, y), camera.ray(end - 1, y)}, structure.bounds());
      RowRays rays(camera, run, y);
      for (int32_t x = run; x < end; ++x, rays.next()) {
        if (missed) {
          store_pixel(line, x, y, band.format, background);
          continue;
        }
        const Ray ray = rays.ray();
        Hit hit;
        if (trace(structure, ray, &hit) != Status::kOk) {
          return Status::kBadArgument;
        }
        store_pixel(line, x, y, band.format, shade(hit, ray, camera, shading));
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

}  // namespace

Status check_band(const Camera& camera, int level, const Band& band, size_t* stride) {
  const int32_t width = camera.width_px();
  if (width == 0 || camera.level() != level || band.first_row < 0 || band.rows < 0 ||
      band.rows > camera.height_px() - band.first_row) {
    return Status::kBadArgument;
  }
  const size_t line_bytes = row_bytes(band.format, width);
  *stride = band.stride_bytes == 0 ? line_bytes : band.stride_bytes;
  if (*stride < line_bytes) {
    return Status::kBadArgument;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  const size_t rows_above = static_cast<size_t>(band.rows) - 1;
  if (line_bytes > band.pixels.size || rows_above > (band.pixels.size - line_bytes) / *stride) {
    return Status::kOutOfMemory;
  }
  return Status::kOk;
}

Status render_band(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts, const TraceOptions& options) {
  return draw(tree, camera, shading, band, counts, AnyRay{options});
}
Status render_band(const Octree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts, const TraceOptions& options) {
  return draw(tree, camera, shading, band, counts, AnyRay{options});
}
Status render_band(const SharedTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts, const TraceOptions& options) {
  return draw(tree, camera, shading, band, counts, AnyRay{options});
}
Status render_band(const DenseGrid& grid, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts, const TraceOptions& options) {
  return draw(grid, camera, shading, band, counts, AnyRay{options});
}

Status render_band_32(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                      RenderCounts* counts, uint32_t max_visits) {
  return draw(tree, camera, shading, band, counts, NarrowRay{max_visits});
}

}  // namespace thimble
