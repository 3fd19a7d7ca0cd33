/// @file pace.h
/// How a frame is drawn while the camera moves: with which engine, and every how-many-th pixel, so that it
/// takes no longer than it may. Decided from the times of the frames before.
#ifndef THIMBLE_TOOLS_VIEWER_PACE_H
#define THIMBLE_TOOLS_VIEWER_PACE_H

#include <array>
#include <cstdint>

namespace thimble::tools::viewer {

enum class FastEngine : std::uint8_t {
  kWide,  ///< object order: goes by the voxels in sight, and by pixels
  kRays,  ///< ray by ray: goes by pixels alone
};

class Pace {
 public:
  static constexpr int kMostStep = 8;

  /// `frame_seconds` is what drawing may take; `may_be_wide`: kRays alone otherwise.
  Pace(double frame_seconds, bool may_be_wide);

  FastEngine engine() const { return engine_; }
  /// Every so many pixels, across and down: 1 .. kMostStep.
  int step() const { return step_; }
  /// What the last frame took. Rays are tried where the wide renderer is too slow at a coarse step, and
  /// whichever is faster there stays.
  void take(double seconds);

 private:
  void choose_step(double seconds);

  double most_seconds_;
  bool may_be_wide_;
  FastEngine engine_;
  int step_ = 1;
  double wide_seconds_ = 0;  // at the step where rays were tried
  bool rays_tried_ = false;
  double mean_seconds_ = 0;
  bool is_first_ = true;  // it brings memory and threads into their places
  int frames_ = 0;        // since step or engine changed
};

}  // namespace thimble::tools::viewer

#endif
