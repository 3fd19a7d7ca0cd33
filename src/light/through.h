// Through clear solids: what a ray meets there, and whether light arrives, for both kinds of frame. Internal to
// src/.
#ifndef THIMBLE_SRC_LIGHT_THROUGH_H
#define THIMBLE_SRC_LIGHT_THROUGH_H

#include "arithmetic.h"
#include "asking.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

/// Sorts what was entered.
[[gnu::always_inline]] inline void enter(const Frame& frame, Meeting* meeting) {
  meeting->found = true;
  meeting->opaque = !is_clear(frame, meeting->hit.material);
  meeting->beyond = {Medium::kSolid, meeting->hit.material};
}

template <class AnyFrame>
static void meet(AnyFrame& frame, LitRayKind kind, const Ray& ray, const Leg& leg, Meeting* meeting) {
  const TraceOptions options{frame.options.max_visits, Width::kAuto};
  if (leg.medium.kind == Medium::kSolid) {
    MediumExit exit;
    if (find_exit(frame, ray, leg.medium.material, leg.from, &exit, options) != Status::kOk) {
      return;
    }
    count_result(frame, kind,
                 exit.hit.kind == HitKind::kHit && !exit.into_solid ? HitKind::kMiss : exit.hit.kind,
                 exit.hit.visits);
    meeting->hit = exit.hit;
    if (exit.hit.kind != HitKind::kHit || (exit.left_world && exit.hit.axis < 0)) {
      return;
    }
    meeting->found = true;
    if (exit.into_solid) {
      enter(frame, meeting);
    }
    return;
  }
  const Status status = leg.from.t_numerator == 0 ? find_closest(frame, ray, &meeting->hit, options)
                                                  : find_from(frame, ray, leg.from, &meeting->hit, options);
  if (status != Status::kOk) {
    return;
  }
  count_result(frame, kind, meeting->hit.kind, meeting->hit.visits);
  if (meeting->hit.kind == HitKind::kHit) {
    enter(frame, meeting);
  }
}

/// What a ray begins in.
static void begin_way(const Frame& frame, const Ray& ray, Leg* leg) {
  uint8_t material = 0;
  if (material_at(frame.tree, starting_voxel(ray), &material) && is_clear(frame, material)) {
    leg->medium = {Medium::kSolid, material};
  }
}

/// A stretch of a ray to a light, the first one with what it begins in; false when what it meets is not known yet.
bool meet_on_way(AskedFrame& frame, const LightRay& light, int legs, Leg* leg, Meeting* meeting);

template <class AnyFrame>
[[gnu::always_inline]] static inline bool comes_through(AnyFrame& frame, LightRay* light) {
  Leg leg;
  if constexpr (!AnyFrame::kIsAsked) {
    begin_way(frame, light->ray, &leg);
  }
  for (int legs = 0; legs < kMaxLegs; ++legs) {
    Meeting meeting;
    if constexpr (AnyFrame::kIsAsked) {
      if (!meet_on_way(frame, *light, legs, &leg, &meeting)) {
        return false;  // nothing of the light is wanted yet
      }
    } else {
      meet(frame, LitRayKind::kShadow, light->ray, leg, &meeting);
    }
    const bool past_light =
        light->is_point && meeting.found && is_before(light->place, point_of(meeting.hit));
    if (past_light) {
      meeting.hit.t_numerator = light->place.t_numerator;
      meeting.hit.t_denominator = light->place.t_denominator;
    }
    if (leg.medium.kind == Medium::kSolid && meeting.found) {
      const Surface surface = surface_of(frame, leg.medium.material);
      const uint32_t length = stretch_q8(light->ray, leg, meeting);
      bool shines = false;
      for (int i = 0; i < 3; ++i) {
        light->brightness[i] = weighed_32(light->brightness[i], left_q16(surface, i, length));
        shines = shines || light->brightness[i] != 0;
      }
      if (!shines) {
        return false;
      }
    }
    if (past_light || !meeting.found) {
      return true;
    }
    if (meeting.opaque) {
      return spares_light(frame, *light, meeting.hit);
    }
    leg.medium = meeting.beyond;
    leg.from = point_of(meeting.hit);
  }
  return false;
}

template <class AnyFrame>
[[gnu::always_inline]] static inline bool arrives_through(AnyFrame& frame, LightRay* light) {
  count_ray(frame, LitRayKind::kShadow);
  uint64_t* hits = &frame.counts.hits[static_cast<int>(LitRayKind::kShadow)];
  const uint64_t before = *hits;
  const bool arrives = comes_through(frame, light);
  // Its stretches are one ray, however many clear solids they meet.
  *hits = *hits == before ? before : before + 1;
  return arrives;
}

}  // namespace thimble::lit

#endif
