#include "host/screen.h"

#include <unistd.h>

#include <string>
#include <utility>

namespace thimble::host {
namespace {

// Nobody looks at it: on machines without a screen, for tests and for scripts.
class HeadlessScreen final : public Screen {
 public:
  explicit HeadlessScreen(std::string fault) : fault_(std::move(fault)) {}

  void show(const Picture& /*picture*/) override {}
  void set_status(std::string_view /*text*/) override {}
  void set_overlay(std::string_view /*text*/) override {}
  void set_title(std::string_view /*text*/) override {}
  std::optional<Event> next_event(int /*timeout_ms*/) override { return std::nullopt; }
  std::int32_t width_px() const override { return 0; }
  std::int32_t height_px() const override { return 0; }
  std::string fault() const override { return fault_; }
  const char* name() const override { return "none"; }

 private:
  std::string fault_;
};

}  // namespace

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
