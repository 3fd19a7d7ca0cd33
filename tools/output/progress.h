/// @file progress.h
/// A progress bar on standard error, when that is a terminal and the work takes long enough to wait for.
#ifndef THIMBLE_TOOLS_OUTPUT_PROGRESS_H
#define THIMBLE_TOOLS_OUTPUT_PROGRESS_H

#include <chrono>
#include <string>

namespace thimble::tools {

class ProgressBar {
 public:
  /// Shows nothing when `quiet`, when standard error is no terminal, or within the first half second.
  ProgressBar(std::string label, bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `done`: 0..1. Draws at most ten times a second.
  void update(double done);
  /// Takes the bar off the screen, so that a line can be printed.
  void clear();

 private:
  std::string label_;
  bool active_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace thimble::tools

#endif
