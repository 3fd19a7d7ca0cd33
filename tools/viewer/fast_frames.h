/// Frames while something moves: unlit, by the wide renderer or ray by ray, coarser where the time wants it; or, of an
/// animation, with all of their light.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scene/host_memory.h"
#include "thimble/base/memory.h"
#include "viewer/finished_picture.h"
#include "wide/raster/renderer.h"

namespace thimble::tools::viewer {

// How a frame is drawn while the camera moves: with which engine, and every how-many-th pixel, so that it
// takes no longer than it may. Decided from the times of the frames before.

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

// Whether the next frame of an animation is drawn with all of its light: where those before had it in time, and now
// and then to see whether they would.

class LitPace {
 public:
  static constexpr int kLeastPause =
      8;  ///< frames without light after one that was late; twice as many each time
  static constexpr int kMostPause = 512;

  /// For each frame: every so many pixels, 1 or 2, across and down; 0: without light.
  int next() { return pause_left_ > 0 ? (--pause_left_, 0) : step_; }
  /// What the light of the frame took, or had taken when it was given up, of the time that there was.
  void take(double seconds, double most_seconds);

 private:
  int step_ = 2;
  int in_time_ = 0;  // one after the other
  int pause_ = kLeastPause;
  int pause_left_ = 0;
};

class FastFrames {
 public:
  /// Of 1/30 second a frame may take; the rest is for the screen.
  static constexpr double kFrameSeconds = 0.022;

  /// Makes the wide renderer's lists; where they would take more than 2 GiB, frames are drawn ray by ray.
  FastFrames(std::shared_ptr<const OpenScene> scene, bool is_plain, int threads);

  /// Goes on at the pace that another scene's frames had found.
  void keep_pace(const FastFrames& before);
  /// Draws the view of `picture` into `rgb` (its size) and learns from the time it takes.
  void draw(const FinishedPicture& picture, std::vector<std::uint8_t>* rgb);
  /// The same with all of the light, or false, and `rgb` as it was: where the pace wants none, or it was not there
  /// within `most_seconds` of `clock`, read every few rows.
  bool draw_lit(const FinishedPicture& picture, std::vector<std::uint8_t>* rgb, double most_seconds,
                const std::function<double()>& clock);

  /// Of the last frame.
  const std::string& engine() const { return engine_; }
  int step() const { return last_step_; }
  double seconds() const { return seconds_; }

 private:
  bool draw_wide(const FinishedPicture& picture, int step);
  void draw_rays(const FinishedPicture& picture, int step);
  void put_behind(const FinishedPicture& picture, int step);

  std::shared_ptr<const OpenScene> scene_;
  wide::Threads threads_;
  HostMemory list_memory_;
  Arena list_arena_;
  wide::VoxelLists lists_;
  bool has_lists_ = false;
  HostMemory workspace_;
  Pace pace_;
  LitPace lit_pace_;
  std::vector<std::uint8_t> small_;
  std::vector<std::uint8_t> behind_;
  std::vector<std::uint8_t> behind_small_;
  std::string engine_ = "rays";
  int last_step_ = 1;
  double seconds_ = 0;
};

}  // namespace thimble::tools::viewer
