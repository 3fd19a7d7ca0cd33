// thimble particles: the paper's particle world in a window, in a terminal, or unseen.
#include <chrono>
#include <cmath>
#include <tuple>

#include "commands/commands.h"
#include "host/screen.h"
#include "host/y4m.h"
#include "particles/player.h"
#include "particles/world_files.h"
#include "readers/text.h"

namespace thimble::tools {
namespace {

struct PlayOptions {
  host::ScreenKind view = host::ScreenKind::kAuto;
  std::optional<std::uint64_t> steps;  ///< none: as long as it lasts; where nobody watches, kUnseenSteps
  std::int32_t rate = 60;              ///< steps a second that a watcher sees
  int frames_a_second = 0;             ///< of screen and recording; 0: 60 in a window, else 30
  bool figures_in_files = false;
  bool quiet = false;
  std::vector<InputEvent> script;
  OutputFile* recording = nullptr;        ///< moving pictures
  OutputFile* input_recording = nullptr;  ///< events, with an end
};

// Steps where nobody watches and nobody said how many; a longer script is played to its end.
constexpr std::uint64_t kUnseenSteps = 2000;

struct PlayResult {
  PlayedCounts counts;
  double step_seconds = 0;
  std::string figures;       ///< Player::figures at the end
  std::string screen_fault;  ///< a sentence where the screen that somebody watched has gone
};

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int kWorldStatusLines = 3;
constexpr int kStatusColumns = 64;
constexpr std::size_t kToolColumns = 28;
constexpr double kRateTime = 0.5;  // over which the steps a second are counted
constexpr int kIdleMs = 50;
constexpr std::uint64_t kTimedSteps = 64;

host::ScreenOptions screen_options(const ParticleWorld& world) {
  host::ScreenOptions options;
  options.title = "thimble particles";
  options.width_px = world.config().width;
  options.height_px = world.config().height;
  options.status_lines = kWorldStatusLines;
  options.status_columns = kStatusColumns;
  options.look.ground = {24, 26, 32};
  return options;
}

// A run: a world, somebody watching or nobody, events from a script and from a hand.
class ParticleSession {
 public:
  ParticleSession(PopulatedWorld* world, const PlayOptions& options)
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
      options_.recording->write(
          host::y4m_header(config.width, config.height, false, options_.frames_a_second));
      record_frame();
    }
  }

  // Plays until the end. Throws host::ScreenError and OutputError.
  PlayResult run() {
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
    return {player_.counts(), step_seconds_, player_.figures(options_.rate),
            watched() ? screen_->fault() : ""};
  }

 private:
  bool watched() const { return screen_->width_px() != 0; }

  bool has_ended() const {
    if (player_.has_ended() || (options_.steps && player_.counts().steps >= *options_.steps)) {
      return true;
    }
    // A world that stands for ever, unseen.
    return !watched() && player_.stands() && next_event_ == options_.script.size();
  }

  void take(const InputEvent& event) {
    if (options_.input_recording != nullptr && event.kind != host::EventKind::kClose) {
      options_.input_recording->write(to_text(event));
    }
    player_.take(event);
    needs_showing_ = true;
  }

  void take_script() {
    while (next_event_ < options_.script.size() && options_.script[next_event_].tick <= player_.ticks() &&
           !player_.has_ended()) {
      take(options_.script[next_event_++]);
    }
  }

  void take_events(int timeout_ms) {
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
  void advance() {
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

  void record_frame() {
    const ParticleConfig& config = world_->world().config();
    draw_world(*world_, &rgb_);
    if (options_.figures_in_files) {
      draw_figures(config.width, config.height, player_.figures(options_.rate), &rgb_);
    }
    options_.recording->write(host::y4m_color_frame({rgb_.data(), config.width, config.height}));
  }

  void show() {
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
      status = player_.figures(eps_, "  ", true) + "\n" + status;
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
  void watch() {
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

  void run_unseen() {
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

constexpr std::uint64_t kMostInputBytes = std::uint64_t{64} << 20;

// What is written.
enum Output : std::size_t { kInputRecording, kState, kField, kFrame, kRecording, kCounts, kOutputs };

struct ParticlesCommand {
  WorldOptions world;
  PlayOptions play;
  bool count_given = false;
  bool gravity_given = false;
  std::string bodies_path;
  std::string input_path;
  std::array<std::string, kOutputs> paths;
  std::string paced_by;  // the option that asks for a rate, if any
};

void tell_placing(const ParticlesCommand& command, const Placing& placing) {
  std::string text = printable(command.bodies_path) + ": " + grouped(placing.placed) + " bodies placed";
  const auto add = [&](std::uint32_t count, const char* what) {
    if (count != 0) {
      text += ", " + grouped(count) + what;
    }
  };
  add(placing.moved, " of them at the nearest free place");
  add(placing.outside, " left out beyond the box");
  add(placing.crowded, " left out where there was no room");
  std::fprintf(stderr, "%s\n", text.c_str());
}

// Balls that lose nothing keep their energy within 1 per cent where gravity adds at most a quarter of a cell a step
// in each part of a step (measured, src/plane/PARTICLES.md).
void note_coarse_steps(const WorldOptions& world) {
  const double gravity = std::hypot(world.gravity_q16.x, world.gravity_q16.y) / 65536.0;
  const auto is_coarse = [&](int log2) { return gravity / (1 << log2) > 0.25; };
  if (world.bounciness < 1 || !is_coarse(world.substeps_log2)) {
    return;
  }
  int log2 = world.substeps_log2;
  while (log2 < 4 && is_coarse(log2)) {
    ++log2;
  }
  const std::string mend =
      is_coarse(log2) ? "no number of substeps keeps it" : concat("--substeps ", 1 << log2, " keeps it");
  std::fprintf(stderr,
               "note: gravity is strong for the step: energy may change by more than 1 per cent; %s\n",
               mend.c_str());
}

// All but the recordings, which were written as the world went.
void write_files(const ParticlesCommand& command, const PopulatedWorld& populated, const PlayResult& result,
                 const OutputSet& outputs) {
  const ParticleWorld& world = populated.world();
  outputs.write(kState, state_csv(world));
  if (outputs[kField] != nullptr) {
    write_image(outputs[kField], ImageKind::kPbm, field_image(world.field()));
  }
  if (outputs[kFrame] != nullptr) {
    Image image{world.config().width, world.config().height, PixelFormat::kRgb888, {}};
    draw_world(populated, &image.pixels);
    if (command.play.figures_in_files) {
      draw_figures(image.width_px, image.height_px, result.figures, &image.pixels);
    }
    write_picture(outputs[kFrame], command.paths[kFrame], image);
  }
  outputs.write(kCounts, particle_stats(populated, result.counts, result.step_seconds));
}

void run(const ParticlesCommand& given) {
  ParticlesCommand command = given;
  WorldOptions& world_options = command.world;
  refuse_if(world_options.least_diameter > world_options.most_diameter,
            "--min-size: ", world_options.least_diameter, " is more than --max-size, ",
            world_options.most_diameter);
  if (command.play.view == host::ScreenKind::kAuto) {
    const bool for_files =
        command.play.steps || std::any_of(command.paths.begin() + kState, command.paths.end(),
                                          [](const std::string& path) { return !path.empty(); });
    command.play.view = for_files ? host::ScreenKind::kNone : host::ScreenKind::kAuto;
  }
  const bool watched = command.play.view != host::ScreenKind::kNone || !command.paths[kRecording].empty();
  refuse_if(
      command.play.figures_in_files && command.paths[kFrame].empty() && command.paths[kRecording].empty(),
      "--figures: needs --output or --record, whose pictures they are written on");
  // The figures tell the rate of steps.
  refuse_if(!command.paced_by.empty() && !watched &&
                !(command.paced_by == "--eps" && command.play.figures_in_files),
            command.paced_by, ": needs --display or --record, since nothing else keeps to a rate");
  OutputSet outputs({command.paths.begin(), command.paths.end()}, {command.bodies_path, command.input_path});
  command.play.input_recording = outputs[kInputRecording];
  command.play.recording = outputs[kRecording];

  std::optional<Bodies> bodies;
  if (!command.bodies_path.empty()) {
    bodies = about(command.bodies_path, [&] {
      const auto look = [](std::span<const std::uint8_t> first) {
        refuse_zero_bytes(first, "bodies, one a line");
      };
      return read_bodies(load_file(command.bodies_path, kFileLimitBytes, look).text());
    });
    const auto most = static_cast<std::uint32_t>(std::min<std::size_t>(bodies->bodies.size(), kMaxBalls));
    world_options.count = command.count_given ? std::min(world_options.count, most) : most;
    if (!command.gravity_given) {
      world_options.gravity_q16 = {};
    }
  }
  if (!command.input_path.empty()) {
    command.play.script = about(command.input_path, [&] {
      return read_input(load_file(command.input_path, kMostInputBytes).text());
    });
  }
  const auto populated = bodies
                             ? about(command.bodies_path,
                                     [&] { return std::make_unique<PopulatedWorld>(world_options, bodies); })
                             : std::make_unique<PopulatedWorld>(world_options, bodies);
  if (bodies && !command.play.quiet) {
    tell_placing(command, populated->placing());
  }
  if (!command.play.quiet) {
    note_coarse_steps(world_options);
  }
  const PlayResult result = ParticleSession(populated.get(), command.play).run();
  write_files(command, *populated, result, outputs);
  outputs.commit();
  if (!command.play.quiet) {
    std::fputs(particle_summary(*populated, result.counts, result.step_seconds).c_str(), stderr);
  }
  if (!result.screen_fault.empty()) {
    throw OutputError(result.screen_fault);
  }
}

void add_world_options(CLI::App& sub, ParticlesCommand* command) {
  WorldOptions* const world = &command->world;
  add_text_option(
      sub, "--size", "WxH",
      [world](const std::string& text) -> std::string {
        const auto size = parse_pair(text, 'x', 1, kMaxFieldSide);
        if (!size) {
          return "is not a size such as 800x600, each side from 1 to " + std::to_string(kMaxFieldSide);
        }
        std::tie(world->width, world->height) = *size;
        return {};
      },
      "cells of the world, a pixel each")
      ->default_str("800x600");
  add_whole_option(sub, "--count", "N", 0, kMaxBalls / 2, &world->count,
                   "balls at the start; of --bodies, the first N");
  add_whole_option(sub, "--min-size", "D", 1, kMaxBallDiameter, &world->least_diameter,
                   "least diameter of a ball, cells");
  add_whole_option(sub, "--max-size", "D", 1, kMaxBallDiameter, &world->most_diameter,
                   "largest diameter of a ball, cells, up to " + std::to_string(kMaxBallDiameter));
  add_real_option(sub, "--bounciness", "B", 0, 1, &world->bounciness,
                  "the part of its speed that a ball keeps when it bounces, 0 to 1");
  add_text_option(
      sub, "--gravity", "X,Y",
      [world](const std::string& text) -> std::string {
        constexpr double kMost = kMaxAccelerationQ16 / 65536.0;
        std::array<double, 2> pull{};
        if (!parse_reals(text, pull) || std::abs(pull[0]) > kMost || std::abs(pull[1]) > kMost) {
          return "is not two numbers X,Y from " + shortest(-kMost) + " to " + shortest(kMost);
        }
        const auto q16 = [](double value) { return static_cast<std::int32_t>(std::lround(value * 65536)); };
        world->gravity_q16 = {q16(pull[0]), q16(pull[1])};
        return {};
      },
      "gravity in cells a step a step; y down the picture; with --bodies there is none unless given")
      ->default_str("0,0.1");
  add_real_option(sub, "--speed", "V", 0, 8192, &world->speed,
                  "random balls start with up to V cells a step on each axis; of --bodies the fastest has V");
  add_whole_option(sub, "--seed", "S", 0, UINT32_MAX, &world->seed, "of random balls");
  add_path_option(
      sub, "--bodies", "FILE", &command->bodies_path,
      "balls from a file: the number of bodies, the radius of the world, then a line \"x y vx vy m r g b\" "
      "each. The circle of that radius fills the box; area goes with mass, from --max-size down to "
      "--min-size; y is turned; a body whose place is taken goes to the nearest free one; those beyond the "
      "box are left out");
  add_choice_option(sub, "--substeps", {{"1", 0}, {"2", 1}, {"4", 2}, {"8", 3}, {"16", 4}},
                    &world->substeps_log2, "parts that each step is made in");
  add_whole_option(sub, "--subpixel-bits", "N", 1, 15, &world->subpixel_bits,
                   "positions are kept to 2^-N cells");
}

void add_view_options(CLI::App& sub, ParticlesCommand* command) {
  add_whole_option(
      sub, "--steps", "N", 0, 1'000'000'000'000, &command->play.steps,
      "end after N steps (default: where somebody watches, when the window is closed or q is pressed; else "
      "2000, or to the end of a longer --input)");
  add_choice_option(
      sub, "--display",
      {{"auto", host::ScreenKind::kAuto},
       {"none", host::ScreenKind::kNone},
       {"window", host::ScreenKind::kWindow},
       {"terminal", host::ScreenKind::kTerminal}},
      &command->play.view,
      "where the world is shown; auto: nowhere where --steps or a file to write (but --record-input) is "
      "given, else in an X11 window where DISPLAY works, else in the terminal where standard output is one, "
      "else nowhere");
  add_whole_option(
      sub, "--eps", "N", 1, 1'000'000, &command->play.rate,
      "steps a second in a window or terminal, and of a recording; the paper's Eps, which we read so");
  add_whole_option(sub, "--fps", "N", 1, 1000, &command->play.frames_a_second,
                   "pictures a second on the screen and in a recording (default: 60 in a window, else 30)");
  add_path_option(sub, "--input", "SCRIPT", &command->input_path,
                  "play mouse and keys from a file: lines \"TICK: EVENT\", EVENT one of \"key K\" (a "
                  "character, or space up down left right enter tab escape backspace), \"move X,Y\", \"press "
                  "BUTTON X,Y\", \"release BUTTON X,Y\" (left, middle, right), \"wheel STEPS X,Y\" and "
                  "\"end\". A tick is the time of one step, the first is 0; events come before the step of "
                  "their tick; while paused ticks count without steps; # begins a comment line");
  add_path_option(
      sub, "--record-input", "FILE", &command->paths[kInputRecording],
      "write all mouse and key events as such a file: with the same other options it gives the same "
      "world again");
}

void add_file_options(CLI::App& sub, ParticlesCommand* command) {
  add_path_option(
      sub, "--state", "FILE.csv", &command->paths[kState],
      std::string("write the balls at the end: ") + kStateColumns +
          "; centre, velocity and half the diameter in 2^-16 cells. The disc's square begins at cell "
          "floor((x - radius) / 65536 + 1/2); a cell of it belongs to the ball when its centre lies in "
          "the circle in the middle of that square");
  add_path_option(sub, "--field", "FILE.pbm", &command->paths[kField],
                  "write the collision field at the end as P4: 1 where a ball or a wall is");
  add_output_option(
      sub, "-o,--output", "FILE", &command->paths[kFrame],
      [](const std::string& text) { return image_kind(text).has_value(); }, kImageEndings,
      "write the last picture; - is standard output, as PPM");
  add_output_option(
      sub, "--record", "FILE.y4m", &command->paths[kRecording], names_y4m, ".y4m",
      "write moving pictures as YUV4MPEG2, which ffmpeg and mpv play: --fps pictures for --eps steps");
  add_flag(sub, "--figures", &command->play.figures_in_files,
           "also write the figures on these pictures: sizes, bounciness, colliders, Eps");
  add_path_option(sub, "--stats", "FILE.json", &command->paths[kCounts],
                  "write counts, bytes, seconds and the CRC-32 of the state");
  add_flag(sub, "--quiet", &command->play.quiet, "no progress bar and no summary on standard error");
}

}  // namespace

void add_particles(CLI::App& app) {
  CLI::App* sub = add_command(
      app, "particles",
      "The paper's particle world: balls in a field of bits, to play with by mouse and keys (? lists them).");
  ParticlesCommand* const command = options_for<ParticlesCommand>(*sub, run);
  also_check(*sub, [command, sub] {
    command->count_given = is_given(*sub, "--count");
    command->gravity_given = is_given(*sub, "--gravity");
    command->paced_by = is_given(*sub, "--fps") ? "--fps" : is_given(*sub, "--eps") ? "--eps" : "";
  });
  add_world_options(*sub, command);
  add_view_options(*sub, command);
  add_file_options(*sub, command);
}

}  // namespace thimble::tools
