#include "instruments/timed_frames.h"

#include "scene/framing.h"

namespace thimble::tools {

Camera timed_camera(int level, bool orthographic, int frame) {
  const double side = 1 << level;
  const double drift = 0.003 * side * (frame % kTimedFrames + 1);
  ViewWishes view;
  view.width_px = kTimedWidthPx;
  view.height_px = kTimedHeightPx;
  view.orthographic = orthographic;
  view.target = Real3{side / 2 + drift / 3, side / 2, side / 2 + drift / 5};
  if (orthographic) {
    view.eye = Real3{(*view.target)[0], -1, (*view.target)[2]};  // along y
    view.span = side * kTimedWidthPx / kTimedHeightPx;
  } else {
    view.eye = Real3{side * 0.2 + drift, -side * 0.62, side * 0.75 - drift / 2};
  }
  return frame_box(view, level, {}).camera;
}

Shading timed_shading(const Camera& camera, const VoxelBox& bounds) {
  Shading shading;
  const DepthRange range = depth_range(camera, bounds);
  shading.near_q8 = range.near_q8;
  shading.far_q8 = range.far_q8;
  return shading;
}

}  // namespace thimble::tools
