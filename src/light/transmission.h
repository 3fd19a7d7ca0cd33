// Transmission by clear solids: what a ray meets in them, and whether light arrives, for both kinds of frame. Internal to
// src/.
#pragma once

#include "arithmetic.h"
#include "queries.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

/// Sorts what was entered.
[[gnu::always_inline]] inline void enter(const Frame& frame, Meeting* meeting) {
  meeting->found = true;
  meeting->opaque = !is_clear(frame, meeting->hit.material);
  meeting->beyond = {Medium::kSolid, meeting->hit.material};
}

/// The hit behind a medium that is left, or in the air.
[[gnu::always_inline]] inline void take_exit(Frame& frame, LitRayKind kind, const MediumExit& exit,
                                             Meeting* meeting) {
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
}
[[gnu::always_inline]] inline void take_hit(Frame& frame, LitRayKind kind, Meeting* meeting) {
  count_result(frame, kind, meeting->hit.kind, meeting->hit.visits);
  if (meeting->hit.kind == HitKind::kHit) {
    enter(frame, meeting);
  }
}

template <class AnyFrame>
static void meet(AnyFrame& frame, LitRayKind kind, const Ray& ray, const Leg& leg, Meeting* meeting) {
  const TraceOptions options{frame.options.max_visits, Width::kAuto};
  if (leg.medium.kind == Medium::kSolid) {
    MediumExit exit;
    if (find_exit(frame, ray, leg.medium.material, leg.from, &exit, options) != Status::kOk) {
      return;
    }
    take_exit(frame, kind, exit, meeting);
    return;
  }
  const Status status = leg.from.t_numerator == 0 ? find_closest(frame, ray, &meeting->hit, options)
                                                  : find_from(frame, ray, leg.from, &meeting->hit, options);
  if (status != Status::kOk) {
    return;
  }
  take_hit(frame, kind, meeting);
}

/// What a ray begins in.
static void begin_way(const Frame& frame, const Ray& ray, Leg* leg) {
  uint8_t material = 0;
  if (material_at(frame.tree, starting_voxel(ray), &material) && is_clear(frame, material)) {
    leg->medium = {Medium::kSolid, material};
  }
}

/// What the end of a stretch does to light.
enum class Passage : uint8_t { kBlocked, kArrives, kOn };

/// Takes from the light what the stretch absorbs, and goes to its end.
[[gnu::always_inline]] inline Passage pass(const Frame& frame, LightRay* light, Leg* leg, Meeting* meeting) {
  const bool past_light =
      light->is_point && meeting->found && is_before(light->place, point_of(meeting->hit));
  if (past_light) {
    meeting->hit.t_numerator = light->place.t_numerator;
    meeting->hit.t_denominator = light->place.t_denominator;
  }
  if (leg->medium.kind == Medium::kSolid && meeting->found) {
    const Surface surface = surface_of(frame, leg->medium.material);
    const uint32_t length = stretch_q8(light->ray, *leg, *meeting);
    bool shines = false;
    for (int i = 0; i < 3; ++i) {
      light->brightness[i] = weighed_32(light->brightness[i], left_q16(surface, i, length));
      shines = shines || light->brightness[i] != 0;
    }
    if (!shines) {
      return Passage::kBlocked;
    }
  }
  if (past_light || !meeting->found) {
    return Passage::kArrives;
  }
  if (meeting->opaque) {
    return spares_light(frame, *light, meeting->hit) ? Passage::kArrives : Passage::kBlocked;
  }
  leg->medium = meeting->beyond;
  leg->from = point_of(meeting->hit);
  return Passage::kOn;
}

}  // namespace thimble::lit
