#include "commands/sim_session.h"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <utility>

#include "host/y4m.h"
#include "output/units.h"
#include "port.h"

namespace thimble::tools {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::milliseconds;

constexpr Milliseconds kStatusTime{100};   // between two looks at the memory
constexpr Milliseconds kEndingTime{2000};  // that an application may take to end after the request
constexpr Milliseconds kWatchedTime{40};   // the same where somebody watches, who wants to be gone
constexpr int kEventsMs = 5;               // between two looks at keys and window while it draws
constexpr int kStatusLines = 4;
constexpr const char* kPointerKeys = "mouse  touches; another button drops a ball\n";
constexpr std::size_t kKeptOutputBytes = 65536;

struct KeyButton {
  host::Key key;
  std::uint32_t button;
};
constexpr std::array kKeyButtons{
    KeyButton{host::Key::kUp, port::kUp},        KeyButton{host::key_of('w'), port::kUp},
    KeyButton{host::Key::kDown, port::kDown},    KeyButton{host::key_of('s'), port::kDown},
    KeyButton{host::Key::kLeft, port::kLeft},    KeyButton{host::key_of('a'), port::kLeft},
    KeyButton{host::Key::kRight, port::kRight},  KeyButton{host::key_of('d'), port::kRight},
    KeyButton{host::Key::kSpace, port::kSelect}, KeyButton{host::Key::kEnter, port::kSelect},
};

std::uint32_t button_of(host::Key key) {
  for (const KeyButton& pair : kKeyButtons) {
    if (pair.key == key) {
      return pair.button;
    }
  }
  return 0;
}

// What a typed character sends over the UART, or nothing: the keys that are buttons send theirs with shift.
std::optional<std::uint8_t> byte_of(char32_t character) {
  if (character >= 0x80) {
    return std::nullopt;
  }
  const char typed = static_cast<char>(character);
  if (button_of(host::key_of(typed)) == 0) {
    return static_cast<std::uint8_t>(typed);
  }
  const bool is_large = typed >= 'A' && typed <= 'Z';
  return is_large ? std::optional<std::uint8_t>(static_cast<std::uint8_t>(typed - 'A' + 'a')) : std::nullopt;
}

host::Theme theme_of(platform::Screen screen) {
  return screen == platform::Screen::kOled  ? host::Theme::kOled
         : screen == platform::Screen::kLcd ? host::Theme::kLcd
                                            : host::Theme::kPlain;
}

// The last line that has anything in it, as far as it can be printed.
std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of("\r\n");
  if (end == std::string::npos) {
    return {};
  }
  const std::size_t before = text.find_last_of("\r\n", end);
  std::string line = text.substr(before == std::string::npos ? 0 : before + 1, end - before);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7F; }, '.');
  return line;
}

std::unique_ptr<host::Screen> open(const SessionOptions& options, host::ScreenKind kind) {
  const platform::BoardFacts& board = *options.board;
  host::ScreenOptions screen;
  screen.title = std::string("thimble sim: ") + options.application->name + " on " + board.name;
  screen.width_px = board.width_px;
  screen.height_px = board.height_px;
  screen.look = host::look_of(options.theme.value_or(theme_of(board.screen)), board.format);
  screen.scale = options.scale;
  screen.status_lines = kStatusLines;
  return host::open_screen(kind, screen);
}

class SimSession {
 public:
  explicit SimSession(const SessionOptions& options)
      : options_(options),
        screen_(open(options, screen_kind())),
        simulation_({options.board, connected(), options.scene, options.application->run, options.hold_fps,
                     options.painter}) {
    uart_in_pane_ = screen_->name() == std::string("terminal") && ::isatty(STDOUT_FILENO) != 0;
    if (uart_in_pane_ && ::isatty(STDIN_FILENO) != 0) {
      input_is_open_ = false;  // it is the screen that reads there
    }
    if (!watched() && options_.frames == 0 && options_.application->is_to_watch) {
      options_.frames = 1;  // or it would run for ever, unseen
    }
    if (options_.recording != nullptr) {
      const platform::BoardFacts& board = *options_.board;
      options_.recording->write(
          host::y4m_header(board.width_px, board.height_px, is_gray(board.format), options_.frames_a_second));
    }
  }

  SessionResult run() {
    const auto frame_time = std::chrono::nanoseconds(1'000'000'000 / options_.frames_a_second);
    Clock::time_point due = Clock::now();
    host::Moment moment = host::Moment::kNothing;
    take_script();  // frame 0 may come without a question
    while (moment != host::Moment::kEnded && !time_is_up() && !leaves_frame()) {
      moment = simulation_.wait(kEventsMs);
      pass_output();
      take_events(0);
      if (moment == host::Moment::kAsks) {
        take_picture();
        while (watched() && Clock::now() < due && !closing_at_) {
          const auto left = std::chrono::ceil<Milliseconds>(due - Clock::now());
          take_events(static_cast<int>(std::max<Milliseconds::rep>(left.count(), 0)));
        }
        due = std::max(due + frame_time, Clock::now());
        take_script();
        typed_ += pointed_;
        pointed_.clear();
        take_input();
        const bool enough = options_.frames != 0 && simulation_.frames_asked() >= options_.frames;
        simulation_.answer(!enough && !is_stuck() && !closing_at_);
      } else {
        take_input();
      }
    }
    pass_output();

    SessionResult result;
    if (moment == host::Moment::kEnded) {
      take_picture();  // one that was drawn after the last question
      result.status = simulation_.status();
      result.fault = simulation_.fault();
      look(&result);
      result.use = simulation_.use();
    } else if (leaves_frame()) {
      result = seen_;
    } else {
      result.status = port::kFaultStatus;
      result.fault = "it did not end within two seconds of the request";
    }
    // Frames that came between two questions cannot be told apart.
    result.mean_frame_seconds = frames_ == 0 || frames_ != pictures_ ? 0 : seconds_ / frames_;
    const bool was_hidden = uart_in_pane_;
    result.screen_fault = watched() ? screen_->fault() : "";
    screen_.reset();
    if (was_hidden) {
      std::fputs(output_.c_str(), stdout);
    }
    return result;
  }

 private:
  // A board without a display gets one when somebody asks for it.
  host::ScreenKind screen_kind() const {
    const bool nothing_to_see =
        options_.board->screen == platform::Screen::kNone || !options_.application->is_to_watch;
    return options_.display == host::ScreenKind::kAuto && nothing_to_see ? host::ScreenKind::kNone
                                                                         : options_.display;
  }

  bool connected() const {
    return options_.board->screen != platform::Screen::kNone || screen_kind() != host::ScreenKind::kNone;
  }
  bool watched() const { return screen_->width_px() != 0; }

  void take(const host::Event& event) {
    switch (event.kind) {
      case host::EventKind::kKeyDown:
        held_ |= button_of(event.key);
        if (event.key == host::Key::kEscape) {
          closing_at_ = Clock::now();
        }
        break;
      case host::EventKind::kKeyUp:
        held_ &= ~button_of(event.key);
        break;
      case host::EventKind::kText:
        if (event.character == '?') {
          shows_keys_ = !shows_keys_;
          screen_->set_overlay(shows_keys_ ? std::string("arrows, WASD, space  buttons\n") +
                                                 (options_.application->takes_pointer ? kPointerKeys : "") +
                                                 options_.application->keys + "Esc  ends   ?  these keys"
                                           : std::string());
          break;
        }
        if (const auto byte = byte_of(event.character)) {
          typed_ += static_cast<char>(*byte);
        }
        break;
      case host::EventKind::kClose:
        closing_at_ = closing_at_.value_or(Clock::now());
        break;
      case host::EventKind::kMouseDown:
        point(event.button == 1 ? '@' : '!', event);
        break;
      case host::EventKind::kMouseMove:
        if ((event.buttons & 1U) != 0) {
          point('@', event);
        }
        break;
      default:
        break;
    }
    simulation_.set_buttons(held_ | scripted_);
  }

  // A pixel of the picture. One a frame: the last that was pressed on or moved over.
  void point(char what, const host::Event& event) {
    const platform::BoardFacts& board = *options_.board;
    if (options_.application->takes_pointer && event.x_px >= 0 && event.y_px >= 0 &&
        event.x_px < board.width_px && event.y_px < board.height_px) {
      pointed_ = concat(what, event.x_px, ",", event.y_px, ".");
    }
  }

  void take_events(int timeout_ms) {
    for (auto event = screen_->next_event(timeout_ms); event; event = screen_->next_event(0)) {
      take(*event);
      if (event->kind == host::EventKind::kClose) {
        break;  // a screen that is gone says so again and again
      }
    }
  }

  // Standard input, as much as is there, and what was typed.
  void take_input() {
    // In the background a terminal must not be read: it would stop this program.
    if (input_is_open_ && (::isatty(STDIN_FILENO) == 0 || ::tcgetpgrp(STDIN_FILENO) == ::getpgrp())) {
      pollfd input{STDIN_FILENO, POLLIN, 0};
      std::array<char, 512> bytes{};
      while (typed_.size() < bytes.size() && ::poll(&input, 1, 0) > 0) {
        const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
        if (count <= 0) {
          input_is_open_ = false;
          break;
        }
        typed_.append(bytes.data(), static_cast<std::size_t>(count));
      }
    }
    std::size_t taken = 0;
    while (taken < typed_.size() && simulation_.type(static_cast<std::uint8_t>(typed_[taken]))) {
      ++taken;
    }
    typed_.erase(0, taken);
  }

  // Whether the application has asked twice for one frame, knowing all that will ever be typed: nothing can come
  // that it waits for. What computes between two questions is not stuck.
  bool is_stuck() {
    const bool knows_all = !watched() && !input_is_open_ && typed_.empty() && simulation_.has_read_all();
    const auto before =
        std::exchange(knowing_all_, knows_all ? std::optional(simulation_.frames_asked()) : std::nullopt);
    return knows_all && before == knowing_all_;
  }

  void pass_output() {
    const std::string text = simulation_.take_output();
    if (text.empty()) {
      return;
    }
    output_ += text;
    if (output_.size() > kKeptOutputBytes) {
      output_.erase(0, output_.size() - kKeptOutputBytes);
    }
    if (!uart_in_pane_) {
      std::fwrite(text.data(), 1, text.size(), stdout);
      std::fflush(stdout);
    }
  }

  void take_script() {
    for (const KeyScript::Step& step : options_.keys.take(simulation_.frames_asked())) {
      scripted_ = (scripted_ | step.press) & ~step.release;
      typed_ += step.typed;
    }
    simulation_.set_buttons(held_ | scripted_);
  }

  void take_picture() {
    if (simulation_.display().pictures() == pictures_) {
      return;
    }
    pictures_ = simulation_.display().pictures();
    ++frames_;
    seconds_ += simulation_.frame_seconds();
    const Image picture = shown_image();
    const bool as_gray = options_.recording != nullptr && is_gray(picture.format);
    if (as_gray) {
      options_.recording->write(host::y4m_gray_frame(converted(picture, PixelFormat::kGray8).pixels));
    }
    if (!watched() && (as_gray || options_.recording == nullptr)) {
      return;
    }
    const Image rgb = converted(picture, PixelFormat::kRgb888);
    const host::Picture shown{rgb.pixels.data(), picture.width_px, picture.height_px};
    if (options_.recording != nullptr && !as_gray) {
      options_.recording->write(host::y4m_color_frame(shown));
    }
    if (watched()) {
      look(&seen_);
      update_status();
      screen_->show(shown);
    }
  }

  void look(SessionResult* to) const {
    to->pictures = simulation_.display().pictures();
    to->rows_sent = simulation_.display().rows_sent();
    to->rows_kept = simulation_.display().rows_kept();
    to->picture = shown_image();
  }
  Image shown_image() const {
    const host::PackedPicture& picture = simulation_.display().picture();
    return {picture.width_px, picture.height_px, picture.format, picture.bytes};
  }

  void update_status() {
    const Clock::time_point now = Clock::now();
    if (now < status_at_ + kStatusTime && pictures_ > 1) {
      return;
    }
    status_at_ = now;
    shown_seconds_ = shown_seconds_ == 0 ? simulation_.frame_seconds()
                                         : 0.75 * shown_seconds_ + 0.25 * simulation_.frame_seconds();
    const std::string line = last_line(output_);
    seen_.use = simulation_.use();
    screen_->set_status(std::string(options_.board->name) + "  " + options_.application->name + "  frame " +
                        grouped(pictures_) + "  " + fixed(1000 * shown_seconds_, 2) +
                        " ms a frame on this machine\n" + memory_text(seen_.use, "\n") + "\n" +
                        (line.empty() || !uart_in_pane_
                             ? (options_.application->takes_pointer
                                    ? "mouse: touch, drop   arrows or WASD, space   ?: keys   Esc ends"
                                    : "buttons: arrows or WASD, space   ?: keys   Esc ends")
                             : "UART: " + line));
  }

  // Somebody who watches does not wait for the frame that is being drawn: the picture before it is the last.
  bool leaves_frame() const { return closing_at_ && watched() && Clock::now() > *closing_at_ + kWatchedTime; }
  bool time_is_up() const { return closing_at_ && Clock::now() > *closing_at_ + kEndingTime; }

  SessionOptions options_;
  std::unique_ptr<host::Screen> screen_;
  bool uart_in_pane_ = false;
  bool input_is_open_ = true;
  std::optional<std::uint32_t> knowing_all_;  // the frame asked for, while nothing is left to read
  std::string typed_;                         // not taken by the application yet
  std::string pointed_;         // where the mouse was since the last frame, as the application takes it
  std::string output_;          // the end of what came over the UART
  std::uint32_t held_ = 0;      // by hand
  std::uint32_t scripted_ = 0;  // by the script
  bool shows_keys_ = false;
  std::optional<Clock::time_point> closing_at_;
  Clock::time_point status_at_;
  std::uint32_t pictures_ = 0;
  SessionResult seen_;  // as of the last picture that was seen, where somebody watches
  std::uint32_t frames_ = 0;
  double seconds_ = 0;
  double shown_seconds_ = 0;
  host::Simulation simulation_;
};

}  // namespace

std::string memory_text(const host::MemoryUse& use, const char* separator) {
  const auto share = [](std::uint32_t used, std::uint32_t limit) {
    return concat(grouped(used), " of ", grouped(limit), " bytes (",
                  limit == 0 ? 0 : std::uint64_t{100} * used / limit, "%)");
  };
  return "RAM " + share(use.ram_bytes, use.ram_limit_bytes) + "  flash: scene " +
         share(use.flash_bytes, use.flash_limit_bytes) + separator + "stack " + grouped(use.stack_bytes) +
         " bytes in this machine's frames, not the chip's; board: " + grouped(use.stack_limit_bytes);
}

SessionResult run_session(const SessionOptions& options) {
  return SimSession(options).run();
}

}  // namespace thimble::tools
