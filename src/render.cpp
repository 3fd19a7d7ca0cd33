#include "thimble/render.h"

#include "path_cache.h"

namespace thimble {
namespace {

// What the rays of some pixels in a row have in common: for each axis the least and greatest origin and
// direction. Both are affine in the pixel and rounded monotonically, so the two ends of the run are the
// extremes.
struct RayRange {
  Vec3i origin_low;
  Vec3i origin_high;
  Vec3i direction_low;
  Vec3i direction_high;

  RayRange(const Ray& first, const Ray& last) {
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t a = first.origin[axis].raw;
      const int32_t b = last.origin[axis].raw;
      origin_low[axis] = a < b ? a : b;
      origin_high[axis] = a < b ? b : a;
      const int32_t c = first.direction[axis];
      const int32_t d = last.direction[axis];
      direction_low[axis] = c < d ? c : d;
      direction_high[axis] = c < d ? d : c;
    }
  }
};

// Whether certainly none of the rays meets `box`: on some axis all start beyond it and none turns to it, or
// the soonest that any enters it on one axis is later than the last that any leaves it on another. Times are
// fractions of a distance (below 2^24) and a direction (below 2^20), compared by cross multiplication.
bool all_miss(const RayRange& rays, const VoxelBox& box) {
  if (box.empty()) {
    return true;
  }
  int64_t enter_num = 0;
  int64_t enter_den = 1;
  int64_t leave_num = 1;
  int64_t leave_den = 0;  // never
  for (int axis = 0; axis < 3; ++axis) {
    const int64_t low = int64_t{box.min[axis]} * Q8::kOne;
    const int64_t high = int64_t{box.max[axis]} * Q8::kOne;
    int64_t before = low - rays.origin_high[axis];   // at least so far to go, for rays that go up
    int64_t through = high - rays.origin_low[axis];  // at most so far
    int64_t slowest = rays.direction_low[axis];
    int64_t fastest = rays.direction_high[axis];
    if (fastest < 0) {  // all go down: the same, mirrored
      before = rays.origin_low[axis] - high;
      through = rays.origin_high[axis] - low;
      slowest = -int64_t{rays.direction_high[axis]};
      fastest = -int64_t{rays.direction_low[axis]};
    } else if (slowest <= 0) {  // both ways, or along: nothing is known of leaving
      const int64_t above = rays.origin_low[axis] - high;
      if (above > before) {
        before = above;
        fastest = -slowest;
      }
      slowest = 0;
    }
    if (before > 0) {
      if (fastest == 0) {
        return true;
      }
      if (before * enter_den > enter_num * fastest) {
        enter_num = before;
        enter_den = fastest;
      }
    }
    if (slowest > 0) {
      if (through <= 0) {
        return true;
      }
      if (through * leave_den < leave_num * slowest) {
        leave_num = through;
        leave_den = slowest;
      }
    }
  }
  return enter_num * leave_den >= leave_num * enter_den;
}

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

Status render_band(const CompactTree& tree, const Camera& camera, const Shading& shading, const Band& band,
                   RenderCounts* counts, const TraceOptions& options) {
  return draw(tree, camera, shading, band, counts, AnyRay{options});
}
Status render_band(const Octree& tree, const Camera& camera, const Shading& shading, const Band& band,
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
