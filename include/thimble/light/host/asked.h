/// @file asked.h
/// Lit pictures with deferred queries: the code of render.h, whose rays a driver traces, many at once.
///
/// What a picture is made of stands in detail/pixel.h and is compiled twice: with a `Frame` that asks the
/// tree at once, as a chip does, and with an `AskedFrame`, whose questions are noted and answered by whoever
/// drives it, those of many rays at once. A ray then takes steps, each of them a function called again and
/// again until all that it asks is known, and what it gives counts:
///
///     follow   the ray's way: what it meets, what it sends on. Stops where an answer is wanted, and has then
///              sent nothing on. Without clear solids, water and slopes the only one is that of `closest_hit`
///              for the ray, and nothing is counted before it is there.
///     shine    where it met a surface whose slope is bent: the light there. Asks for all of it, shadows and
///              occlusion, at once; where it asks nothing it counts nothing.
///
/// The light of faces is the driver's: what `face_color` says of `ray->spot`. What counts is what the core's
/// own renderer gives: the same code with the same answers.
///
///     AskedFrame frame(...);  // and room for questions and answers
///     const Steps steps = steps_of(frame.effects);
///     for each pixel: pending[0] = its ray, count = 1; then until count is 0:
///       take the last of `pending`; begin and follow it, until frame.is_answered();
///       if frame.shows() a slope: begin and shine, until frame.is_answered()
///       if it shows a face: add its light, weighed by `ray->weight`
///     store(frame, band, line, x, y, sum)
///
/// Between two calls the driver answers `questions` and `slopes`, and sets their counts to 0. Light through
/// clear solids continues from each answer to the next question, of which `shine` keeps one at a time for each
/// light. Rare queries are not deferred: single voxels, water.
#ifndef THIMBLE_LIGHT_HOST_ASKED_H
#define THIMBLE_LIGHT_HOST_ASKED_H

#include <stddef.h>
#include <stdint.h>

#include "../../base/status.h"
#include "../../trace/ray.h"
#include "../../trace/secondary_ray.h"
#include "../../tree/compact_tree.h"
#include "../detail/pixel.h"
#include "../scene.h"

namespace thimble::lit {

enum class Question : uint8_t {
  kClosest,  ///< `closest_hit`; what is hit is not before the point `before`
  kAny,      ///< `any_hit`: of the answer `hit.kind` alone counts
  kBefore,   ///< `closest_hit`, where a hit at or after `before` may be given or left out
  kNear,     ///< the same for occlusion: one `before` for all; the material only where things may be clear
  kAround,   ///< the same for occlusion round a slope (slope_reach)
  kOn,       ///< from the point `before` on: `closest_hit_from`, or of a ray in a material its `leave_medium`
};
inline constexpr int kQuestions = 6;
/// What a ray of kOn is in that is in no material.
inline constexpr uint16_t kInNothing = 256;

/// Questions of one kind, in their order of submission. All rays pass `check_ray`.
struct Asked {
  Ray* rays = nullptr;
  RayPoint* before = nullptr;  ///< kBefore and kOn, and kClosest where a driver takes it; else null
  uint16_t* in = nullptr;      ///< kOn alone: a material, or kInNothing
  uint32_t* answer = nullptr;  ///< the number of the answer that is wanted
  uint32_t count = 0;
};

/// From where on a hit of kAround counts no more: its rays have the lengths of the pattern (127, or 1 less or
/// more) times 128 but for some units, and `distance_q8` is off by less than 2^-13 of itself.
constexpr RayPoint slope_reach(const Occlusion& occlusion) {
  return {occlusion.reach + (occlusion.reach >> 13) + 1, 125 * 128};
}

/// Where a slope is wanted: the arguments of `surface_normal` for a body of this index.
struct AskedSlope {
  Vec3Q8 at;
  Face face{0, false};
  uint16_t index_q12 = 0;
  uint32_t answer = 0;  ///< the number of the answer that is wanted
};

/// Where an answer is put: `hit` as the core's, its visits what whoever answered counted; `into_solid` is
/// false. Of a slope `hit.voxel` is the normal.
using Answer = MediumExit;

/// The most answers that a step of one ray takes.
constexpr size_t most_answers(EffectSet effects, const LitScene& scene) {
  constexpr EffectSet kStretching = Effect::kGlass | Effect::kMedia | Effect::kWater;
  const size_t legs = (effects & kStretching) != 0 ? kMaxLegs : 1U;
  const size_t on_way = (effects & Effect::kSmoothNormals) != 0 ? 2 * legs : legs;
  const size_t light = ((effects & Effect::kAmbientOcclusion) != 0 ? scene.occlusion.rays : 0U) +
                       ((effects & Effect::kShadows) != 0 ? scene.lights.size : 0U);
  return on_way > light ? on_way : light;
}

/// How far light has come through clear solids.
struct LightWay {
  enum State : uint8_t { kNew, kUnderWay, kArrived, kBlocked };
  State state = kNew;
  uint8_t legs = 0;      ///< behind it
  bool has_met = false;  ///< on one of them, something
  Leg leg;
  uint32_t brightness[3] = {};
};

/// The ray to a light, from its first query on.
struct KnownLight {
  LightRay ray;
  LightWay way;
  bool shines = false;  ///< else the slope is turned away from it
};

/// What is kept of a ray from one call to the next.
struct KnownRay {
  // Of its way:
  Medium begins_in;  ///< if `has_begun`
  bool has_begun = false;
  // Of the light where it ends:
  bool has_spot = false;
  bool has_slope = false;   ///< a bent one, of which `shine` works out the light; else a face
  bool has_lights = false;  ///< one for each light of the scene is in AskedFrame::lights
  Spot spot;
  Slope slope;
  Weight weight;
};

/// A frame that defers its queries, for one ray after another.
struct AskedFrame : Frame {
  static constexpr bool kIsAsked = true;

  explicit AskedFrame(const Frame& frame) : Frame(frame) {}

  /// Before a step: the answers that it has, `count` of them from number `first` on, at `given` with room for
  /// `most_answers`; what is known of the ray, and of its lights, with room for all of the scene.
  void begin(Answer* given, uint32_t first, uint32_t count, KnownRay* of_ray, KnownLight* of_lights) {
    answers = given;
    number = first;
    known = count;
    asked = 0;
    is_open = false;
    waits = false;
    ray = of_ray;
    lights = of_lights;
  }
  /// After it: whether all was answered, so that what it gave counts. Else it is to be taken again when the
  /// questions have their answers: then `asked` are known.
  bool is_answered() const { return asked <= known && !waits; }
  /// After `follow`: whether the ray ended on a surface, whose light is to be worked out.
  bool shows() const { return ray->has_spot; }

  // --- For the parts of detail/pixel.h. Each `look` is for the next answer, whether it is there or not.

  /// The next answer; null when it is not known.
  const Answer* look() {
    const uint32_t index = asked++;
    return index < known ? answers + index : nullptr;
  }
  /// Asks for what `look` did not find. A ray that `check_ray` refuses has missed.
  void note(Question question, const Ray& from, const RayPoint& before, uint16_t in = kInNothing) {
    if (check_ray(from, tree.level()) != Status::kOk) {
      answers[asked - 1] = Answer{};
      return;
    }
    Asked& to = questions[static_cast<int>(question)];
    to.rays[to.count] = from;
    if (to.before != nullptr) {
      to.before[to.count] = before;
    }
    if (to.in != nullptr) {
      to.in[to.count] = in;
    }
    to.answer[to.count++] = number + asked - 1;
  }
  /// Asks for the slope that `look` did not find: nothing that follows it counts.
  void ask_slope(const Vec3Q8& at, const Face& face, uint16_t index_q12) {
    slopes[slope_count++] = {at, face, index_q12, number + asked - 1};
    is_open = true;
  }
  /// Leaves a surface's light to `shine`, or without a slope to the driver.
  void show(const Spot& spot, const Slope* slope, const Weight& weight) {
    ray->spot = spot;
    ray->weight = weight;
    ray->has_spot = true;
    ray->has_slope = slope != nullptr;
    if (slope != nullptr) {
      ray->slope = *slope;
    }
  }

  Asked* questions = nullptr;  ///< of each kind; may be shared
  /// With Effect::kSmoothNormals: one for each ray that takes a step before they are answered.
  AskedSlope* slopes = nullptr;
  uint32_t slope_count = 0;  ///< to be set to 0 by whoever answered them
  /// Counts what is taken once, though the step that it is part of may be taken again.
  Frame* once = nullptr;
  Answer* answers = nullptr;
  KnownRay* ray = nullptr;
  KnownLight* lights = nullptr;
  LightWay* way = nullptr;  ///< of the light that is queried
  uint32_t number = 0;
  uint32_t known = 0;
  uint32_t asked = 0;
  bool is_open = false;  ///< a query of the ray's own way is deferred: nothing that follows it counts
  bool waits = false;    ///< an answer has led to another query in its place
};

/// The steps with the effects of a set compiled in, and those that `AskedFrame::effects` has not left out.
struct Steps {
  void (*follow)(AskedFrame& frame, const PendingRay& now, PendingRay* pending, size_t* count, Color* sum);
  void (*shine)(AskedFrame& frame, Color* sum);
};
Steps steps_of(EffectSet effects);

// The parts of detail/pixel.h that ask.

void meet_solid(AskedFrame& frame, const PendingRay& now, Meeting* meeting);
void meet_clear(AskedFrame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting);
bool light_arrives(AskedFrame& frame, const LightRay& light);
bool light_arrives_through(AskedFrame& frame, LightRay* light);
/// For slopes that are not raised.
void occlude(AskedFrame& frame, const Spot& spot, Color* light);
void occlude(AskedFrame& frame, const Spot& spot, const Slope& slope, Color* light);
void begin_leg(AskedFrame& frame, const PendingRay& now, Leg* leg);
Slope slope_at(AskedFrame& frame, LitRayKind kind, const Spot& spot);
bool cross_slope(AskedFrame& frame, PendingRay* now, Leg* leg, const Meeting& meeting, PendingRay* pending,
                 size_t* count);
bool light_ray_of(AskedFrame& frame, size_t number, const Spot& spot, const Slope& slope, LightRay* ray);

}  // namespace thimble::lit

#endif
