#include "viewer/refinement.h"

#include <atomic>
#include <chrono>
#include <cstring>
#include <exception>
#include <mutex>

#include "scene/magnify.h"
#include "wide/threads.h"

namespace thimble::tools::viewer {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPublishTime{60};  // between two states of a pass that are shown

}  // namespace

struct Refinement::State {
  State(std::shared_ptr<const FinishedPicture> shown, int count)
      : picture(std::move(shown)), threads(count) {}

  std::shared_ptr<const FinishedPicture> picture;
  wide::Threads threads;
  std::atomic<bool> cancelled{false};
  std::atomic<bool> ended{false};
  KeptSamples kept;

  std::mutex mutex;  // of what follows
  std::vector<std::uint8_t> rgb;
  std::uint64_t version = 0;
  bool finished = false;
  int step = kMostRefinedStep;
  int percent = 0;
  std::string fault;

  bool draw_coarse(int every);
  bool draw_full(bool is_final);
};

// Whether it was drawn to its end.
bool Refinement::State::draw_coarse(int every) {
  std::vector<std::uint8_t> small;
  if (!picture->draw(
          every, &threads, &small, [&](std::int32_t /*rows*/) { return !cancelled.load(); }, &kept)) {
    return false;
  }
  const std::int32_t width = picture->width_px();
  const std::int32_t height = picture->height_px();
  std::vector<std::uint8_t> full(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<std::uint16_t> work(magnify_work(width));
  magnify_rows(small.data(), every, width, height, 0, thinned_px(height, every), work.data(), full.data());
  const std::scoped_lock lock(mutex);
  rgb.swap(full);
  step = every;
  percent = 100;
  ++version;
  return true;
}

// The rows of the whole picture go over those of the pass before.
bool Refinement::State::draw_full(bool is_final) {
  const std::int32_t height = picture->height_px();
  const std::size_t line = 3 * static_cast<std::size_t>(picture->width_px());
  std::vector<std::uint8_t> full;
  std::int32_t shown = 0;
  Clock::time_point published = Clock::now();
  return picture->draw(
      is_final ? 0 : 1, &threads, &full,
      [&](std::int32_t drawn) {
        if (cancelled.load()) {
          return false;
        }
        if (drawn < height && Clock::now() < published + kPublishTime) {
          return true;
        }
        const std::scoped_lock lock(mutex);
        rgb.resize(full.size());
        std::memcpy(rgb.data() + line * static_cast<std::size_t>(shown),
                    full.data() + line * static_cast<std::size_t>(shown),
                    line * static_cast<std::size_t>(drawn - shown));
        shown = drawn;
        step = is_final ? 0 : 1;
        percent = 100 * drawn / height;
        finished = is_final && drawn == height;
        ++version;
        published = Clock::now();
        return true;
      },
      &kept);
}

void Refinement::run(State* state) {
  try {
    bool goes_on = true;
    for (int every = kMostRefinedStep; goes_on && every > 1; every /= 2) {
      goes_on = state->draw_coarse(every);
    }
    if (goes_on && state->picture->across() > 1) {
      goes_on = state->draw_full(false);
    }
    if (goes_on) {
      state->draw_full(true);
    }
  } catch (const std::exception& error) {
    const std::scoped_lock lock(state->mutex);
    state->fault = error.what();
  }
  state->ended.store(true);
}

Refinement::Refinement(std::shared_ptr<const FinishedPicture> picture, int threads)
    : picture_(picture),
      state_(std::make_unique<State>(std::move(picture), threads)),
      thread_(run, state_.get()) {}

Refinement::~Refinement() {
  cancel();
  thread_.join();
}

void Refinement::cancel() {
  state_->cancelled.store(true);
}

bool Refinement::has_ended() const {
  return state_->ended.load();
}

bool Refinement::is_finished() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->finished && taken_ == state_->version;
}

std::string Refinement::fault() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->fault;
}

bool Refinement::take(std::vector<std::uint8_t>* rgb) {
  const std::scoped_lock lock(state_->mutex);
  if (state_->version == taken_) {
    return false;
  }
  *rgb = state_->rgb;
  taken_ = state_->version;
  taken_step_ = state_->step;
  taken_percent_ = state_->percent;
  return true;
}

}  // namespace thimble::tools::viewer
