// Secondary rays of metals through the map: from a point on one to what it mirrors, and from there to the next where that
// is a metal, too. Internal to src/.
#pragma once

#include "point_lighting.h"

namespace thimble::lit {
namespace {

inline Face face_of(const FacePoint& point) {
  return {point.axis, !point.faces_up};
}
inline unsigned side_of(const FacePoint& point) {
  return 2 * static_cast<unsigned>(point.axis) + (point.faces_up ? 1U : 0U);
}

// Empty: this set has no mirrors.
template <EffectSet kSet, class Sink, bool = kMirrors<kSet>>
class MirrorRays {};

// Part of a Sink that has point_color(point, surface) without mirrors, beyond(direction) where a ray leaves the world, and
// material_of(voxel).
template <EffectSet kSet, class Sink>
class MirrorRays<kSet, Sink, true> {
 public:
  // Adds what a point of a metal shows of itself and what it mirrors to a primary ray. False: a tie, left to the tree.
  bool add_mirrored(const Frame& frame, const FacePoint& point, uint8_t material, const Vec3i& arriving,
                    Color* sum) {
    const uint32_t rays = rays_;
    const uint32_t hits = hits_;
    const bool known = show(frame, point, surface_of(frame, material), arriving, sum);
    if (!known) {
      rays_ = rays;
      hits_ = hits;
    }
    return known;
  }

  void add_mirror_counts(LitCounts* counts) const {
    counts->rays[static_cast<int>(LitRayKind::kMirrorRay)] += rays_;
    counts->hits[static_cast<int>(LitRayKind::kMirrorRay)] += hits_;
  }

 private:
  Sink& sink() { return static_cast<Sink&>(*this); }

  bool show(const Frame& frame, const FacePoint& point, const Surface& metal, const Vec3i& arriving,
            Color* sum) {
    Weight own{{kFullWeight, kFullWeight, kFullWeight}};
    Weight mirrored;
    divide_weight(metal, static_cast<int32_t>(cosine_q14(arriving, point.axis)), &own, &mirrored);
    add_own(point, metal, own, sum);
    const Vec3i direction = reflect(arriving, point.axis);
    if (metal.roughness == 0) {
      return !is_seen(mirrored) || follow(frame, point, direction, mirrored, sum);
    }
    for (uint16_t& channel : mirrored.c) {
      channel = static_cast<uint16_t>(channel / kRoughnessRays);
    }
    for (int i = 0; is_seen(mirrored) && i < kRoughnessRays; ++i) {
      const Vec3i one = facet(direction, metal, point, i);
      if (leaves_face(one, point.axis, !point.faces_up) && !follow(frame, point, one, mirrored, sum)) {
        return false;
      }
    }
    return true;
  }

  // Not inlined: what it takes of the stack is gone when the ray is followed.
  [[gnu::noinline]] static Vec3i facet(const Vec3i& mirrored, const Surface& metal, const FacePoint& point,
                                       int number) {
    return spread(mirrored, metal, point.axis, !point.faces_up, number);
  }

  // Follows a ray from metal to metal. Each metal sends at most one on, so no ray is pending.
  [[gnu::noinline]] bool follow(const Frame& frame, const FacePoint& from, Vec3i direction, Weight weight,
                                Color* sum) {
    FacePoint point = from;
    for (uint8_t bounces = 1;; ++bounces) {
      ++rays_;
      uint32_t voxel = 0;
      const int32_t answer = sink().from().go_on(direction, &voxel, &point);
      if (answer == kAsk) {
        return false;
      }
      if (answer == kMissed) {
        add(sink().beyond(direction), weight, sum);
        return true;
      }
      ++hits_;
      const Surface surface = surface_of(frame, sink().material_of(voxel));
      const bool goes_on = is_mirror(surface) && bounces < frame.scene.bounces;
      Weight mirrored;
      if (goes_on) {
        divide_weight(surface, static_cast<int32_t>(cosine_q14(direction, point.axis)), &weight, &mirrored);
      }
      add_own(point, surface, weight, sum);
      if (!is_seen(mirrored)) {
        return true;
      }
      direction = reflect(direction, point.axis);
      weight = mirrored;
    }
  }

  // Skips the metal's own light if its weight is 0.
  void add_own(const FacePoint& point, const Surface& surface, const Weight& weight, Color* sum) {
    if ((weight.c[0] | weight.c[1] | weight.c[2]) != 0) {
      add(sink().point_color(point, surface), weight, sum);
    }
  }

  uint32_t rays_ = 0;
  uint32_t hits_ = 0;
};

}  // namespace
}  // namespace thimble::lit
