// Xlib.h has macros of common names: these come before it.
#include "host/canvas.h"
#include "host/uri_list.h"

#include <X11/XKBlib.h>
#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>
#include <poll.h>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace thimble::host {
namespace {

constexpr long kVersion = 5;
constexpr long kOldestVersion = 3;
constexpr long kMostWords = 1 << 16;  // of a property that is read, 4 bytes each

// What XGetWindowProperty gives; freed with it.
struct Property {
  Property(::Display* display, ::Window window, Atom name, Bool removes, Atom type) {
    Atom found = 0;
    unsigned long left = 0;
    if (XGetWindowProperty(display, window, name, 0, kMostWords, removes, type, &found, &bits, &count, &left,
                           &data) != Success ||
        found != type) {
      count = 0;
    }
  }
  ~Property() {
    if (data != nullptr) {
      XFree(data);
    }
  }
  Property(const Property&) = delete;
  Property& operator=(const Property&) = delete;

  int bits = 0;
  unsigned long count = 0;
  unsigned char* data = nullptr;
};

// Files that are dragged onto a window from another program: the receiver's part of XDND, version 5, the protocol of file
// managers (freedesktop.org). Nothing is written: the window's program gets a path.
class WindowDrops {
 public:
  /// Says to other programs that files may be dropped on the window.
  void announce(::Display* display, ::Window window) {
    display_ = display;
    window_ = window;
    enter_ = atom("XdndEnter");
    position_ = atom("XdndPosition");
    status_ = atom("XdndStatus");
    leave_ = atom("XdndLeave");
    drop_ = atom("XdndDrop");
    finished_ = atom("XdndFinished");
    selection_ = atom("XdndSelection");
    copy_ = atom("XdndActionCopy");
    types_ = atom("XdndTypeList");
    uri_list_ = atom("text/uri-list");
    const Atom version = kVersion;
    XChangeProperty(display, window, atom("XdndAware"), XA_ATOM, 32, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(&version), 1);
  }

  /// Whether the event is part of a drag or drop; then it has been answered. `path` gets the first file of a
  /// drop that is complete.
  bool take(const XEvent& event, std::optional<std::string>* path) {
    if (event.type == SelectionNotify && event.xselection.selection == selection_ && source_ != 0) {
      *path = first_file_of(received(event.xselection));
      answer(finished_, *path ? 1 : 0, *path ? copy_ : 0);
      source_ = 0;
      return true;
    }
    if (event.type != ClientMessage) {
      return false;
    }
    const XClientMessageEvent& message = event.xclient;
    const Atom type = message.message_type;
    if (type == enter_) {
      enter(message);
      return true;
    }
    if (type != position_ && type != drop_ && type != leave_) {
      return false;
    }
    if (source_ == 0 || static_cast<::Window>(message.data.l[0]) != source_) {
      return true;  // of no drag that has entered
    }
    if (type == position_) {
      answer(status_, has_files_ ? 1 : 0, has_files_ ? copy_ : 0);
    } else if (type == drop_) {
      ask_for_files(message);
    } else {
      source_ = 0;
    }
    return true;
  }

 private:
  Atom atom(const char* name) const { return XInternAtom(display_, name, False); }
  // What is dragged is offered in up to three types in the message, or else in a list at the source's window.
  void enter(const XClientMessageEvent& message) {
    const long version = message.data.l[1] >> 24 & 0xFF;
    source_ = version >= kOldestVersion ? static_cast<::Window>(message.data.l[0]) : 0;
    has_files_ = false;
    if ((message.data.l[1] & 1) == 0) {
      for (int i = 2; i < 5; ++i) {
        has_files_ = has_files_ || static_cast<Atom>(message.data.l[i]) == uri_list_;
      }
      return;
    }
    const Property offered(display_, source_, types_, False, XA_ATOM);
    const Atom* const types = reinterpret_cast<const Atom*>(offered.data);
    for (unsigned long i = 0; offered.bits == 32 && i < offered.count; ++i) {
      has_files_ = has_files_ || types[i] == uri_list_;
    }
  }

  void ask_for_files(const XClientMessageEvent& message) {
    if (!has_files_) {
      answer(finished_, 0, 0);
      source_ = 0;
      return;
    }
    XConvertSelection(display_, selection_, uri_list_, selection_, window_,
                      static_cast<Time>(message.data.l[2]));
  }

  std::string received(const XSelectionEvent& event) const {
    if (event.property == 0) {
      return {};
    }
    const Property list(display_, window_, event.property, True, uri_list_);
    return list.bits == 8 ? std::string(reinterpret_cast<const char*>(list.data), list.count) : std::string();
  }

  void answer(Atom type, long accepts, Atom action) const {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = source_;
    event.xclient.message_type = type;
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(window_);
    event.xclient.data.l[1] = accepts;
    // Of a status: no rectangle within which the source need not ask again, then the action; of a finish: the
    // action.
    event.xclient.data.l[type == status_ ? 4 : 2] = static_cast<long>(action);
    XSendEvent(display_, source_, False, NoEventMask, &event);
  }

  ::Display* display_ = nullptr;
  ::Window window_ = 0;
  ::Window source_ = 0;  // of the drag; 0: none
  bool has_files_ = false;
  Atom enter_ = 0;
  Atom position_ = 0;
  Atom status_ = 0;
  Atom leave_ = 0;
  Atom drop_ = 0;
  Atom finished_ = 0;
  Atom selection_ = 0;
  Atom copy_ = 0;
  Atom types_ = 0;
  Atom uri_list_ = 0;
};

constexpr std::int32_t kMarginPx = 8;         // around the text
constexpr std::int32_t kFirstWidthPx = 1024;  // what a new window's picture may take
constexpr std::int32_t kFirstHeightPx = 640;
constexpr std::int32_t kLeastWidthPx = 512;  // so that a status line has room

Key key_from(KeySym symbol) {
  struct Pair {
    KeySym symbol;
    Key key;
  };
  constexpr std::array<Pair, 26> kPairs{{
      {XK_Up, Key::kUp},
      {XK_Down, Key::kDown},
      {XK_Left, Key::kLeft},
      {XK_Right, Key::kRight},
      {XK_KP_Up, Key::kUp},
      {XK_KP_Down, Key::kDown},
      {XK_KP_Left, Key::kLeft},
      {XK_KP_Right, Key::kRight},
      {XK_Home, Key::kHome},
      {XK_End, Key::kEnd},
      {XK_Page_Up, Key::kPageUp},
      {XK_Page_Down, Key::kPageDown},
      {XK_Insert, Key::kInsert},
      {XK_Delete, Key::kDelete},
      {XK_BackSpace, Key::kBackspace},
      {XK_Tab, Key::kTab},
      {XK_Return, Key::kEnter},
      {XK_KP_Enter, Key::kEnter},
      {XK_Escape, Key::kEscape},
      {XK_Shift_L, Key::kShift},
      {XK_Shift_R, Key::kShift},
      {XK_Control_L, Key::kControl},
      {XK_Control_R, Key::kControl},
      {XK_Alt_L, Key::kAlt},
      {XK_Alt_R, Key::kAlt},
      {XK_KP_Space, Key::kSpace},
  }};
  for (const Pair& pair : kPairs) {
    if (pair.symbol == symbol) {
      return pair.key;
    }
  }
  if (symbol >= XK_space && symbol <= XK_asciitilde) {
    return key_of(static_cast<char>(symbol));
  }
  return Key::kNone;
}

// A channel of 8 bits, moved to where the visual has it.
std::uint32_t in_mask(std::uint8_t value, unsigned long mask) {
  const auto bits = static_cast<std::uint32_t>(mask);
  if (bits == 0) {
    return 0;
  }
  const int low = std::countr_zero(bits);
  const int width = std::popcount(bits);
  const std::uint32_t scaled = width >= 8 ? static_cast<std::uint32_t>(value) << (width - 8)
                                          : static_cast<std::uint32_t>(value) >> (8 - width);
  return scaled << low;
}

// A request that fails is no reason to end the program, as Xlib would; the next one may do.
std::atomic<int> failed_requests{0};
int on_error(::Display* /*display*/, XErrorEvent* /*error*/) {
  ++failed_requests;
  return 0;
}

class Window final : public CanvasScreen {
 public:
  explicit Window(const ScreenOptions& options)
      : CanvasScreen(options), status_columns_(options.status_columns) {
    display_ = XOpenDisplay(nullptr);
    if (display_ == nullptr) {
      const char* name = std::getenv("DISPLAY");
      throw ScreenError(name == nullptr || *name == 0
                            ? std::string("there is no window system: DISPLAY is not set")
                            : "the display " + std::string(name) + " cannot be opened");
    }
    server_ = DisplayString(display_);
    // Without these two the library ends the program when the server goes, in its own words.
    XSetIOErrorHandler([](Display*) { return 0; });
    XSetIOErrorExitHandler(
        display_, [](Display*, void* window) { static_cast<Window*>(window)->lost_ = true; }, this);
    try {
      choose_visual();
      open(options);
    } catch (...) {
      XCloseDisplay(display_);
      throw;
    }
  }

  ~Window() override {
    // On a connection that is lost these only give back what the library keeps here.
    XFreeGC(display_, context_);
    if (!closed_) {
      XDestroyWindow(display_, window_);
    }
    XFreeColormap(display_, colors_);
    XCloseDisplay(display_);
  }

  void show(const Picture& picture) override {
    keep(picture);
    compose();
    send();
  }

  void set_title(std::string_view text) override {
    if (lost_ || closed_) {
      return;
    }
    const std::string title(text);
    XStoreName(display_, window_, title.c_str());
    const auto* bytes = reinterpret_cast<const unsigned char*>(title.data());
    XChangeProperty(display_, window_, XInternAtom(display_, "_NET_WM_NAME", False),
                    XInternAtom(display_, "UTF8_STRING", False), 8, PropModeReplace, bytes,
                    static_cast<int>(title.size()));
  }

  std::optional<Event> next_event(int timeout_ms) override {
    for (int round = 0; round < 2 && events_.empty(); ++round) {
      while (!lost_ && XPending(display_) > 0) {
        XEvent event{};
        XNextEvent(display_, &event);
        take(event);
      }
      if (needs_sending_) {
        send();
      }
      if (lost_ || (closed_ && events_.empty())) {
        return Event{.kind = EventKind::kClose};
      }
      if (events_.empty() && round == 0 && timeout_ms > 0) {
        pollfd connection{ConnectionNumber(display_), POLLIN, 0};
        ::poll(&connection, 1, timeout_ms);
      }
    }
    return take_event();
  }

  std::int32_t width_px() const override { return canvas_.width_px; }
  std::int32_t height_px() const override { return canvas_.height_px - panel_px(); }
  std::string fault() const override { return lost_ ? "the display " + server_ + " has ended" : ""; }
  const char* name() const override { return "window"; }

 private:
  std::int32_t text_scale() const {
    return canvas_.width_px >= 2 * kGlyphWidthPx * status_columns_ + 2 * kMarginPx ? 2 : 1;
  }
  // Twice as large where there is room for it.
  std::int32_t overlay_scale() const {
    const TextSize size = text_size(overlay_);
    const bool fits = 2 * (size.columns * kGlyphWidthPx + kMarginPx) <= canvas_.width_px &&
                      2 * (size.lines * kGlyphHeightPx + kMarginPx) <= height_px();
    return fits ? 2 : 1;
  }

  std::int32_t panel_px() const {
    return status_lines_ == 0 ? 0 : status_lines_ * kGlyphHeightPx * text_scale() + 2 * kMarginPx;
  }
  void choose_visual() {
    screen_number_ = DefaultScreen(display_);
    // The default one serves if it can; a screen of 256 colours may offer a better one beside it.
    XVisualInfo wanted{};
    wanted.screen = screen_number_;
    wanted.visualid = XVisualIDFromVisual(DefaultVisual(display_, screen_number_));
    int count = 0;
    XVisualInfo* found = XGetVisualInfo(display_, VisualScreenMask | VisualIDMask, &wanted, &count);
    const bool usable = found != nullptr && count > 0 && found->c_class == TrueColor;
    if (usable) {
      visual_ = *found;
    }
    if (found != nullptr) {
      XFree(found);
    }
    if (!usable && XMatchVisualInfo(display_, screen_number_, 24, TrueColor, &visual_) == 0) {
      throw ScreenError("the display " + server_ + " has " +
                        std::to_string(DefaultDepth(display_, screen_number_)) +
                        " bits a pixel; a window takes one of true colours, of 16 bits or more");
    }
  }

  void open(const ScreenOptions& options) {
    const std::int32_t fitting = std::min(kFirstWidthPx / std::max(options.width_px, 1),
                                          kFirstHeightPx / std::max(options.height_px, 1));
    const std::int32_t scale = fixed_scale_ > 0 ? fixed_scale_ : std::clamp(fitting, 1, 16);
    const std::int32_t border = gap_px(look_, scale) != 0 ? 2 * scale : 0;
    const std::int32_t width =
        std::max(options.width_px * scale + border, options.status_lines > 0 ? kLeastWidthPx : 64);
    canvas_.width_px = width;  // panel_px() asks
    std::int32_t height = std::max(options.height_px * scale + border, 64) + panel_px();
    height = std::min(height, 32767);

    XSetErrorHandler(on_error);
    failed_requests = 0;
    const ::Window root = RootWindow(display_, screen_number_);
    colors_ = XCreateColormap(display_, root, visual_.visual, AllocNone);
    XSetWindowAttributes attributes{};
    attributes.colormap = colors_;
    attributes.background_pixel = 0;
    attributes.border_pixel = 0;
    attributes.bit_gravity = NorthWestGravity;
    attributes.event_mask = KeyPressMask | KeyReleaseMask | ButtonPressMask | ButtonReleaseMask |
                            PointerMotionMask | ExposureMask | StructureNotifyMask | FocusChangeMask;
    window_ =
        XCreateWindow(display_, root, 0, 0, static_cast<unsigned>(width), static_cast<unsigned>(height), 0,
                      visual_.depth, InputOutput, visual_.visual,
                      CWColormap | CWBackPixel | CWBorderPixel | CWBitGravity | CWEventMask, &attributes);
    context_ = XCreateGC(display_, window_, 0, nullptr);

    close_atom_ = XInternAtom(display_, "WM_DELETE_WINDOW", False);
    XSetWMProtocols(display_, window_, &close_atom_, 1);
    drops_.announce(display_, window_);
    char name[] = "thimble";
    XClassHint hint{name, name};
    XSetClassHint(display_, window_, &hint);
    XkbSetDetectableAutoRepeat(display_, True,
                               nullptr);  // a held key is pressed again, not let go in between
    set_title(options.title);
    XMapWindow(display_, window_);
    resize(width, height);
    XSync(display_, False);
    if (lost_) {
      throw ScreenError(fault());
    }
    if (failed_requests != 0) {
      throw ScreenError("the display does not make a window of " + std::to_string(width) + " x " +
                        std::to_string(height) + " pixels");
    }
  }

  void resize(std::int32_t width, std::int32_t height) {
    canvas_.resize(width, height);
    compose();
  }

  void compose() {
    const std::int32_t room = height_px();
    placement_ = place(picture_.width_px, picture_.height_px, canvas_.width_px, room, fixed_scale_);
    if (picture_.rgb == nullptr || placement_.width_px < canvas_.width_px || placement_.height_px < room) {
      canvas_.fill(0, 0, canvas_.width_px, room, look_.ground);
    }
    if (picture_.rgb != nullptr) {
      draw_picture(&canvas_, placement_, picture_, look_);
    }
    if (!overlay_.empty()) {
      const std::int32_t scale = overlay_scale();
      const TextSize size = text_size(overlay_);
      const std::int32_t x = placement_.x_px + kMarginPx;
      const std::int32_t y = placement_.y_px + kMarginPx;
      canvas_.fill(x - 4, y - 4, size.columns * kGlyphWidthPx * scale + 8,
                   size.lines * kGlyphHeightPx * scale + 6, kPanel);
      draw_text(&canvas_, x, y, scale, kOverlayText, overlay_);
    }
    if (status_lines_ > 0) {
      canvas_.fill(0, room, canvas_.width_px, panel_px(), kPanel);
      draw_text(&canvas_, kMarginPx, room + kMarginPx, text_scale(), kPanelText, status_);
    }
    needs_sending_ = true;
  }

  void send() {
    needs_sending_ = false;
    if (lost_ || closed_ || canvas_.width_px == 0 || canvas_.height_px == 0) {
      return;
    }
    const auto width = static_cast<unsigned>(canvas_.width_px);
    const auto height = static_cast<unsigned>(canvas_.height_px);
    XImage* image = XCreateImage(display_, visual_.visual, static_cast<unsigned>(visual_.depth), ZPixmap, 0,
                                 nullptr, width, height, 32, 0);
    if (image == nullptr) {
      return;
    }
    image_.resize(static_cast<std::size_t>(image->bytes_per_line) * height);
    image->data = image_.data();
    const bool native_order =
        image->byte_order == (std::endian::native == std::endian::little ? LSBFirst : MSBFirst);
    const bool plain = image->bits_per_pixel == 32 && native_order && visual_.red_mask == 0xFF0000 &&
                       visual_.green_mask == 0xFF00 && visual_.blue_mask == 0xFF;
    for (std::int32_t y = 0; y < canvas_.height_px; ++y) {
      const Rgb8* from = canvas_.row(y);
      char* to = image_.data() + static_cast<std::ptrdiff_t>(y) * image->bytes_per_line;
      for (std::int32_t x = 0; x < canvas_.width_px; ++x) {
        const Rgb8 color = from[x];
        if (plain) {
          const std::uint32_t packed = 0xFF000000U | static_cast<std::uint32_t>(color.r) << 16 |
                                       static_cast<std::uint32_t>(color.g) << 8 | color.b;
          std::memcpy(to + 4 * static_cast<std::ptrdiff_t>(x), &packed, sizeof packed);
        } else {
          XPutPixel(image, x, y,
                    in_mask(color.r, visual_.red_mask) | in_mask(color.g, visual_.green_mask) |
                        in_mask(color.b, visual_.blue_mask));
        }
      }
    }
    XPutImage(display_, window_, context_, image, 0, 0, 0, 0, width, height);
    image->data = nullptr;  // ours
    XDestroyImage(image);
    // Waits until the server has drawn, so that a slow connection slows the frames instead of piling them up.
    XSync(display_, False);
  }

  void take(XEvent& event) {
    std::optional<std::string> path;
    if (drops_.take(event, &path)) {
      if (path) {
        events_.push_back({.kind = EventKind::kDrop, .path = *path});
      }
      return;
    }
    switch (event.type) {
      case KeyPress:
      case KeyRelease:
        take_key(event.xkey, event.type == KeyPress);
        return;
      case ButtonPress:
      case ButtonRelease:
        take_button(event.xbutton, event.type == ButtonPress);
        return;
      case MotionNotify:
        events_.push_back(at(EventKind::kMouseMove, event.xmotion.x, event.xmotion.y, event.xmotion.state));
        return;
      case FocusOut:
        release_keys();  // their release would go to another window
        return;
      case Expose:
        needs_sending_ = true;
        return;
      case MappingNotify:
        XRefreshKeyboardMapping(&event.xmapping);
        return;
      case ConfigureNotify:
        if (event.xconfigure.width != canvas_.width_px || event.xconfigure.height != canvas_.height_px) {
          resize(event.xconfigure.width, event.xconfigure.height);
          events_.push_back({.kind = EventKind::kResize});
        }
        return;
      case DestroyNotify:
        closed_ = true;
        return;
      case ClientMessage:
        if (static_cast<Atom>(event.xclient.data.l[0]) == close_atom_) {
          events_.push_back({.kind = EventKind::kClose});
        }
        return;
      default:
        return;
    }
  }

  void take_key(XKeyEvent& event, bool is_down) {
    std::array<char, 16> text{};
    KeySym typed = NoSymbol;
    const int length = XLookupString(&event, text.data(), static_cast<int>(text.size()), &typed, nullptr);
    // The key itself: what it gives without shift. Keypads give digits only with Num Lock.
    Key key = key_from(XLookupKeysym(&event, 0));
    if (key == Key::kNone) {
      key = key_from(typed);
    }
    if (key != Key::kNone) {
      Event pressed;
      pressed.key = key;
      pressed.kind = is_down ? EventKind::kKeyDown : EventKind::kKeyUp;
      pressed.repeated = is_down && !held_.insert(key).second;
      if (is_down || held_.erase(key) != 0) {
        events_.push_back(pressed);
      }
    }
    if (is_down && length == 1) {
      // Latin-1, the front of Unicode.
      events_.push_back({.kind = EventKind::kText, .character = static_cast<unsigned char>(text[0])});
    }
  }

  void take_button(const XButtonEvent& event, bool is_down) {
    if (event.button == Button4 || event.button == Button5) {
      if (is_down) {
        Event wheel = at(EventKind::kWheel, event.x, event.y, event.state);
        wheel.steps = event.button == Button4 ? 1 : -1;
        events_.push_back(wheel);
      }
      return;
    }
    if (event.button > Button3) {
      return;
    }
    const auto bit = static_cast<std::uint8_t>(1U << (event.button - 1));
    buttons_ = static_cast<std::uint8_t>(is_down ? buttons_ | bit : buttons_ & ~bit);
    Event pressed = at(is_down ? EventKind::kMouseDown : EventKind::kMouseUp, event.x, event.y, event.state);
    pressed.button = static_cast<std::uint8_t>(event.button);
    events_.push_back(pressed);
  }

  Event at(EventKind kind, std::int32_t x, std::int32_t y, unsigned state) const {
    Event event;
    event.kind = kind;
    event.x_px = to_picture(x, placement_.x_px, placement_.width_px, picture_.width_px);
    event.y_px = to_picture(y, placement_.y_px, placement_.height_px, picture_.height_px);
    event.buttons = buttons_;
    event.shift = (state & ShiftMask) != 0;
    return event;
  }

  void release_keys() {
    for (const Key key : held_) {
      events_.push_back({.kind = EventKind::kKeyUp, .key = key});
    }
    held_.clear();
  }

  Display* display_ = nullptr;
  std::string server_;  // its name
  int screen_number_ = 0;
  XVisualInfo visual_{};
  ::Window window_ = 0;
  Colormap colors_ = 0;
  GC context_ = nullptr;
  Atom close_atom_ = 0;
  WindowDrops drops_;
  bool lost_ = false;    // the server is gone
  bool closed_ = false;  // somebody else destroyed the window

  std::int32_t status_columns_ = 0;
  std::vector<char> image_;
  std::set<Key> held_;
  std::uint8_t buttons_ = 0;
  bool needs_sending_ = false;
};

}  // namespace

const char* window_kind() {
  return "X11";
}

std::unique_ptr<Screen> open_window(const ScreenOptions& options) {
  return std::make_unique<Window>(options);
}

}  // namespace thimble::host
