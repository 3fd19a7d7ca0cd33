/// An X server that shows nothing to anybody, for tests of the window, and what a test does to it.
#pragma once

#include <doctest/doctest.h>
#include <sys/types.h>

#include <string>

#include "thimble/picture/pixel.h"

/// Ends the test case with a word on why where the display does not work.
#define NEEDS_DISPLAY(display)                   \
  if (!(display).works()) {                      \
    MESSAGE("skipped: " << (display).why_not()); \
    return;                                      \
  }                                              \
  static_assert(true, "so that a semicolon follows")

namespace thimble::tests {

class VirtualDisplay {
 public:
  /// Starts Xvfb with a screen such as "1280x900x24" on a display number that is free, and makes it $DISPLAY.
  explicit VirtualDisplay(const std::string& screen);
  ~VirtualDisplay() { stop(); }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  /// Whether the server runs and xdotool, which moves its pointer and presses its keys, is there; if not,
  /// `why_not` says so.
  bool works() const { return why_not_.empty(); }
  const std::string& why_not() const { return why_not_; }
  /// Ends the server.
  void stop();

  /// The colour of a pixel of the whole screen, as far as the screen has it.
  Rgb8 pixel(int x, int y) const;
  /// Sends the window on top what a window manager sends when its close button is pressed.
  void press_close_button() const;
  /// Drags onto the window on top, as a file manager does (XDND), what this text/uri-list names, and lets go;
  /// with `is_file` false it is plain text. Whether the window took it.
  bool drop(const std::string& uri_list, bool is_file = true) const;
  /// Runs xdotool with these words of a shell; whether it succeeded.
  bool xdotool(const std::string& words) const;

 private:
  pid_t server_ = -1;
  std::string why_not_;
};

}  // namespace thimble::tests
