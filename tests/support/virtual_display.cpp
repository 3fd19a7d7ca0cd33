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
  ::Window root = 0;
  ::Window parent = 0;
  ::Window* children = nullptr;
  unsigned count = 0;
  if (XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count) == 0 || count == 0) {
    throw std::runtime_error("the virtual display has no window");
  }
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = children[count - 1];
  event.xclient.message_type = XInternAtom(display, "WM_PROTOCOLS", False);
  event.xclient.format = 32;
  event.xclient.data.l[0] = static_cast<long>(XInternAtom(display, "WM_DELETE_WINDOW", False));
  XSendEvent(display, event.xclient.window, False, NoEventMask, &event);
  XFree(children);
}

bool VirtualDisplay::xdotool(const std::string& words) const {
  return std::system(("xdotool " + words + " >/dev/null").c_str()) == 0;
}

}  // namespace thimble::tests
