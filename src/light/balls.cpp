// Balls that are not in the tree: what a ray meets once they are looked at too.
#include "thimble/light/render.h"

#include "arithmetic.h"
#include "queries.h"

namespace thimble {
namespace {

using lit::is_before;

constexpr BoxQ8 box_of(const Ball& ball) {
  const int32_t half = ball.half_q8;
  return {{ball.center.x - half, ball.center.y - half, ball.center.z - half},
          {ball.center.x + half, ball.center.y + half, ball.center.z + half}};
}

}  // namespace

bool enter_box(const Ray& ray, const BoxQ8& box, BoxHit* hit) {
  RayPoint in;
  RayPoint out;
  bool has_out = false;
  int axis_in = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t along = ray.direction[axis];
    const int32_t from = ray.origin[axis].raw;
    if (along == 0) {
      if (from < box.low[axis] || from >= box.high[axis]) {
        return false;
      }
      continue;
    }
    const auto speed = static_cast<int32_t>(magnitude_32(along) * Q8::kOne);
    const RayPoint near{along > 0 ? box.low[axis] - from : from - box.high[axis], speed};
    const RayPoint far{along > 0 ? box.high[axis] - from : from - box.low[axis], speed};
    if (far.t_numerator <= 0) {
      return false;
    }
    if (near.t_numerator >= 0 && (axis_in < 0 || is_before(in, near))) {
      in = near;
      axis_in = axis;
    }
    if (!has_out || is_before(far, out)) {
      out = far;
      has_out = true;
    }
  }
  if (axis_in >= 0 && !is_before(in, out)) {
    return false;
  }
  *hit = {in, axis_in};
  return true;
}

bool enter_ball(const Ray& ray, const Ball& ball, BoxHit* hit, BoxQ8* entered) {
  const BoxQ8 whole = box_of(ball);
  BoxHit one;
  if (!enter_box(ray, whole, &one)) {
    return false;
  }
  bool found = false;
  for (int axis = 0; axis < 3; ++axis) {
    BoxQ8 box = whole;  // half as thick along one axis
    box.low[axis] += ball.half_q8 / 2;
    box.high[axis] -= ball.half_q8 / 2;
    if (enter_box(ray, box, &one) &&
        (!found || is_before(one.at, hit->at) || (one.axis < hit->axis && !is_before(hit->at, one.at)))) {
      *hit = one;
      found = true;
      if (entered != nullptr) {
        *entered = box;
      }
    }
  }
  return found;
}

namespace lit {
namespace {

// A shadow ray: it needs no place of its hit but before the light's.
bool blocks_light(BallFrame& frame, const LightRay& light) {
  BoxHit hit;
  return meet_ball(frame, light.ray, light.is_point ? &light.place : nullptr, &hit) &&
         !(light.is_point && (frame.effects & Effect::kEmission) != 0 &&
           frame.met->surface.kind == SurfaceKind::kEmit);
}

void count_blocked(Frame& frame) {
  count_ray(frame, LitRayKind::kShadow);
  frame.counts.hits[static_cast<int>(LitRayKind::kShadow)] += 1;
}

// What the tree gave is there; a ball before it takes its place. A ball ends a ray, so none is behind.
void meet_before(BallFrame& frame, const PendingRay& now, Meeting* meeting) {
  const RayPoint end = point_of(meeting->hit);
  BoxHit hit;
  if (!meet_ball(frame, now.ray, meeting->found ? &end : nullptr, &hit)) {
    return;
  }
  frame.counts.hits[static_cast<int>(now.kind)] += meeting->hit.kind == HitKind::kHit ? 0U : 1U;
  *meeting = Meeting{};
  meeting->found = true;
  meeting->opaque = true;
  meeting->hit.kind = HitKind::kHit;
  meeting->hit.axis = static_cast<int8_t>(hit.axis);
  meeting->hit.t_numerator = hit.at.t_numerator;
  meeting->hit.t_denominator = hit.at.t_denominator;
}

}  // namespace

Status check_balls(const DrawnBalls& drawn, int level) {
  if (drawn.balls.size > kMaxDrawnBalls) {
    return Status::kOutOfRange;
  }
  for (const Ball& ball : drawn.balls) {
    if ((ball.half_q8 & 1) != 0 || ball.half_q8 < 0) {
      return Status::kBadArgument;
    }
    // Within what a centre's box may be computed of: further out no ray may start either.
    constexpr int32_t kFar = INT32_MAX / 2;
    for (int axis = 0; axis < 3; ++axis) {
      if (ball.half_q8 > kFar || !is_within(ball.center[axis], kFar)) {
        return Status::kOutOfRange;
      }
    }
    const BoxQ8 box = box_of(ball);
    for (int end = 0; end < 2; ++end) {
      const Vec3i& corner = end == 0 ? box.low : box.high;
      const Ray ray{{Q8::from_raw(corner.x), Q8::from_raw(corner.y), Q8::from_raw(corner.z)}, {1, 0, 0}};
      if (check_ray(ray, level) != Status::kOk) {
        return Status::kOutOfRange;
      }
    }
  }
  return Status::kOk;
}

bool meet_ball(BallFrame& frame, const Ray& ray, const RayPoint* end, BoxHit* hit) {
  frame.met = nullptr;
  for (size_t i = 0; i < frame.drawn.balls.size; ++i) {
    const Ball& ball = frame.drawn.balls[i];
    if (ball.half_q8 == 0) {
      continue;
    }
    BoxQ8 way = box_of(ball);
    way.low.z = way.low.z < ball.bottom_q8 ? way.low.z : ball.bottom_q8;
    way.high.z = way.high.z > ball.top_q8 ? way.high.z : ball.top_q8;
    BoxHit one;
    if (!enter_box(ray, way, &one) || (end != nullptr && !is_before(one.at, *end))) {
      continue;
    }
    if (frame.drawn.passed != nullptr) {
      *frame.drawn.passed |= 1U << i;
    }
    BoxQ8 box;
    if (enter_ball(ray, ball, &one, &box) && (end == nullptr || is_before(one.at, *end)) &&
        (frame.met == nullptr || is_before(one.at, hit->at))) {
      *hit = one;
      frame.met = &ball;
      frame.entered = box;
    }
  }
  return frame.met != nullptr;
}

void meet_solid(BallFrame& frame, const PendingRay& now, Meeting* meeting) {
  meet_solid(static_cast<Frame&>(frame), now, meeting);
  meet_before(frame, now, meeting);
}

void meet_clear(BallFrame& frame, const PendingRay& now, const Leg& leg, Meeting* meeting) {
  meet_clear(static_cast<Frame&>(frame), now, leg, meeting);
  meet_before(frame, now, meeting);
}

Spot spot_of(const BallFrame& frame, const PendingRay& now, const Meeting& meeting) {
  if (frame.met == nullptr) {
    return spot_of(static_cast<const Frame&>(frame), now, meeting);
  }
  const int8_t axis = meeting.hit.axis;
  const BoxQ8& box = frame.entered;
  Spot spot;
  spot.inside = axis < 0;
  spot.at = now.ray.origin;
  if (axis >= 0) {
    const int32_t plane = now.ray.direction[axis] > 0 ? box.low[axis] : box.high[axis];
    spot.at = start_on_plane(now.ray, axis, plane, box.low, box.high);
  }
  spot.face = face_of(meeting.hit, now.ray.direction);
  spot.arriving = now.ray.direction;
  spot.surface = frame.met->surface;
  return spot;
}

bool light_arrives(BallFrame& frame, const LightRay& light) {
  if (blocks_light(frame, light)) {
    count_blocked(frame);
    return false;
  }
  return light_arrives(static_cast<Frame&>(frame), light);
}

bool light_arrives_through(BallFrame& frame, LightRay* light) {
  if (blocks_light(frame, *light)) {
    count_blocked(frame);
    return false;
  }
  return light_arrives_through(static_cast<Frame&>(frame), light);
}

Slope slope_at(BallFrame& frame, LitRayKind kind, const Spot& spot) {
  return frame.met == nullptr ? slope_at(static_cast<Frame&>(frame), kind, spot) : Slope{};
}

}  // namespace lit
}  // namespace thimble
