/// Which view the viewer shows: the one of the command line until somebody moves, then one of its own.
#pragma once

#include <cstdint>
#include <optional>

#include "readers/real3.h"
#include "scene/framing.h"
#include "viewer/controls.h"
#include "viewer/open_scene.h"

namespace thimble::tools::viewer {

// A camera that turns around a point, moves, comes nearer and flies: the geometry behind the viewer's keys.
//
// World axes as everywhere: right-handed, z up. The horizon stays level: the camera turns about the world's
// z axis and tilts up to straight down or straight up, where the picture's up is what it was on the way
// there.

class Orbit {
 public:
  /// What is seen from `eye` towards `target`, in a world of `side` voxels; `up` decides only where the view
  /// is vertical. The two points differ.
  Orbit(const Real3& eye, const Real3& target, const Real3& up, double side);

  /// Turns around the target, in radians: the direction of view to the right (the eye goes left), and up.
  void turn(double right, double up);
  /// Moves eye and target by so many voxels along the picture's axes.
  void move(double right, double up, double forward);
  /// Multiplies the distance to the target.
  void approach(double factor);
  /// Turns where it stands, so that `point` is in the middle and is what it turns around from now on.
  void look_at(const Real3& point);

  /// Rounded to 1/1000 and 1/10000 voxel, so that they can be written in short decimals: whoever reads those
  /// gets this very camera.
  Real3 eye() const;
  Real3 target() const;
  Real3 forward() const;
  Real3 right() const;
  Real3 up() const;
  /// Whether `up` has to be written, since it does not follow from the direction.
  bool is_vertical() const;
  double distance() const { return distance_; }

 private:
  void keep_in_reach();

  Real3 target_;
  double yaw_ = 0;    // 0: along y; growing to the right
  double pitch_ = 0;  // -pi/2 .. pi/2, above 0 looks up
  double distance_ = 1;
  double side_ = 1;
};

/// The view without any place of the camera: for another scene, or from another side.
ViewWishes unplaced(ViewWishes view);

class CameraState {
 public:
  explicit CameraState(const ViewWishes& first) : first_(first) {}

  /// What to frame for a picture of that size.
  ViewWishes wishes(std::int32_t width_px, std::int32_t height_px) const;
  /// Moves from where `now` shows the scene.
  void apply(const Motion& motion, const Framing& now, const OpenScene& scene);
  /// Turns towards a point, in voxels.
  void look_at(const Real3& point, const Framing& now, const OpenScene& scene);
  /// One of the named views, the scene framed in it. `now` gives the field of view.
  void choose(Action view, const Framing& now, const OpenScene& scene);
  /// The camera of `now` stays, whatever would be framed.
  void hold(const Framing& now, const OpenScene& scene);
  /// Another scene in place of the one that was: the camera stays, as far as that scene allows.
  void change_scene(const OpenScene& scene);

 private:
  ViewWishes first_;
  std::optional<Orbit> orbit_;
  ViewWishes lens_;  // of the orbit: projection, field of view, span
};

}  // namespace thimble::tools::viewer
