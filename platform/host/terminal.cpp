#include <fcntl.h>
#include <langinfo.h>
#include <locale.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "host/canvas.h"
#include "host/terminal_cells.h"
#include "host/terminal_input.h"
#include "host/terminal_mode.h"

namespace thimble::host {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::milliseconds;

// A key counts as held for so long after a press; longer than the time between two repeats.
constexpr Milliseconds kHeld{150};
// A sequence comes in one piece; an escape with nothing after it for so long is the key.
constexpr int kSequenceMs = 30;

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool has_true_color() {
  const std::string color = environment("COLORTERM");
  return color == "truecolor" || color == "24bit" || environment("TERM").ends_with("-direct");
}

// Whether the user's locale writes UTF-8. One that is not installed here is known by its name.
bool has_utf8() {
  if (const locale_t own = ::newlocale(LC_CTYPE_MASK, "", nullptr); own != nullptr) {
    const std::string codes = ::nl_langinfo_l(CODESET, own);
    ::freelocale(own);
    return codes == "UTF-8";
  }
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    if (const std::string value = environment(name); !value.empty()) {
      return value.find("UTF-8") != std::string::npos || value.find("utf8") != std::string::npos;
    }
  }
  return false;
}

// The look in this terminal. Of 256 colours few are alike but for their brightness, except among the greys;
// so a look of one hue becomes one of grey.
Look look_for(const Look& look, bool true_color) {
  if (look.keeps_color || true_color) {
    return look;
  }
  const auto gray = [](Rgb8 color) {
    const std::uint8_t level = gray_of(color);
    return Rgb8{level, level, level};
  };
  Look grays = look;
  grays.unlit = gray(look.unlit);
  grays.lit = gray(look.lit);
  grays.gap = gray(look.gap);
  grays.ground = gray(look.ground);
  return grays;
}

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) {
      ::close(number_);
    }
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return number_; }

 private:
  int number_;
};

bool terminal_is_open = false;

int open_descriptor() {
  if (terminal_is_open) {
    throw ScreenError("the terminal is in use by this program already");
  }
  const std::string kind = environment("TERM");
  if (kind.empty() || kind == "dumb") {
    throw ScreenError("the terminal cannot show pictures: TERM is " + (kind.empty() ? "not set" : kind));
  }
  const int descriptor = ::open("/dev/tty", O_RDWR | O_CLOEXEC | O_NOCTTY);
  if (descriptor < 0) {
    throw ScreenError("there is no terminal");
  }
  if (::tcgetpgrp(descriptor) != ::getpgrp()) {
    ::close(descriptor);
    throw ScreenError("the terminal belongs to another program: this one runs in the background");
  }
  return descriptor;
}

class Terminal final : public CanvasScreen {
 public:
  explicit Terminal(const ScreenOptions& options)
      : CanvasScreen(options),
        descriptor_(open_descriptor()),
        mode_(descriptor_.get()),
        cells_(has_true_color(), has_utf8()) {
    terminal_is_open = true;
    look_ = look_for(look_, has_true_color());
    set_title(options.title);
    measure();
  }

  ~Terminal() override { terminal_is_open = false; }

  void show(const Picture& picture) override {
    keep(picture);
    look_after_signals();
    if (mode_.is_entered()) {
      compose();
    }
  }

  void set_title(std::string_view text) override {
    std::string title;
    for (const char character : text) {
      title += character >= 0x20 && character < 0x7F ? character : ' ';
    }
    send("\x1b]2;" + title + "\x1b\\");
  }

  std::optional<Event> next_event(int timeout_ms) override {
    const Clock::time_point end = Clock::now() + Milliseconds(timeout_ms);
    while (events_.empty() && !lost_) {
      look_after_signals();
      if (!events_.empty()) {
        break;
      }
      Clock::time_point until = end;
      for (const auto& [key, release] : held_) {
        until = std::min(until, release);
      }
      const auto left = std::chrono::ceil<Milliseconds>(until - Clock::now());
      read_input(static_cast<int>(std::max<Milliseconds::rep>(left.count(), 0)));
      release_keys(Clock::now());
      if (Clock::now() >= end) {
        break;
      }
    }
    if (lost_) {
      return Event{.kind = EventKind::kClose};
    }
    return take_event();
  }

  std::int32_t width_px() const override { return cells_.columns(); }
  std::int32_t height_px() const override { return 2 * picture_rows(); }
  const char* name() const override { return "terminal"; }

 private:
  // A terminal of a few rows is for the picture.
  std::int32_t status_rows() const { return cells_.rows() > 2 * status_lines_ ? status_lines_ : 0; }
  std::int32_t picture_rows() const { return cells_.rows() - status_rows(); }
  void measure() {
    winsize size{};
    if (::ioctl(descriptor_.get(), TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) {
      size.ws_col = 80;  // a line without a size, such as a serial one
      size.ws_row = 24;
    }
    cells_.reset(size.ws_col, size.ws_row);
  }

  void compose() {
    canvas_.resize(cells_.columns(), 2 * picture_rows());
    canvas_.fill(0, 0, canvas_.width_px, canvas_.height_px, look_.ground);
    placement_ =
        place(picture_.width_px, picture_.height_px, canvas_.width_px, canvas_.height_px, fixed_scale_);
    placement_.y_px &= ~1;  // pixels of two lines begin with a cell
    if (picture_.rgb != nullptr) {
      draw_picture(&canvas_, placement_, picture_, look_);
    }
    cells_.put_canvas(&canvas_);
    const auto put_lines = [this](std::int32_t column, std::int32_t row, std::int32_t rows,
                                  std::int32_t columns, Rgb8 color, std::string_view text) {
      for (std::int32_t line = 0; line < rows; ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string words(text.substr(0, end));
        words.resize(static_cast<std::size_t>(columns), ' ');
        cells_.put_text(column, row + line, color, kPanel, words);
        text.remove_prefix(std::min(end + 1, text.size()));
      }
    };
    if (!overlay_.empty()) {
      const TextSize size = text_size(overlay_);
      put_lines(1, 0, std::min(size.lines, picture_rows()), size.columns, kOverlayText, overlay_);
    }
    put_lines(0, picture_rows(), status_rows(), cells_.columns(), kPanelText, status_);
    send(cells_.changes());
  }

  // All of it or nothing more ever: what is lost on the way would leave the screen wrong.
  void send(std::string_view text) {
    while (!text.empty() && !lost_) {
      const ssize_t count = ::write(descriptor_.get(), text.data(), text.size());
      if (count > 0) {
        text.remove_prefix(static_cast<std::size_t>(count));
      } else if (errno == EAGAIN) {
        pollfd room{descriptor_.get(), POLLOUT, 0};
        ::poll(&room, 1, -1);
      } else if (errno != EINTR) {
        lost_ = true;
      }
      if (!mode_.is_entered()) {
        return;  // stopped and continued in the background, in the middle of it
      }
    }
  }

  void look_after_signals() {
    const bool reentered = mode_.take_reentered();
    if (!mode_.take_resized() && !reentered) {
      return;
    }
    measure();
    send("\x1b[0m\x1b[2J");
    compose();
    events_.push_back({.kind = EventKind::kResize});
  }

  void read_input(int timeout_ms) {
    const int wait = input_.waits() ? std::max(timeout_ms, kSequenceMs) : timeout_ms;
    const Wakeup wakeup = mode_.wait(wait);
    std::vector<Event> events;
    if (wakeup == Wakeup::kTime && input_.waits()) {
      input_.settle(&events);
    } else if (wakeup == Wakeup::kInput || wakeup == Wakeup::kHangUp) {
      std::array<char, 4096> bytes{};
      const ssize_t count = ::read(descriptor_.get(), bytes.data(), bytes.size());
      if (count > 0) {
        input_.take({bytes.data(), static_cast<std::size_t>(count)}, &events);
      } else if ((count < 0 && errno != EINTR && errno != EAGAIN) || wakeup == Wakeup::kHangUp) {
        lost_ = true;
      }
    }
    for (const Event& event : events) {
      take(event);
    }
  }

  void take(const Event& event) {
    Event taken = event;
    switch (event.kind) {
      case EventKind::kKeyDown: {
        const Clock::time_point until = Clock::now() + kHeld;
        const auto [held, is_new] = held_.insert_or_assign(event.key, until);
        taken.repeated = !is_new;
        break;
      }
      case EventKind::kMouseMove:
      case EventKind::kMouseDown:
      case EventKind::kMouseUp:
      case EventKind::kWheel:
        // The middle of the cell, which is two pixels high.
        taken.x_px =
            to_picture(2 * event.x_px + 1, 2 * placement_.x_px, 2 * placement_.width_px, picture_.width_px);
        taken.y_px =
            to_picture(2 * event.y_px + 1, placement_.y_px, placement_.height_px, picture_.height_px);
        break;
      default:
        break;
    }
    events_.push_back(taken);
  }

  void release_keys(Clock::time_point now) {
    for (auto held = held_.begin(); held != held_.end();) {
      if (held->second > now) {
        ++held;
        continue;
      }
      events_.push_back({.kind = EventKind::kKeyUp, .key = held->first});
      held = held_.erase(held);
    }
  }

  Descriptor descriptor_;
  TerminalMode mode_;
  TerminalInput input_;
  TerminalCells cells_;
  std::map<Key, Clock::time_point> held_;
  bool lost_ = false;
};

}  // namespace

std::unique_ptr<Screen> open_terminal(const ScreenOptions& options) {
  return std::make_unique<Terminal>(options);
}

}  // namespace thimble::host
