#include "support/virtual_display.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

namespace thimble::tests {
namespace {

class Connection {
 public:
  Connection() : display_(XOpenDisplay(nullptr)) {
    if (display_ == nullptr) {
      throw std::runtime_error("the virtual display is gone");
    }
  }
  ~Connection() { XCloseDisplay(display_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  Display* get() const { return display_; }

 private:
  Display* display_;
};

::Window window_on_top(Display* display) {
  ::Window root = 0;
  ::Window parent = 0;
  ::Window* children = nullptr;
  unsigned count = 0;
  if (XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count) == 0 || count == 0) {
    throw std::runtime_error("the virtual display has no window");
  }
  const ::Window top = children[count - 1];
  XFree(children);
  return top;
}

// The source of a drag.
class Dragging {
 public:
  Dragging(Display* display, const std::string& list, bool is_file)
      : display_(display), list_(list), target_(window_on_top(display)) {
    own_ = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 1, 1, 0, 0, 0);  // never shown
    type_ = atom(is_file ? "text/uri-list" : "text/plain");
    XSetSelectionOwner(display, atom("XdndSelection"), own_, CurrentTime);
  }
  Dragging(const Dragging&) = delete;
  Dragging& operator=(const Dragging&) = delete;

  // Of a list of types longer than the message's three.
  void offer_many() {
    const std::array<Atom, 4> types{atom("a/a"), atom("b/b"), atom("c/c"), type_};
    XChangeProperty(display_, own_, atom("XdndTypeList"), 4, 32, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(types.data()), static_cast<int>(types.size()));
    send("XdndEnter", 5L << 24 | 1, 0, 0);
  }
  void send(const char* what, long second, long third, long fifth) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target_;
    event.xclient.message_type = atom(what);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(own_);
    event.xclient.data.l[1] = second;
    event.xclient.data.l[2] = third;
    event.xclient.data.l[4] = fifth;
    XSendEvent(display_, target_, False, NoEventMask, &event);
    XFlush(display_);
  }
  // Hands the list over when it is requested, until the message comes; its second number.
  long wait_for(const char* what) {
    for (int rounds = 0; rounds < 1000; ++rounds) {
      if (XPending(display_) == 0) {
        ::usleep(10000);
        continue;
      }
      XEvent event{};
      XNextEvent(display_, &event);
      if (event.type == SelectionRequest) {
        give(event.xselectionrequest);
      } else if (event.type == ClientMessage && event.xclient.message_type == atom(what)) {
        return event.xclient.data.l[1];
      }
    }
    throw std::runtime_error("nobody answers the drag");
  }

 private:
  Atom atom(const char* name) { return XInternAtom(display_, name, False); }
  void give(const XSelectionRequestEvent& request) {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(list_.data()), static_cast<int>(list_.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = request.requestor;
    event.xselection.selection = request.selection;
    event.xselection.target = request.target;
    event.xselection.property = request.property;
    event.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &event);
    XFlush(display_);
  }

  Display* display_;
  std::string list_;
  ::Window target_;
  ::Window own_ = 0;
  Atom type_ = 0;
};

}  // namespace

VirtualDisplay::VirtualDisplay(const std::string& screen) {
  if (std::system("command -v xdotool >/dev/null 2>&1") != 0) {
    why_not_ = "xdotool is not installed";
    return;
  }
  std::array<int, 2> number{};
  if (::pipe(number.data()) != 0) {
    throw std::runtime_error("no pipe");
  }
  server_ = ::fork();
  if (server_ == 0) {
    ::close(number[0]);
    const int nowhere = ::open("/dev/null", O_RDWR);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    const std::string descriptor = std::to_string(number[1]);
    ::execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", screen.c_str(), "-noreset",
             "-nolisten", "tcp", static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ::close(number[1]);
  std::string text;
  pollfd source{number[0], POLLIN, 0};
  std::array<char, 32> bytes{};
  while (text.find('\n') == std::string::npos && ::poll(&source, 1, 20000) > 0) {
    const ssize_t count = ::read(number[0], bytes.data(), bytes.size());
    if (count <= 0) {
      break;
    }
    text.append(bytes.data(), static_cast<std::size_t>(count));
  }
  ::close(number[0]);
  if (text.find('\n') == std::string::npos) {
    why_not_ = "Xvfb is not installed, or does not start";
    return;
  }
  ::setenv("DISPLAY", (":" + text.substr(0, text.find('\n'))).c_str(), 1);
}

void VirtualDisplay::stop() {
  if (server_ > 0) {
    ::kill(server_, SIGTERM);
    ::waitpid(server_, nullptr, 0);
    server_ = -1;
    ::unsetenv("DISPLAY");
  }
}

Rgb8 VirtualDisplay::pixel(int x, int y) const {
  const Connection connection;
  Display* const display = connection.get();
  XImage* const image = XGetImage(display, DefaultRootWindow(display), x, y, 1, 1, AllPlanes, ZPixmap);
  if (image == nullptr) {
    throw std::runtime_error("the virtual display shows nothing");
  }
  const unsigned long value = XGetPixel(image, 0, 0);
  XDestroyImage(image);
  const auto channel = [value](int low, unsigned mask, int up) {
    return static_cast<std::uint8_t>((value >> low & mask) << up);
  };
  if (DefaultDepth(display, DefaultScreen(display)) < 24) {
    return {channel(11, 31, 3), channel(5, 63, 2), channel(0, 31, 3)};
  }
  return {channel(16, 255, 0), channel(8, 255, 0), channel(0, 255, 0)};
}

void VirtualDisplay::press_close_button() const {
  const Connection connection;
  Display* const display = connection.get();
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = window_on_top(display);
  event.xclient.message_type = XInternAtom(display, "WM_PROTOCOLS", False);
  event.xclient.format = 32;
  event.xclient.data.l[0] = static_cast<long>(XInternAtom(display, "WM_DELETE_WINDOW", False));
  XSendEvent(display, event.xclient.window, False, NoEventMask, &event);
}

bool VirtualDisplay::drop(const std::string& uri_list, bool is_file) const {
  const Connection connection;
  Dragging dragging(connection.get(), uri_list, is_file);
  dragging.offer_many();
  dragging.send("XdndPosition", 0, 100 << 16 | 100, 0);
  const bool would_take = (dragging.wait_for("XdndStatus") & 1) != 0;
  dragging.send("XdndDrop", 0, CurrentTime, 0);
  const bool took = (dragging.wait_for("XdndFinished") & 1) != 0;
  return would_take && took;
}

bool VirtualDisplay::xdotool(const std::string& words) const {
  return std::system(("xdotool " + words + " >/dev/null").c_str()) == 0;
}

}  // namespace thimble::tests
