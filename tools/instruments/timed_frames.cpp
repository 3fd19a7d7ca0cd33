#include "instruments/timed_frames.h"

#include <cmath>

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
  return scene_shading(ShadeMode::kDepth, {}, camera, bounds);
}

void MedianTime::set_times(const std::vector<double>& ms) {
  ms_median = quantile(ms, 0.5);
  ms_quarter = quantile(ms, 0.25);
  ms_three_quarters = quantile(ms, 0.75);
}

std::string MedianTime::spread() const {
  return ms_median <= 0 ? "-" : fixed(50 * (ms_three_quarters - ms_quarter) / ms_median, 0);
}

void MedianTime::add_to(JsonRow* object) const {
  (*object)["ms_median"] = ms_median;
  (*object)["ms_quarter"] = ms_quarter;
  (*object)["ms_three_quarters"] = ms_three_quarters;
}

void DepthError::compare_distances(const std::vector<double>& distances,
                                   const std::vector<double>& reference) {
  double sum = 0;
  std::uint64_t both = 0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if ((distances[i] < 0) != (reference[i] < 0)) {
      ++silhouette_px;
    } else if (distances[i] >= 0) {
      const double error = std::abs(distances[i] - reference[i]);
      sum += error;
      depth_max_voxels = std::max(depth_max_voxels, error);
      ++both;
    }
  }
  depth_mean_voxels = both == 0 ? 0 : sum / static_cast<double>(both);
}

}  // namespace thimble::tools
