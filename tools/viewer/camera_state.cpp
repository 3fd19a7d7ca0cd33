#include "viewer/camera_state.h"

#include <algorithm>
#include <cmath>

#include "viewer/finished_picture.h"

namespace thimble::tools::viewer {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTurnRadians = kPi;      // of a drag over the picture's height
constexpr double kFlightDistances = 0.7;  // a second
constexpr double kLeastSpan = 1;          // of a parallel picture, in voxels
constexpr double kMostSpan = 100000;

Real3 real_of(const Vec3Q8& point) {
  return {static_cast<double>(point.x.raw) / Q8::kOne, static_cast<double>(point.y.raw) / Q8::kOne,
          static_cast<double>(point.z.raw) / Q8::kOne};
}

Real3 real_of(const Vec3i& vector) {
  return {static_cast<double>(vector.x), static_cast<double>(vector.y), static_cast<double>(vector.z)};
}

NamedView side_of(Action view) {
  switch (view) {
    case Action::kFront:
      return NamedView::kFront;
    case Action::kBack:
      return NamedView::kBack;
    case Action::kLeft:
      return NamedView::kLeft;
    case Action::kRight:
      return NamedView::kRight;
    case Action::kTop:
      return NamedView::kTop;
    default:
      return NamedView::kIso;
  }
}

}  // namespace

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

void CameraState::place(const Framing& now, const OpenScene& scene) {
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
  place(now, scene);
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
  place(now, scene);
  orbit_->look_at(point);
}

void CameraState::choose(Action view, const Framing& now, const OpenScene& scene) {
  orbit_.reset();
  if (view == Action::kFirstView) {
    return;
  }
  ViewWishes wishes = first_;
  wishes.orthographic = !now.kept.is_perspective;
  wishes.fov_degrees = static_cast<double>(now.kept.fov_degrees.raw) / Q16::kOne;
  wishes.width_px = now.camera.width_px();
  wishes.height_px = now.camera.height_px();
  place(framed_from(scene, wishes, side_of(view)), scene);
}

void CameraState::change_scene(const OpenScene& scene) {
  if (orbit_) {
    orbit_ = Orbit(orbit_->eye(), orbit_->target(), orbit_->up(), scene.side());
  }
}

}  // namespace thimble::tools::viewer
