// Lit pictures whose rays somebody else traces: the loop of detail/pixel.h, compiled with a frame that is told the
// answers. As many of them as in dispatch.cpp.
#include "thimble/light/asked.h"

#include "folded.h"
#include "through.h"

namespace thimble::lit {
namespace {

template <EffectSet kSet>
void follow_asked(AskedFrame& frame, const PendingRay& now, PendingRay* pending, size_t* count, Color* sum) {
  follow<kSet>(frame, now, pending, count, sum);
}

template <EffectSet kSet>
void shine(AskedFrame& frame, Color* sum) {
  const KnownRay& ray = *frame.ray;
  const Color color =
      ray.has_slope ? slope_color<kSet>(frame, ray.spot, ray.slope) : face_color<kSet>(frame, ray.spot);
  frame.ray->has_lights = true;
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

// The first stretch is asked about, unless it begins in something clear, which is kept with the answer. Later ones
// are asked of the tree at once, when that answer is there.
bool meet_on_way(AskedFrame& frame, const LightRay& light, int legs, Leg* leg, Meeting* meeting) {
  const Answer* answer = legs == 0 ? frame.look() : nullptr;
  if (legs == 0 && answer == nullptr) {
    begin_way(frame, light.ray, leg);
    if (leg->medium.kind != Medium::kSolid) {
      // What is met at the light itself counts, what is behind it does not.
      frame.note(light.is_point ? Question::kBefore : Question::kClosest, light.ray,
                 {light.place.t_numerator + 1, light.place.t_denominator});
      return false;
    }
    Answer& kept = frame.answers[frame.asked - 1];
    kept = Answer{};
    kept.into_solid = true;
    kept.hit.material = leg->medium.material;
    return false;
  }
  if (legs == 0 && answer->into_solid) {
    leg->medium = {Medium::kSolid, answer->hit.material};
  }
  if (legs != 0 || answer->into_solid) {
    meet(static_cast<Frame&>(frame), LitRayKind::kShadow, light.ray, *leg, meeting);
    return true;
  }
  meeting->hit = answer->hit;
  count_result(frame, LitRayKind::kShadow, meeting->hit.kind, meeting->hit.visits);
  if (meeting->hit.kind == HitKind::kHit) {
    enter(frame, meeting);
  }
  return true;
}

bool light_arrives_through(AskedFrame& frame, LightRay* light) {
  return arrives_through(frame, light);
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

bool light_ray_of(AskedFrame& frame, size_t number, const Spot& spot, LightRay* ray) {
  if (!frame.scene.lights[number].is_point) {
    const int face = 2 * spot.face.axis + (spot.face.negative ? 0 : 1);
    KnownLight& sun = frame.suns[6 * number + static_cast<size_t>(face)];
    if (!sun.is_known) {
      sun.shines = light_ray(frame.scene.lights[number], spot, &sun.ray);
      sun.is_known = true;
    }
    *ray = sun.ray;
    ray->ray.origin = spot.at;
    return sun.shines;
  }
  KnownLight& known = frame.lights[number];
  if (!frame.ray->has_lights) {
    known.shines = light_ray(frame.scene.lights[number], spot, &known.ray);
  }
  *ray = known.ray;
  return known.shines;
}
bool light_ray_of(AskedFrame& frame, size_t number, const Spot& spot, const Slope& slope, LightRay* ray) {
  KnownLight& known = frame.lights[number];
  if (!frame.ray->has_lights) {
    known.shines = light_ray(frame.scene.lights[number], spot, slope, &known.ray);
  }
  *ray = known.ray;
  return known.shines;
}

Steps steps_of(EffectSet effects) {
  return choose<kFolded, Effect::kWater, Effect::kGlass | Effect::kMedia, Effect::kMirror, Effect::kShadows,
                Effect::kAmbientOcclusion>(effects);
}

}  // namespace thimble::lit
