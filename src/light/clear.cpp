// Through clear solids and media: how far a ray goes in them, and what they take from light on a straight
// way.
#include "arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {
namespace {

// Sorts what was entered.
void enter(const Frame& frame, Meeting* meeting) {
  meeting->found = true;
  meeting->opaque = !is_clear(frame, meeting->hit.material);
  meeting->beyond = {Medium::kSolid, meeting->hit.material};
}

void meet(Frame& frame, LitRayKind kind, const Ray& ray, const Leg& leg, Meeting* meeting) {
  const TraceOptions options{frame.options.max_visits, Width::kAuto};
  if (leg.medium.kind == Medium::kSolid) {
    MediumExit exit;
    if (leave_medium(frame.tree, ray, leg.medium.material, &exit, leg.from, options) != Status::kOk) {
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
  const Status status = leg.from.t_numerator == 0
                            ? closest_hit(frame.tree, ray, &meeting->hit, options)
                            : closest_hit_from(frame.tree, ray, leg.from, &meeting->hit, options);
  if (status != Status::kOk) {
    return;
  }
  count_result(frame, kind, meeting->hit.kind, meeting->hit.visits);
  if (meeting->hit.kind == HitKind::kHit) {
    enter(frame, meeting);
  }
}

void begin(const Frame& frame, const Ray& ray, Leg* leg) {
  uint8_t material = 0;
  if (material_at(frame.tree, starting_voxel(ray), &material) && is_clear(frame, material)) {
    leg->medium = {Medium::kSolid, material};
  }
}

}  // namespace

void begin_leg(const Frame& frame, const PendingRay& now, Leg* leg) {
  begin(frame, now.ray, leg);
}

void meet_clear(Frame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting) {
  meet(frame, now.kind, now.ray, leg, meeting);
}

bool light_arrives_through(Frame& frame, LightRay* light) {
  count_ray(frame, LitRayKind::kShadow);
  Leg leg;
  begin(frame, light->ray, &leg);
  for (int legs = 0; legs < kMaxLegs; ++legs) {
    Meeting meeting;
    meet(frame, LitRayKind::kShadow, light->ray, leg, &meeting);
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

void go_straight(Frame& frame, PendingRay* now, Leg* leg, const Meeting& meeting) {
  const bool media = (leg->medium.kind == Medium::kSolid &&
                      surface_of(frame, leg->medium.material).kind == SurfaceKind::kMedia) ||
                     (meeting.beyond.kind == Medium::kSolid &&
                      surface_of(frame, meeting.beyond.material).kind == SurfaceKind::kMedia);
  leg->medium = meeting.beyond;
  leg->from = point_of(meeting.hit);
  const LitRayKind kind = media              ? LitRayKind::kMediaRay
                          : meeting.at_water ? LitRayKind::kWaterRay
                                             : LitRayKind::kGlassRay;
  count_ray(frame, kind);
  if ((frame.effects & Effect::kWater) != 0) {
    // The water is asked from the beginning of a ray only: a new one, from the face on.
    now->ray.origin = meeting.at_water ? meeting.at : start_on_face(now->ray, meeting.hit);
    now->axis = meeting.hit.axis;
    leg->from = {};
  }
}

}  // namespace thimble::lit
