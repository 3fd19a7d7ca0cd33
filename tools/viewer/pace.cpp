#include "viewer/pace.h"

#include <algorithm>

namespace thimble::tools::viewer {
namespace {

constexpr int kTrialStep = 4;
constexpr int kFramesToSharpen = 6;  // so many that were fast enough
constexpr double kSpare = 0.8;       // of the time, for a finer step

}  // namespace

Pace::Pace(double frame_seconds, bool may_be_wide)
    : most_seconds_(frame_seconds),
      may_be_wide_(may_be_wide),
      engine_(may_be_wide ? FastEngine::kWide : FastEngine::kRays),
      step_(may_be_wide ? 1 : kTrialStep) {}

void Pace::take(double seconds) {
  if (is_first_) {
    is_first_ = false;
    return;
  }
  mean_seconds_ = frames_ == 0 ? seconds : 0.6 * mean_seconds_ + 0.4 * seconds;
  ++frames_;
  if (engine_ == FastEngine::kRays && may_be_wide_ && wide_seconds_ > 0 && frames_ == 1 &&
      step_ == kTrialStep && seconds >= wide_seconds_) {
    engine_ = FastEngine::kWide;  // no faster: what there was goes on
    wide_seconds_ = 0;
    frames_ = 0;
    return;
  }
  if (engine_ == FastEngine::kWide && !rays_tried_ && step_ >= kTrialStep && mean_seconds_ > most_seconds_) {
    rays_tried_ = true;
    wide_seconds_ = mean_seconds_;
    engine_ = FastEngine::kRays;
    step_ = kTrialStep;
    frames_ = 0;
    return;
  }
  choose_step(mean_seconds_);
}

void Pace::choose_step(double seconds) {
  const int before = step_;
  if (seconds > most_seconds_) {
    step_ = std::min(seconds > 4 * most_seconds_ ? 2 * step_ + 1 : step_ + 1, kMostStep);
  } else if (step_ > 1 && frames_ >= kFramesToSharpen) {
    // As if time went by pixels alone, which is the worst case.
    const double finer = seconds * step_ * step_ / ((step_ - 1.0) * (step_ - 1.0));
    if (finer < kSpare * most_seconds_) {
      --step_;
    }
  }
  if (step_ != before) {
    frames_ = 0;
  }
}

}  // namespace thimble::tools::viewer
