#include "thimble/picture/render.h"

#include "../trace/path_cache.h"
#include "band.h"

namespace thimble {
namespace {

// How the rays of a band are traced: any of them, or those that take 32 bits.
struct AnyRay {
  const TraceOptions& options;
  PathCache cache{};

  Width width() const { return options.width; }
  template <class Structure>
  Status operator()(const Structure& structure, const Ray& ray, Hit* hit) {
    return closest_hit(structure, ray, hit, options, &cache);
  }
};
struct NarrowRay {
  uint32_t max_visits;
  DirectionPath<uint32_t> cache{};

  Width width() const { return Width::k32; }
  Status operator()(const CompactTree& tree, const Ray& ray, Hit* hit) {
    return closest_hit_32(tree, ray, hit, max_visits, &cache);
  }
};

template <class Structure, class Trace>
Status draw(const Structure& structure, const Camera& camera, const Shading& shading, const Band& band,
            RenderCounts* counts, Trace&& trace) {
  size_t stride = 0;
  Status status = check_band(camera, structure.level(), band, &stride);
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  status = check_width(camera, structure.level(), trace.width());
  if (status != Status::kOk) {
    return status;
  }
  const Rgb8 background = shade(Hit{}, Ray{}, camera, shading);
  return draw_rows(camera, structure.bounds(), band, stride, background, counts,
                   [&](const Ray& ray, Hit* hit, Rgb8* color) {
                     const Status traced = trace(structure, ray, hit);
                     *color = shade(*hit, ray, camera, shading);
                     return traced;
                   });
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
