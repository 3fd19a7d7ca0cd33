/// How what takes long says how far it is, and a bar that shows it.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace thimble::tools {

/// Called now and then: fraction done, 0..1. May throw to cancel.
using Progress = std::function<void(double)>;
/// Calls it, unless it is empty.
inline void tell(const Progress& progress, double done) {
  if (progress) {
    progress(done);
  }
}

/// A bar on standard error, when that is a terminal and the work takes long enough to wait for.
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

/// What `work` gives, which says in a bar of that label how far it is.
template <class Work>
auto with_progress(const std::string& label, bool quiet, const Work& work) {
  ProgressBar bar(label, quiet);
  return work([&bar](double done) { bar.update(done); });
}

}  // namespace thimble::tools
