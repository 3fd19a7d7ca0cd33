/// @file fast_frames.h
/// Frames while the camera moves: unlit, by the wide renderer or ray by ray, coarser where the time wants it.
#ifndef THIMBLE_TOOLS_VIEWER_FAST_FRAMES_H
#define THIMBLE_TOOLS_VIEWER_FAST_FRAMES_H

#include <cstdint>
#include <memory>
#include <vector>

#include "scene/host_memory.h"
#include "thimble/base/memory.h"
#include "viewer/finished_picture.h"
#include "viewer/pace.h"
#include "wide/raster/renderer.h"

namespace thimble::tools::viewer {

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

  /// Of the last frame.
  const char* engine() const { return was_wide_ ? "wide" : "rays"; }
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
  std::vector<std::uint8_t> small_;
  std::vector<std::uint8_t> behind_small_;
  bool was_wide_ = false;
  int last_step_ = 1;
  double seconds_ = 0;
};

}  // namespace thimble::tools::viewer

#endif
