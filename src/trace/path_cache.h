// Tracing many rays: what rays of one direction have in common is worked out once. Internal to src/.
#pragma once

#include <stdint.h>

#include "crossings.h"
#include "thimble/trace/ray.h"

namespace thimble {

// The path of the last direction traced, in one width and for one structure's rays only. An orthographic
// frame sets it up once, a perspective one for every ray.
template <class Unsigned>
class DirectionPath {
 public:
  const NodePath<Unsigned>& path(const MirroredRay& ray, int level) {
    if (!held_ || !(direction_ == ray.direction) || flip_ != ray.flip) {
      held_ = true;
      direction_ = ray.direction;
      flip_ = ray.flip;
      path_ = NodePath<Unsigned>(ray, level);
    }
    return path_;
  }
  void forget() { held_ = false; }

 private:
  Vec3i direction_;
  unsigned flip_ = 0;
  bool held_ = false;
  NodePath<Unsigned> path_;
};

// The same for rays of either width, in the same bytes.
class PathCache {
 public:
  DirectionPath<uint32_t>* of(uint32_t) {
    turn_to(32);
    return &narrow_;
  }
  DirectionPath<uint64_t>* of(uint64_t) {
    turn_to(64);
    return &wide_;
  }

 private:
  void turn_to(uint8_t width) {
    if (width_ != width) {
      width_ = width;
      if (width == 32) {
        narrow_.forget();
      } else {
        wide_.forget();
      }
    }
  }

  uint8_t width_ = 0;  // 0: nothing is held
  union {
    DirectionPath<uint32_t> narrow_;
    DirectionPath<uint64_t> wide_;
  };

 public:
  PathCache() {}
};

// As the public functions (ray.h), with a cache that stays with the structure. trace.cpp has it for each kind of these.
template <class Structure>
Status closest_hit(const Structure& structure, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache);

// As closest_hit_32, with the path of the last direction.
Status closest_hit_32(const CompactTree& tree, const Ray& ray, Hit* hit, uint32_t max_visits,
                      DirectionPath<uint32_t>* cache);

}  // namespace thimble
