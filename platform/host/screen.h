/// Where a program on a desktop shows pictures and hears keys and mouse: one interface for an X11 window, a
/// terminal, and nothing at all. A terminal whose locale is not UTF-8 gets ASCII alone, and half as many lines.
///
/// A program opens a screen, and then, again and again, takes events until there are none and shows a
/// picture. The screen decides how large a pixel becomes; the mouse is reported in pixels of the picture. All
/// of it happens on the thread that calls; nothing runs behind its back, so a window is redrawn and a resized
/// terminal filled only while events are being taken.
///
///     auto screen = host::open_screen(host::ScreenKind::kAuto, {.title = "balls", .width_px = 800, ...});
///     while (open) {
///       while (const auto event = screen->next_event(0)) { ... }
///       screen->show({rgb.data(), 800, 600});
///     }
///
/// Several lines of text can stand below the picture (`set_status`) and on it (`set_overlay`): ASCII, lines
/// divided by '\n'; what does not fit is cut off.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "host/look.h"

namespace thimble::host {

/// A screen that cannot be opened; `what()` is a sentence that says why.
class ScreenError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A picture in memory: r, g, b a pixel, rows from the top, without gaps.
struct Picture {
  const std::uint8_t* rgb = nullptr;
  std::int32_t width_px = 0;
  std::int32_t height_px = 0;
};

/// A key of the keyboard. Keys with a character have its value, letters that of the small one.
enum class Key : std::uint32_t {
  kNone = 0,
  kBackspace = 8,
  kTab = 9,
  kEnter = 13,
  kEscape = 27,
  kSpace = 32,
  kDelete = 127,
  // Beyond Unicode.
  kUp = 0x110000,
  kDown,
  kLeft,
  kRight,
  kHome,
  kEnd,
  kPageUp,
  kPageDown,
  kInsert,
  kShift,
  kControl,
  kAlt,
};
/// The key of an ASCII character: 'A' and 'a' are one key.
constexpr Key key_of(char character) {
  const bool is_large = character >= 'A' && character <= 'Z';
  return static_cast<Key>(static_cast<unsigned char>(character) + (is_large ? 'a' - 'A' : 0));
}

enum class EventKind : std::uint8_t {
  kKeyDown,    ///< `key`; again while it is held, with `repeated`
  kKeyUp,      ///< `key`
  kText,       ///< `character`: what was typed, with shift and layout applied; comes after the kKeyDown
  kMouseMove,  ///< `x_px`, `y_px`, and in `buttons` what is held
  kMouseDown,  ///< `button`, `x_px`, `y_px`
  kMouseUp,    ///< `button`, `x_px`, `y_px`
  kWheel,      ///< `steps`, `x_px`, `y_px`
  kResize,     ///< the screen has another size; `Screen::width_px` and `height_px` say which
  kDrop,       ///< `path`: a file that was dragged here from another program
  kClose,      ///< the user wants to end, or the screen is gone
};

struct Event {
  EventKind kind = EventKind::kClose;
  Key key = Key::kNone;
  bool repeated = false;
  char32_t character = 0;
  /// Pixel of the picture under the pointer, (0, 0) the one at the top left; beyond the picture the numbers
  /// continue, also below 0.
  std::int32_t x_px = 0;
  std::int32_t y_px = 0;
  std::uint8_t button = 0;   ///< 1 left, 2 middle, 3 right
  std::uint8_t buttons = 0;  ///< buttons held after this event: bit 0 left, bit 1 middle, bit 2 right
  std::int32_t steps = 0;    ///< away from the user is above 0
  std::string path{};        ///< of a file; the program only reads it
  bool shift = false;        ///< of the mouse's events: whether shift is held
};

struct ScreenOptions {
  std::string title;
  std::int32_t width_px = 0;  ///< of the pictures that will come
  std::int32_t height_px = 0;
  Look look;               ///< how a pixel is drawn
  std::int32_t scale = 0;  ///< screen pixels a picture pixel; 0: as fits. A terminal goes by its cells.
  std::int32_t status_lines = 0;     ///< lines of text to keep room for below the picture
  std::int32_t status_columns = 80;  ///< of its longest line: a window's text is as large as that allows
};

class Screen {
 public:
  virtual ~Screen() = default;
  Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Shows a picture; it is copied. Its size may change from one to the next.
  virtual void show(const Picture& picture) = 0;
  /// The text below the picture, seen from the next `show` on.
  virtual void set_status(std::string_view text) = 0;
  /// The text on the picture, at its top left, seen from the next `show` on; empty for none.
  virtual void set_overlay(std::string_view text) = 0;
  virtual void set_title(std::string_view text) = 0;
  /// The next event; where there is none yet, waits at most `timeout_ms` for one.
  virtual std::optional<Event> next_event(int timeout_ms) = 0;
  /// The room for pictures, in the finest steps that the screen can show: a window's pixels, a terminal's
  /// half cells. 0 where nothing is shown.
  virtual std::int32_t width_px() const = 0;
  virtual std::int32_t height_px() const = 0;
  /// Why nobody sees it (any more), in words: the window system has ended, or cannot show it. Empty where the user sees it, or
  /// has ended it.
  virtual std::string fault() const { return {}; }
  /// "window", "terminal" or "none".
  virtual const char* name() const = 0;
};

/// kAuto: a window where $DISPLAY works, else the terminal where standard output is one, else none.
enum class ScreenKind : std::uint8_t { kAuto, kWindow, kTerminal, kNone };

/// Throws ScreenError; kAuto and kNone always open something.
std::unique_ptr<Screen> open_screen(ScreenKind kind, const ScreenOptions& options);

/// A screen in a window of the X Window System, by libX11 alone, on $DISPLAY. Throws ScreenError where there is none, or none
/// with 8 bits a colour.
///
/// The picture is magnified by a whole number, as far as the window has room; in a window smaller than the
/// picture it is made smaller. It stays sharp: no pixel is mixed with its neighbour when it is magnified.
std::unique_ptr<Screen> open_window(const ScreenOptions& options);
/// The window system that windows are of; null where the build has none (-DTHIMBLE_WINDOW=OFF), and open_window always
/// throws.
const char* window_kind();

/// A screen in the terminal that the program was started from: two pixels a cell, by the upper half block and its ground.
/// Throws ScreenError where there is none, where its $TERM is `dumb`, and while another one is open.
///
/// It needs a terminal that takes xterm's sequences and UTF-8, which nearly all do, also over ssh and in tmux
/// and screen. Colours have 24 bits where $COLORTERM says `truecolor` or `24bit` (or $TERM ends in
/// `-direct`), else they are the nearest of xterm's 256. Only cells that change are sent. The terminal does
/// not tell when a key is let go: it counts as held for a moment after each press or repeat.
std::unique_ptr<Screen> open_terminal(const ScreenOptions& options);

}  // namespace thimble::host
