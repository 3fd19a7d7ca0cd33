/// How frames of the paper's workload are seen and timed, for all tables that compare them: `thimble table`
/// and the peers' (tests/benchmarks).
///
/// A frame is 800 x 600 pixels of 8-bit grey by depth; the whole world fills the picture. It includes the
/// camera, its depth range, clearing and all that depends on the view, and carries nothing over from the last.
/// One frame that does not count comes first; each of the others is seen from another place, and the median
/// counts. Between two of them others work (they judge the picture, or draw their own), so caches are cold.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <string>
#include <vector>

#include "output/tables.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

inline constexpr std::int32_t kTimedWidthPx = 800;
inline constexpr std::int32_t kTimedHeightPx = 600;
/// That count.
inline constexpr int kTimedFrames = 5;
/// In a smaller world 800 pixels are finer than the 1/256 voxel that orthographic rays start on.
inline constexpr int kLeastTimedLevel = 5;

/// The view of frame `frame` (any) of a world of 2^level voxels a side: in perspective from outside above a
/// corner, or along y. Frames repeat after kTimedFrames.
Camera timed_camera(int level, bool orthographic, int frame);
/// Depth shading between the planes that bound the scene.
Shading timed_shading(const Camera& camera, const VoxelBox& bounds);

/// Time since it was made: processor time of this thread, which other programs do not lengthen; where more
/// threads than one draw, of the clock on the wall.
class FrameWatch {
 public:
  explicit FrameWatch(int threads = 1)
      : clock_(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC), start_(now()) {}
  double seconds() const { return now() - start_; }
  double ms() const { return 1000 * seconds(); }

 private:
  double now() const {
    timespec time{};
    clock_gettime(clock_, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  clockid_t clock_;
  double start_;
};

// Times of a program on a machine that does other things too, and what many of them say.

/// The value below which `part` (0..1) of them lie, between neighbours in proportion; at least one value.
inline double quantile(std::vector<double> values, double part) {
  std::sort(values.begin(), values.end());
  const double at = part * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const std::size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (values[high] - values[low]) * (at - static_cast<double>(low));
}

/// Median and quartiles of the times of one thing, in milliseconds of the processor.
struct MedianTime {
  double ms_median = 0;
  double ms_quarter = 0;
  double ms_three_quarters = 0;

  /// At least one time.
  void set_times(const std::vector<double>& ms);
  /// Half the distance of the quartiles in per cent of the median; "-" where that is 0.
  std::string spread() const;
  /// The three columns.
  void add_to(JsonRow* object) const;
};

// How far one picture is from another of the same rays.

struct DepthError {
  std::uint64_t silhouette_px = 0;  ///< hit in one and missed in the other
  double depth_mean_voxels = 0;  ///< distances' difference, over pixels hit in both; 0 where there are none
  double depth_max_voxels = 0;

  /// Of the distances of all pixels, negative for a miss.
  void compare_distances(const std::vector<double>& distances, const std::vector<double>& reference);
};

}  // namespace thimble::tools
