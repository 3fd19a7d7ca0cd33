#include "viewer/fast_frames.h"

#include <algorithm>
#include <chrono>

#include "scene/magnify.h"

namespace thimble::tools::viewer {
namespace {

constexpr std::size_t kMostListBytes = std::size_t{2} << 30;
// What a frame has where nothing was hit, until what lies behind is put there: no palette's colour by chance.
constexpr Rgb8 kNothing{1, 0, 2};
constexpr int kBehindStep = kMostStep;

constexpr int kTrialStep = 4;
constexpr int kFramesToSharpen = 6;  // so many that were fast enough
constexpr double kSpare = 0.8;       // of the time, for a finer step

}  // namespace

FastFrames::FastFrames(std::shared_ptr<const OpenScene> scene, bool is_plain, int threads)
    : scene_(std::move(scene)), threads_(threads), pace_(kFrameSeconds, is_plain) {
  const bool may_list = is_plain && !scene_->built->draws_from_file();
  const std::size_t bytes = may_list ? wide::VoxelLists::bytes(scene_->tree()) : 0;
  try {
    if (bytes != 0 && bytes <= kMostListBytes) {
      list_memory_ = HostMemory(bytes + 64);
      list_arena_ = Arena(list_memory_.bytes());
      has_lists_ = wide::VoxelLists::make(scene_->tree(), &list_arena_, &lists_) == Status::kOk;
    }
  } catch (const std::bad_alloc&) {
    // The machine has no room for lists.
  }
  pace_ = Pace(kFrameSeconds, has_lists_);
}

void FastFrames::keep_pace(const FastFrames& before) {
  lit_pace_ = before.lit_pace_;
  if (before.has_lists_ == has_lists_) {
    pace_ = before.pace_;
  }
}

void FastFrames::draw(const FinishedPicture& picture, std::vector<std::uint8_t>* rgb) {
  const auto start = std::chrono::steady_clock::now();
  const int step = pace_.step();
  const std::int32_t columns = thinned_px(picture.width_px(), step);
  const std::int32_t rows = thinned_px(picture.height_px(), step);
  small_.resize(3 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const bool is_wide = pace_.engine() == FastEngine::kWide && draw_wide(picture, step);
  if (!is_wide) {
    draw_rays(picture, step);
  }
  engine_ = is_wide ? "wide" : "rays";
  enlarge(small_, step, picture.width_px(), picture.height_px(), &threads_, rgb);
  last_step_ = step;
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  pace_.take(seconds_);
}

bool FastFrames::draw_lit(const FinishedPicture& picture, std::vector<std::uint8_t>* rgb, double most_seconds,
                          const std::function<double()>& clock) {
  const int step = picture.is_lit() ? lit_pace_.next() : 0;
  if (step == 0) {
    return false;
  }
  const double start = clock();
  const bool in_time = picture.draw(step, &threads_, &small_,
                                    [&](std::int32_t /*rows*/) { return clock() - start <= most_seconds; });
  seconds_ = clock() - start;
  lit_pace_.take(seconds_, most_seconds);
  if (in_time) {
    const std::string gpu = picture.look().gpu();
    engine_ = gpu.empty() ? "lit" : gpu;
    enlarge(small_, step, picture.width_px(), picture.height_px(), &threads_, rgb);
    last_step_ = step;
  }
  return in_time;
}

bool FastFrames::draw_wide(const FinishedPicture& picture, int step) {
  const Camera thin = picture.camera().thinned(step);
  const std::size_t bytes = wide::workspace_bytes(thin.width_px(), thin.height_px(), threads_.count());
  if (workspace_.bytes().size < bytes) {
    workspace_ = HostMemory(bytes);
  }
  Shading shading = picture.quick_shading();
  if (picture.has_behind()) {
    shading.background = kNothing;
  }
  wide::Options options;
  options.threads = &threads_;
  const Band band{Bytes(small_.data(), small_.size()), PixelFormat::kRgb888, 0, 0, thin.height_px()};
  if (wide::render(lists_, thin, shading, band, workspace_.bytes(), nullptr, options) != Status::kOk) {
    return false;
  }
  if (picture.has_behind()) {
    put_behind(picture, step);
  }
  return true;
}

void FastFrames::draw_rays(const FinishedPicture& picture, int step) {
  const std::int32_t rows = thinned_px(picture.height_px(), step);
  const std::size_t row = 3 * static_cast<std::size_t>(thinned_px(picture.width_px(), step));
  threads_.each(rows, [&](int y) {
    picture.draw_quick_row(step, y, small_.data() + row * static_cast<std::size_t>(y));
  });
}

// It changes slowly over the picture, so a few points of it will do.
void FastFrames::put_behind(const FinishedPicture& picture, int step) {
  const std::int32_t width = thinned_px(picture.width_px(), step);
  const std::int32_t height = thinned_px(picture.height_px(), step);
  const std::int32_t rows = thinned_px(height, kBehindStep);
  const std::size_t row = 3 * static_cast<std::size_t>(thinned_px(width, kBehindStep));
  behind_small_.resize(row * static_cast<std::size_t>(rows));
  threads_.each(rows, [&](int y) {
    picture.draw_behind_row(kBehindStep * step, y, behind_small_.data() + row * static_cast<std::size_t>(y));
  });
  enlarge(behind_small_, kBehindStep, width, height, &threads_, &behind_);
  for (std::size_t i = 0; i < small_.size(); i += 3) {
    if (Rgb8{small_[i], small_[i + 1], small_[i + 2]} == kNothing) {
      std::copy_n(behind_.data() + i, 3, small_.data() + i);
    }
  }
}

void LitPace::take(double seconds, double most_seconds) {
  if (seconds > most_seconds && step_ == 1) {
    step_ = 2;
    in_time_ = 0;
  } else if (seconds > most_seconds) {
    in_time_ = 0;
    pause_left_ = pause_;
    pause_ = std::min(2 * pause_, kMostPause);
  } else if (++in_time_ >= kFramesToSharpen) {
    pause_ = kLeastPause;
    step_ = step_ == 2 && 4 * seconds < kSpare * most_seconds ? 1 : step_;
  }
}

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
    engine_ = FastEngine::kWide;  // no faster: what there was stays
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
