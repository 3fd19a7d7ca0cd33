// Tracing many rays: what rays of one direction have in common is worked out once. Internal to src/.
#ifndef THIMBLE_SRC_PATH_CACHE_H
#define THIMBLE_SRC_PATH_CACHE_H

#include <stdint.h>

#include "crossings.h"
#include "thimble/trace.h"

namespace thimble {

// The path of the last direction traced, in the width it was traced with; for one structure's rays only. An
// orthographic frame sets it up once, a perspective one for every ray.
class PathCache {
 public:
  const NodePath<uint32_t>& path(const MirroredRay& ray, int level, uint32_t) {
    if (!holds(ray, 32)) {
      narrow_ = NodePath<uint32_t>(ray, level);
    }
    return narrow_;
  }
  const NodePath<uint64_t>& path(const MirroredRay& ray, int level, uint64_t) {
    if (!holds(ray, 64)) {
      wide_ = NodePath<uint64_t>(ray, level);
    }
    return wide_;
  }

 private:
  // Whether the path is the one of `ray` at that width; it is from now on.
  bool holds(const MirroredRay& ray, uint8_t width) {
    const bool held = width_ == width && direction_ == ray.direction && flip_ == ray.flip;
    width_ = width;
    direction_ = ray.direction;
    flip_ = ray.flip;
    return held;
  }

  Vec3i direction_;
  unsigned flip_ = 0;
  uint8_t width_ = 0;  // 0: nothing is held
  union {
    NodePath<uint32_t> narrow_;
    NodePath<uint64_t> wide_;
  };

 public:
  PathCache() {}
};

// As the public functions (trace.h), with a cache that stays with the structure.
Status closest_hit(const CompactTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache);
Status closest_hit(const Octree& tree, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache);
Status closest_hit(const DenseGrid& grid, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache);

}  // namespace thimble

#endif
