/// @file refinement.h
/// From coarse to fine while nothing moves: the finished picture of a view, drawn on other threads.
///
/// Every 8th, 4th and 2nd pixel with all of the light, stretched; every pixel; then the picture with its
/// samples, row by row from the top. Whoever shows it takes what there is whenever there is more. Cancelling
/// takes no time: the threads notice at their next row.
#ifndef THIMBLE_TOOLS_VIEWER_REFINEMENT_H
#define THIMBLE_TOOLS_VIEWER_REFINEMENT_H

#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "viewer/finished_picture.h"

namespace thimble::tools::viewer {

class Refinement {
 public:
  Refinement(std::shared_ptr<const FinishedPicture> picture, int threads);
  /// Cancels, and waits for the rows that are being drawn.
  ~Refinement();
  Refinement(const Refinement&) = delete;
  Refinement& operator=(const Refinement&) = delete;

  void cancel();
  /// Whether its threads have ended: finished, cancelled or failed.
  bool has_ended() const;
  /// Whether what `take` gives now is the finished picture.
  bool is_finished() const;
  /// What the drawing threw, as a sentence; empty for nothing.
  std::string fault() const;
  /// Copies the picture as far as it is into `rgb`; false, and nothing done, where there is nothing new.
  bool take(std::vector<std::uint8_t>* rgb);
  /// Of the picture that `take` took last: every how-many-th pixel it has, 0 for the finished one; and the
  /// share of it that is drawn, in per cent.
  int step() const { return taken_step_; }
  int percent() const { return taken_percent_; }
  const FinishedPicture& picture() const { return *picture_; }

 private:
  struct State;
  static void run(State* state);

  std::shared_ptr<const FinishedPicture> picture_;
  std::unique_ptr<State> state_;
  std::uint64_t taken_ = 0;
  int taken_step_ = kMostRefinedStep;
  int taken_percent_ = 0;
  std::thread thread_;

  static constexpr int kMostRefinedStep = 8;
};

}  // namespace thimble::tools::viewer

#endif
