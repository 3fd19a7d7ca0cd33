// The queries of the parts of a lit picture, for each kind of frame: Frame traces the tree at once, BallFrame looks at balls
// beside it (render.h), AskedFrame defers the query to its driver (asked.h). Internal to src/.
#pragma once

#include "arithmetic.h"
#include "thimble/light/detail/pixel.h"
#include "thimble/light/host/asked.h"
#include "thimble/light/host/slope.h"
#include "thimble/light/render.h"
#include "thimble/trace/ray.h"

namespace thimble::lit {

/// The solid voxel met first, counted. An AskedFrame may report a miss for hits at or beyond place().
template <class Place>
[[gnu::always_inline]] inline void find_before(Frame& frame, LitRayKind kind, const Ray& ray,
                                               const Place& /*place*/, Hit* hit) {
  find_solid(frame, kind, ray, hit);
}
/// The answer, counted; as long as there is none a miss, and `ask()` notes the query.
template <class Ask>
inline void take_counted(AskedFrame& frame, LitRayKind kind, Hit* hit, const Ask& ask) {
  const Answer* answer = frame.look();
  if (answer == nullptr) {
    ask();
    *hit = Hit{};
    return;
  }
  *hit = answer->hit;
  count_result(frame, kind, hit->kind, hit->visits);
}
template <class Place>
inline void find_before(AskedFrame& frame, LitRayKind kind, const Ray& ray, const Place& place, Hit* hit) {
  take_counted(frame, kind, hit, [&] {
    frame.note(kind == LitRayKind::kOcclusion ? Question::kNear : Question::kBefore, ray, place());
  });
}

/// The same for a ray of occlusion round a slope, `aimed()`.
template <class Aimed>
inline void find_around(AskedFrame& frame, const Aimed& aimed, Hit* hit) {
  take_counted(frame, LitRayKind::kOcclusion, hit, [&] { frame.note(Question::kAround, aimed(), {}); });
}

/// The same with balls.
template <class Place>
inline void find_before(BallFrame& frame, LitRayKind kind, const Ray& ray, const Place& place, Hit* hit) {
  find_solid(frame, kind, ray, hit);
  RayPoint end = place();
  if (hit->kind == HitKind::kHit && is_before(point_of(*hit), end)) {
    end = point_of(*hit);
  }
  BoxHit ball;
  if (meet_ball(frame, ray, &end, &ball)) {
    hit->kind = HitKind::kHit;
    hit->axis = static_cast<int8_t>(ball.axis);
    hit->t_numerator = ball.at.t_numerator;
    hit->t_denominator = ball.at.t_denominator;
  }
}

/// Whether no light comes past what was found.
[[gnu::always_inline]] inline bool is_opaque(const Frame& frame, const Hit& hit) {
  return hit.kind == HitKind::kHit && !is_clear(frame, hit.material);
}
inline bool is_opaque(const BallFrame& frame, const Hit& hit) {
  return frame.met != nullptr || is_opaque(static_cast<const Frame&>(frame), hit);
}

/// The status of a deferred query whose answer is not there yet.
inline constexpr Status kUnknown = Status::kBadArgument;

/// Whether there is a hit, not counted.
[[gnu::always_inline]] inline Status find_any(Frame& frame, const Ray& ray, HitKind* kind, uint32_t* visits) {
  return any_hit(frame.tree, ray, kind, visits, {frame.options.max_visits, Width::kAuto});
}
inline Status find_any(AskedFrame& frame, const Ray& ray, HitKind* kind, uint32_t* visits) {
  const Answer* answer = frame.look();
  if (answer == nullptr) {
    frame.note(Question::kAny, ray, {});
    return kUnknown;
  }
  *kind = answer->hit.kind;
  *visits = answer->hit.visits;
  return Status::kOk;
}

/// A stretch of a ray's own way, not counted.
[[gnu::always_inline]] inline Status find_closest(Frame& frame, const Ray& ray, Hit* hit,
                                                  const TraceOptions& options) {
  return closest_hit(frame.tree, ray, hit, options);
}
[[gnu::always_inline]] inline Status find_from(Frame& frame, const Ray& ray, const RayPoint& from, Hit* hit,
                                               const TraceOptions& options) {
  return closest_hit_from(frame.tree, ray, from, hit, options);
}
[[gnu::always_inline]] inline Status find_exit(Frame& frame, const Ray& ray, uint8_t material,
                                               const RayPoint& from, MediumExit* exit,
                                               const TraceOptions& options) {
  return leave_medium(frame.tree, ray, material, exit, from, options);
}
/// The answer to a deferred query of a ray's own way; without one the frame is open.
inline Status take_answer(AskedFrame& frame, Question question, const Ray& ray, const RayPoint& from,
                          uint16_t in, MediumExit* exit) {
  const Answer* answer = frame.look();
  if (answer == nullptr) {
    frame.note(question, ray, from, in);
    frame.is_open = true;
    return kUnknown;
  }
  *exit = *answer;
  return Status::kOk;
}
inline Status take_hit(AskedFrame& frame, Question question, const Ray& ray, const RayPoint& from, Hit* hit) {
  MediumExit exit;
  exit.hit = *hit;
  const Status status = take_answer(frame, question, ray, from, kInNothing, &exit);
  *hit = exit.hit;
  return status;
}
inline Status find_closest(AskedFrame& frame, const Ray& ray, Hit* hit, const TraceOptions& /*options*/) {
  return take_hit(frame, Question::kClosest, ray, {}, hit);
}
inline Status find_from(AskedFrame& frame, const Ray& ray, const RayPoint& from, Hit* hit,
                        const TraceOptions& /*options*/) {
  return take_hit(frame, Question::kOn, ray, from, hit);
}
inline Status find_exit(AskedFrame& frame, const Ray& ray, uint8_t material, const RayPoint& from,
                        MediumExit* exit, const TraceOptions& /*options*/) {
  return take_answer(frame, Question::kOn, ray, from, material, exit);
}

/// Where slopes are looked up.
[[gnu::always_inline]] inline const CompactTree& source_of_slopes(Frame& frame) {
  return frame.tree;
}
inline AskedFrame& source_of_slopes(AskedFrame& frame) {
  return frame;
}

/// The slope of a body at a point on its face: `surface_normal`. Without an answer the frame is open.
inline Vec3i surface_normal(AskedFrame& frame, const Body& body, const Vec3Q8& at, const Face& face,
                            uint32_t* visits) {
  const Answer* answer = frame.look();
  if (answer == nullptr) {
    frame.ask_slope(at, face, body.index_q12);
    return {};
  }
  *visits += answer->hit.visits;
  return answer->hit.voxel;
}

}  // namespace thimble::lit
