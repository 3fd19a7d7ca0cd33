#include "viewer/camera_state.h"

#include <algorithm>
#include <cmath>

namespace thimble::tools::viewer {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTurnRadians = kPi;      // of a drag over the picture's height
constexpr double kFlightDistances = 0.7;  // a second
constexpr double kLeastSpan = 1;          // of a parallel picture, in voxels
constexpr double kMostSpan = 100000;

// The actions from kFront on, as sides.
NamedView side_of(Action view) {
  constexpr std::array kSides{NamedView::kFront, NamedView::kBack, NamedView::kLeft,
                              NamedView::kRight, NamedView::kTop,  NamedView::kIso};
  return kSides[static_cast<std::size_t>(view) - static_cast<std::size_t>(Action::kFront)];
}

constexpr double kRightAngle = 1.57079632679489661923;
constexpr double kLeastDistance = 0.25;  // in voxels
// Within the -4 .. 5 worlds from which rays may start.
constexpr double kLowWorlds = -3.99;
constexpr double kHighWorlds = 4.99;

double rounded(double value, double steps) {
  return std::round(value * steps) / steps;
}
Real3 rounded(const Real3& v, double steps) {
  return {rounded(v[0], steps), rounded(v[1], steps), rounded(v[2], steps)};
}

}  // namespace

ViewWishes unplaced(ViewWishes view) {
  view.placed = false;
  view.eye.reset();
  view.target.reset();
  view.up.reset();
  view.span.reset();
  return view;
}

ViewWishes CameraState::wishes(std::int32_t width_px, std::int32_t height_px) const {
  ViewWishes wishes = orbit_ ? lens_ : first_;
  wishes.width_px = width_px;
  wishes.height_px = height_px;
  if (orbit_) {
    wishes.eye = orbit_->eye();
    wishes.target = orbit_->target();
    wishes.up.reset();
    if (orbit_->is_vertical()) {
      wishes.up = orbit_->up();
    }
  }
  return wishes;
}

void CameraState::hold(const Framing& now, const OpenScene& scene) {
  if (orbit_) {
    return;
  }
  const SceneCamera& kept = now.kept;
  const Real3 eye = real_of(kept.eye);
  Real3 target = real_of(kept.target);
  const Real3 way = minus(target, eye);
  if (dot(way, way) == 0) {
    target = plus(eye, real_of(kept.forward));
  }
  const bool has_up = kept.up.x != 0 || kept.up.y != 0 || kept.up.z != 0;
  orbit_.emplace(eye, target, has_up ? real_of(kept.up) : Real3{0, 1, 0}, scene.side());
  lens_ = first_;
  lens_.placed = true;
  lens_.orthographic = !kept.is_perspective;
  lens_.fov_degrees = static_cast<double>(kept.fov_degrees.raw) / Q16::kOne;
  lens_.span.reset();
  if (lens_.orthographic) {
    lens_.span = static_cast<double>(kept.span.raw) / Q14::kOne;
  }
}

void CameraState::apply(const Motion& motion, const Framing& now, const OpenScene& scene) {
  hold(now, scene);
  orbit_->turn(motion.turn_right * kTurnRadians, motion.turn_up * kTurnRadians);
  const Camera& camera = now.camera;
  const double height = lens_.orthographic ? *lens_.span * camera.height_px() / camera.width_px()
                                           : 2 * std::tan(lens_.fov_degrees * kPi / 360) * orbit_->distance();
  orbit_->move(motion.move_right * height, motion.move_up * height, 0);
  if (lens_.orthographic) {
    lens_.span = std::clamp(std::round(*lens_.span * motion.factor * 1000) / 1000, kLeastSpan, kMostSpan);
  } else {
    orbit_->approach(motion.factor);
  }
  const double speed = kFlightDistances * std::max(orbit_->distance(), 0.05 * scene.side());
  orbit_->move(motion.fly_right * speed, motion.fly_up * speed, motion.fly_forward * speed);
}

void CameraState::look_at(const Real3& point, const Framing& now, const OpenScene& scene) {
  hold(now, scene);
  orbit_->look_at(point);
}

void CameraState::choose(Action view, const Framing& now, const OpenScene& scene) {
  orbit_.reset();
  if (view == Action::kFirstView) {
    return;
  }
  ViewWishes wishes = unplaced(first_);
  wishes.placed = true;
  wishes.side = side_of(view);
  wishes.onward = {};
  wishes.orthographic = !now.kept.is_perspective;
  wishes.fov_degrees = static_cast<double>(now.kept.fov_degrees.raw) / Q16::kOne;
  wishes.width_px = now.camera.width_px();
  wishes.height_px = now.camera.height_px();
  hold(frame_shape(wishes, scene.shape), scene);
}

void CameraState::change_scene(const OpenScene& scene) {
  if (orbit_) {
    orbit_ = Orbit(orbit_->eye(), orbit_->target(), orbit_->up(), scene.side());
  }
}

Orbit::Orbit(const Real3& eye, const Real3& target, const Real3& up, double side)
    : target_(target), side_(side) {
  const Real3 way = minus(target, eye);
  distance_ = std::sqrt(dot(way, way));
  const double flat = std::hypot(way[0], way[1]);
  pitch_ = std::atan2(way[2], flat);
  if (flat > 1e-9 * distance_) {
    yaw_ = std::atan2(way[0], way[1]);
  } else {
    pitch_ = way[2] > 0 ? kRightAngle : -kRightAngle;
    const double sign = way[2] > 0 ? -1 : 1;
    yaw_ = std::atan2(sign * up[0], sign * up[1]);
  }
  keep_in_reach();
}

bool Orbit::is_vertical() const {
  return std::abs(pitch_) > kRightAngle - 1e-4;
}

Real3 Orbit::forward() const {
  if (is_vertical()) {
    return {0, 0, pitch_ > 0 ? 1.0 : -1.0};
  }
  return {std::cos(pitch_) * std::sin(yaw_), std::cos(pitch_) * std::cos(yaw_), std::sin(pitch_)};
}

Real3 Orbit::right() const {
  return {std::cos(yaw_), -std::sin(yaw_), 0};
}

Real3 Orbit::up() const {
  if (is_vertical()) {
    const double sign = pitch_ > 0 ? -1 : 1;
    return {rounded(sign * std::sin(yaw_), 1e4), rounded(sign * std::cos(yaw_), 1e4), 0};
  }
  return cross(right(), forward());
}

Real3 Orbit::eye() const {
  return rounded(minus(target_, scaled(forward(), distance_)), 1e3);
}

// As far from the eye as it takes to keep a direction in so many digits.
Real3 Orbit::target() const {
  constexpr double kFarEnough = 4;
  Real3 target = distance_ > kFarEnough
                     ? rounded(target_, 1e3)
                     : rounded(plus(eye(), scaled(forward(), std::max(distance_, 1.0))), 1e4);
  if (is_vertical()) {
    const Real3 from = eye();
    target[0] = from[0];
    target[1] = from[1];
  }
  return target;
}

void Orbit::turn(double right, double up) {
  yaw_ = std::remainder(yaw_ + right, 4 * kRightAngle);
  pitch_ = std::clamp(pitch_ + up, -kRightAngle, kRightAngle);
  keep_in_reach();
}

void Orbit::move(double right, double up, double forward) {
  target_ = plus(target_, plus(scaled(this->right(), right),
                               plus(scaled(this->up(), up), scaled(this->forward(), forward))));
  keep_in_reach();
}

void Orbit::approach(double factor) {
  distance_ *= factor;
  keep_in_reach();
}

void Orbit::look_at(const Real3& point) {
  const Real3 from = minus(target_, scaled(forward(), distance_));
  const Real3 way = minus(point, from);
  if (dot(way, way) > kLeastDistance * kLeastDistance) {
    *this = Orbit(from, point, up(), side_);
  }
}

// The target in the world or near it; the eye at most as far behind it as rays may start.
void Orbit::keep_in_reach() {
  for (double& coordinate : target_) {
    coordinate = std::clamp(coordinate, -side_, 2 * side_);
  }
  const Real3 ahead = forward();
  double most = 4 * side_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double limit = (ahead[axis] > 0 ? kLowWorlds : kHighWorlds) * side_;
    if (std::abs(ahead[axis]) > 1e-12) {
      most = std::min(most, (target_[axis] - limit) / ahead[axis]);
    }
  }
  distance_ = std::clamp(distance_, kLeastDistance, std::max(most, kLeastDistance));
}

}  // namespace thimble::tools::viewer
