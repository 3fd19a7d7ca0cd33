/// @file camera_state.h
/// Which view the viewer shows: the one of the command line until somebody moves, then one of its own.
#ifndef THIMBLE_TOOLS_VIEWER_CAMERA_STATE_H
#define THIMBLE_TOOLS_VIEWER_CAMERA_STATE_H

#include <cstdint>
#include <optional>

#include "scene/framing.h"
#include "viewer/controls.h"
#include "viewer/open_scene.h"
#include "viewer/orbit.h"

namespace thimble::tools::viewer {

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
  void hold(const Framing& now, const OpenScene& scene) { place(now, scene); }
  /// Another scene in place of the one that was: the camera stays, as far as that scene allows.
  void change_scene(const OpenScene& scene);

 private:
  void place(const Framing& now, const OpenScene& scene);

  ViewWishes first_;
  std::optional<Orbit> orbit_;
  ViewWishes lens_;  // of the orbit: projection, field of view, span
};

}  // namespace thimble::tools::viewer

#endif
