// Lit pictures with deferred queries: the loop of detail/pixel.h, instantiated with an AskedFrame. As many of them as in
// dispatch.cpp.
#include "thimble/light/host/asked.h"

#include "dispatch.h"
#include "transmission.h"

namespace thimble::lit {
namespace {

template <EffectSet kSet>
void follow_asked(AskedFrame& frame, const PendingRay& now, PendingRay* pending, size_t* count, Color* sum) {
  follow<kSet>(frame, now, pending, count, sum);
}

template <EffectSet kSet>
void shine(AskedFrame& frame, Color* sum) {
  KnownRay& ray = *frame.ray;
  const Color color = face_color<kSet>(frame, ray.spot, ray.slope);
  ray.has_lights = true;
  add(color, ray.weight, sum);
}

// With or without each of the effects that are left to choose.
template <EffectSet kChosen, EffectSet kEffect, EffectSet... kLeft>
Steps choose(EffectSet effects) {
  constexpr EffectSet kWith = kChosen | kEffect;
  if constexpr (sizeof...(kLeft) == 0) {
    return (effects & kEffect) != 0 ? Steps{follow_asked<kWith>, shine<kWith>}
                                    : Steps{follow_asked<kChosen>, shine<kChosen>};
  } else {
    return (effects & kEffect) != 0 ? choose<kWith, kLeft...>(effects) : choose<kChosen, kLeft...>(effects);
  }
}

}  // namespace

void meet_solid(AskedFrame& frame, const PendingRay& now, Meeting* meeting) {
  if (find_closest(frame, now.ray, &meeting->hit, {}) == Status::kOk) {
    count_result(frame, now.kind, meeting->hit.kind, meeting->hit.visits);
    meeting->found = meeting->hit.kind == HitKind::kHit;
    meeting->opaque = meeting->found;
  }
}

void meet_clear(AskedFrame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting) {
  meet(frame, now.kind, now.ray, leg, meeting);
}

namespace {

// Asks for the next stretch, in the place of the last one.
void ask_on(AskedFrame& frame, const LightRay& light, const Leg& leg) {
  if (leg.medium.kind == Medium::kSolid) {
    frame.note(Question::kOn, light.ray, leg.from, leg.medium.material);
  } else if (leg.from.t_numerator != 0) {
    frame.note(Question::kOn, light.ray, leg.from);
  } else if (light.is_point) {
    // What is met at the light itself counts, what is behind it does not.
    frame.note(Question::kBefore, light.ray, {light.place.t_numerator + 1, light.place.t_denominator});
  } else {
    frame.note(Question::kClosest, light.ray, {});
  }
}

// The stretch whose answer is there.
void take_stretch(AskedFrame& frame, const Answer& answer, LightRay* light) {
  LightWay& way = *frame.way;
  Meeting meeting;
  uint64_t* hits = &frame.once->counts.hits[static_cast<int>(LitRayKind::kShadow)];
  const uint64_t before = *hits;
  if (way.leg.medium.kind == Medium::kSolid) {
    take_exit(*frame.once, LitRayKind::kShadow, answer, &meeting);
  } else {
    meeting.hit = answer.hit;
    take_hit(*frame.once, LitRayKind::kShadow, &meeting);
  }
  // The stretches are one ray, however many clear solids they meet.
  if (*hits != before) {
    *hits = way.has_met ? before : before + 1;
    way.has_met = true;
  }
  const Passage passage = pass(frame, light, &way.leg, &meeting);
  const bool is_last = ++way.legs == kMaxLegs;
  way.state = passage == Passage::kArrives              ? LightWay::kArrived
              : passage == Passage::kBlocked || is_last ? LightWay::kBlocked
                                                        : LightWay::kUnderWay;
}

}  // namespace

// Each call takes one stretch of the way, whose answer takes the place of the last one's.
bool light_arrives_through(AskedFrame& frame, LightRay* light) {
  count_ray(frame, LitRayKind::kShadow);
  const Answer* answer = frame.look();
  LightWay& way = *frame.way;
  const bool is_new = way.state == LightWay::kNew;
  if (is_new) {
    begin_way(frame, light->ray, &way.leg);
    way.state = LightWay::kUnderWay;
  } else {
    for (int i = 0; i < 3; ++i) {
      light->brightness[i] = way.brightness[i];
    }
    if (way.state == LightWay::kUnderWay) {
      take_stretch(frame, *answer, light);
    }
  }
  for (int i = 0; i < 3; ++i) {
    way.brightness[i] = light->brightness[i];
  }
  if (way.state == LightWay::kUnderWay) {
    frame.waits = true;
    ask_on(frame, *light, way.leg);
  }
  return way.state == LightWay::kArrived;
}

void begin_leg(AskedFrame& frame, const PendingRay& now, Leg* leg) {
  KnownRay& ray = *frame.ray;
  if (!ray.has_begun) {
    begin_way(frame, now.ray, leg);
    ray.begins_in = leg->medium;
    ray.has_begun = true;
  }
  leg->medium = ray.begins_in;
}

bool light_ray_of(AskedFrame& frame, size_t number, const Spot& spot, const Slope& slope, LightRay* ray) {
  KnownLight& known = frame.lights[number];
  frame.way = &known.way;
  if (!frame.ray->has_lights) {
    known.way = {};
    known.shines = light_ray(frame.scene.lights[number], spot, slope, &known.ray);
  }
  *ray = known.ray;
  return known.shines;
}

Steps steps_of(EffectSet effects) {
  return choose<kAlwaysCompiled, Effect::kWater, Effect::kGlass | Effect::kMedia, Effect::kMirror,
                Effect::kShadows, Effect::kAmbientOcclusion>(effects);
}

}  // namespace thimble::lit
