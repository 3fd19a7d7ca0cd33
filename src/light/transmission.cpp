// Through clear solids and media: how far a ray goes in them, and what they take from light on a straight
// way.
#include "transmission.h"
#include "arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

void begin_leg(const Frame& frame, const PendingRay& now, Leg* leg) {
  begin_way(frame, now.ray, leg);
}

void meet_clear(Frame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting) {
  meet(frame, now.kind, now.ray, leg, meeting);
}

bool light_arrives_through(Frame& frame, LightRay* light) {
  count_ray(frame, LitRayKind::kShadow);
  uint64_t* hits = &frame.counts.hits[static_cast<int>(LitRayKind::kShadow)];
  const uint64_t most = *hits + 1;
  Leg leg;
  begin_way(frame, light->ray, &leg);
  Passage passage = Passage::kOn;
  for (int legs = 0; legs < kMaxLegs && passage == Passage::kOn; ++legs) {
    Meeting meeting;
    meet(frame, LitRayKind::kShadow, light->ray, leg, &meeting);
    passage = pass(frame, light, &leg, &meeting);
  }
  // Its stretches are one ray, however many clear solids they meet.
  *hits = *hits < most ? *hits : most;
  return passage == Passage::kArrives;
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
    // Water is looked up from the beginning of a ray only: a new one starts on the face.
    now->ray.origin = meeting.at_water ? meeting.at : start_on_face(now->ray, meeting.hit);
    now->axis = meeting.hit.axis;
    leg->from = {};
  }
}

}  // namespace thimble::lit
