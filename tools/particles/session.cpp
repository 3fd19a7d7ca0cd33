#include "particles/session.h"

#include <algorithm>
#include <chrono>
#include <memory>

#include "host/y4m.h"
#include "particles/world_files.h"

namespace thimble::tools {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int kStatusLines = 3;
constexpr int kStatusColumns = 64;
constexpr std::size_t kToolColumns = 28;
constexpr double kRateTime = 0.5;  // over which the steps a second are counted
constexpr int kIdleMs = 50;
constexpr std::uint64_t kTimedSteps = 64;

class ParticleSession {
 public:
  ParticleSession(PopulatedWorld* world, const PlayOptions& options);
  PlayResult run();

 private:
  bool watched() const { return screen_->width_px() != 0; }
  bool has_ended() const;
  void take(const InputEvent& event);
  void take_script();
  void take_events(int timeout_ms);
  void advance();
  void record_frame();
  void show();
  void watch();
  void run_unseen();

  PopulatedWorld* world_;
  PlayOptions options_;
  Player player_;
  std::unique_ptr<host::Screen> screen_;
  std::size_t next_event_ = 0;
  std::vector<std::uint8_t> rgb_;
  double step_seconds_ = 0;
  double eps_ = 0;
  bool needs_showing_ = true;
  std::string shown_text_;
};

host::ScreenOptions screen_options(const ParticleWorld& world) {
  host::ScreenOptions options;
  options.title = "thimble particles";
  options.width_px = world.config().width;
  options.height_px = world.config().height;
  options.status_lines = kStatusLines;
  options.status_columns = kStatusColumns;
  options.look.ground = {24, 26, 32};
  return options;
}

ParticleSession::ParticleSession(PopulatedWorld* world, const PlayOptions& options)
    : world_(world),
      options_(options),
      player_(world, options.rate),
      screen_(host::open_screen(options.view, screen_options(world->world()))) {
  if (options_.frames_a_second == 0) {
    options_.frames_a_second = screen_->name() == std::string("window") ? 60 : 30;
  }
  if (!watched() && !options_.steps) {
    const std::uint64_t last = options_.script.empty() ? 0 : options_.script.back().tick;
    options_.steps = std::max(kUnseenSteps, last);
  }
  if (options_.recording != nullptr) {
    const ParticleConfig& config = world->world().config();
    options_.recording->write(host::y4m_header(config.width, config.height, false, options_.frames_a_second));
    record_frame();
  }
}

bool ParticleSession::has_ended() const {
  if (player_.has_ended() || (options_.steps && player_.counts().steps >= *options_.steps)) {
    return true;
  }
  // A world that stands for ever, unseen.
  return !watched() && player_.stands() && next_event_ == options_.script.size();
}

void ParticleSession::take(const InputEvent& event) {
  if (options_.input_recording != nullptr && event.kind != InputKind::kEnd) {
    options_.input_recording->write(to_text(event));
  }
  player_.take(event);
  needs_showing_ = true;
}

void ParticleSession::take_script() {
  while (next_event_ < options_.script.size() && options_.script[next_event_].tick <= player_.ticks() &&
         !player_.has_ended()) {
    take(options_.script[next_event_++]);
  }
}

void ParticleSession::take_events(int timeout_ms) {
  for (auto event = screen_->next_event(timeout_ms); event && !player_.has_ended();
       event = screen_->next_event(0)) {
    if (const auto input = input_event(*event, player_.ticks())) {
      take(*input);
    } else {
      needs_showing_ = needs_showing_ || event->kind == host::EventKind::kResize;
    }
  }
}

// A tick with all that belongs to it. The caller has looked at has_ended().
void ParticleSession::advance() {
  take_script();
  if (has_ended()) {
    return;
  }
  needs_showing_ = needs_showing_ || player_.is_moving();
  player_.tick();
  if (options_.recording != nullptr) {
    const auto frames = [&](std::uint64_t ticks) {
      return ticks * static_cast<std::uint64_t>(options_.frames_a_second) /
             static_cast<std::uint64_t>(options_.rate);
    };
    if (frames(player_.ticks()) != frames(player_.ticks() - 1)) {
      record_frame();
    }
  }
}

void ParticleSession::record_frame() {
  const ParticleConfig& config = world_->world().config();
  draw_world(*world_, &rgb_);
  if (options_.figures_in_files) {
    draw_figures(config.width, config.height, player_.figures(options_.rate), &rgb_);
  }
  options_.recording->write(host::y4m_color_frame({rgb_.data(), config.width, config.height}));
}

void ParticleSession::show() {
  const ParticleConfig& config = world_->world().config();
  // A terminal has not the room for text on the picture, so the figures stand below it.
  const bool is_window = screen_->name() == std::string("window");
  const std::string overlay = player_.shows_help()                   ? Player::help()
                              : is_window && player_.shows_figures() ? player_.figures(eps_)
                                                                     : "";
  std::string status = player_.tool_text();
  status.resize(std::max(status.size() + 3, kToolColumns), ' ');
  status += player_.world_text() + "\n? help   1-6 tools   arrows gravity   space pause   q ends";
  if (is_window) {
    status += "\n. one step   r reset   n m b c e g less, capitals more";
  } else if (player_.shows_figures()) {
    status = player_.figures_line(eps_) + "\n" + status;
  }
  const std::string text = overlay + "\f" + status;
  if (!needs_showing_ && text == shown_text_) {
    return;
  }
  if (needs_showing_ || rgb_.empty()) {
    draw_world(*world_, &rgb_);
  }
  screen_->set_overlay(overlay);
  screen_->set_status(status);
  screen_->show({rgb_.data(), config.width, config.height});
  shown_text_ = text;
  needs_showing_ = false;
}

// Ticks go by the clock, pictures by another; what a slow machine does not manage is left out, not made up
// for.
void ParticleSession::watch() {
  const Seconds frame_time(1.0 / options_.frames_a_second);
  Clock::time_point drawn = Clock::now();
  Clock::time_point ticked = drawn;
  Clock::time_point counted = drawn;
  std::uint64_t counted_steps = 0;
  double owed = 0;
  eps_ = player_.rate();
  show();
  while (!has_ended()) {
    const Clock::time_point next = drawn + std::chrono::duration_cast<Clock::duration>(frame_time);
    Clock::time_point now = Clock::now();
    const double left_ms = 1000 * Seconds(next - now).count();
    take_events(std::clamp(static_cast<int>(left_ms), 0, kIdleMs));
    now = Clock::now();
    if (now < next) {
      continue;
    }
    drawn = std::max(next, now - std::chrono::duration_cast<Clock::duration>(frame_time));
    owed += Seconds(now - ticked).count() * player_.rate();
    ticked = now;
    // A tenth of a second at most: after that this machine is too slow, or was stopped.
    owed = std::min(owed, std::max(1.0, 0.1 * player_.rate()));
    const Clock::time_point begin = Clock::now();
    std::uint64_t made = 0;
    while (owed >= 1 && !has_ended()) {
      advance();
      owed -= 1;
      if (++made % kTimedSteps == 0 && Seconds(Clock::now() - begin) > frame_time) {
        owed = 0;
      }
    }
    const Clock::time_point end = Clock::now();
    step_seconds_ += Seconds(end - begin).count();
    const double since = Seconds(end - counted).count();
    if (since >= kRateTime) {
      eps_ = static_cast<double>(player_.counts().steps - counted_steps) / since;
      counted_steps = player_.counts().steps;
      counted = end;
    }
    show();
  }
}

void ParticleSession::run_unseen() {
  ProgressBar bar("steps", options_.quiet);
  const Clock::time_point begin = Clock::now();
  while (!has_ended()) {
    advance();
    if (player_.ticks() % 256 == 0) {
      bar.update(static_cast<double>(player_.counts().steps) / static_cast<double>(*options_.steps));
    }
  }
  step_seconds_ = Seconds(Clock::now() - begin).count();
}

PlayResult ParticleSession::run() {
  if (watched()) {
    watch();
  } else {
    run_unseen();
  }
  if (options_.input_recording != nullptr) {
    InputEvent end;
    end.tick = player_.ticks();
    options_.input_recording->write(to_text(end));
  }
  return {player_.counts(), step_seconds_, player_.figures(options_.rate), watched() ? screen_->fault() : ""};
}

}  // namespace

PlayResult play(PopulatedWorld* world, const PlayOptions& options) {
  return ParticleSession(world, options).run();
}

}  // namespace thimble::tools
