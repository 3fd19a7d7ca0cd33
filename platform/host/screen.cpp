#include "host/screen.h"

#include <unistd.h>

#include <string>

#include "host/headless.h"
#include "host/terminal.h"
#include "host/window_x11.h"

namespace thimble::host {

std::unique_ptr<Screen> open_screen(ScreenKind kind, const ScreenOptions& options) {
  std::string fault;
  switch (kind) {
    case ScreenKind::kWindow:
      return open_window(options);
    case ScreenKind::kTerminal:
      return open_terminal(options);
    case ScreenKind::kAuto:
      try {
        return open_window(options);
      } catch (const ScreenError& error) {
        fault = error.what();  // no window system is the usual case over ssh
      }
      if (::isatty(STDOUT_FILENO) != 0) {
        try {
          return open_terminal(options);
        } catch (const ScreenError&) {
          // A dumb terminal can still have the program's lines.
        }
      }
      break;
    case ScreenKind::kNone:
      break;
  }
  return std::make_unique<HeadlessScreen>(fault);
}

}  // namespace thimble::host
