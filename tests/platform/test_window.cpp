// The X11 window, on a virtual display with real pointer and key events. Skipped where Xvfb or xdotool are
// missing.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include "host/screen.h"
#include "support/check_command.h"
#include "support/virtual_display.h"

namespace {

using namespace thimble;
using namespace thimble::host;
using thimble::tests::VirtualDisplay;

// The next event of that kind; others are dropped.
Event wait_for(Screen* screen, EventKind kind) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (std::chrono::steady_clock::now() < end) {
    const auto event = screen->next_event(100);
    if (event && event->kind == kind) {
      return *event;
    }
  }
  FAIL("no event of the kind ", static_cast<int>(kind));
  return {};
}

void drain(Screen* screen) {
  while (screen->next_event(100)) {
  }
}

constexpr std::int32_t kWindowWidthPx = 128;
constexpr std::int32_t kWindowHeightPx = 64;

ScreenOptions options_of(Theme theme) {
  ScreenOptions options;
  options.title = "thimble window test";
  options.width_px = kWindowWidthPx;
  options.height_px = kWindowHeightPx;
  options.look = look_of(theme, PixelFormat::kGray4);
  options.status_lines = 2;
  return options;
}

// Black, but for one pixel.
std::vector<std::uint8_t> one_pixel(std::int32_t x, std::int32_t y, Rgb8 color) {
  std::vector<std::uint8_t> rgb(3 * kWindowWidthPx * kWindowHeightPx);
  const std::size_t at = 3 * static_cast<std::size_t>(y * kWindowWidthPx + x);
  rgb[at] = color.r;
  rgb[at + 1] = color.g;
  rgb[at + 2] = color.b;
  return rgb;
}

}  // namespace

TEST_CASE("window: keys, pointer, wheel, size and close -> events in the picture's pixels") {
  const VirtualDisplay display("1280x900x24");
  NEEDS_DISPLAY(display);
  const auto screen = open_screen(ScreenKind::kAuto, options_of(Theme::kPlain));
  REQUIRE(std::string(screen->name()) == "window");
  const auto rgb = one_pixel(0, 0, {255, 255, 255});
  screen->show({rgb.data(), kWindowWidthPx, kWindowHeightPx});
  CHECK(screen->width_px() == 8 * kWindowWidthPx);
  CHECK(screen->height_px() == 8 * kWindowHeightPx);
  drain(screen.get());

  CHECK(display.xdotool("mousemove 20 9"));
  const Event moved = wait_for(screen.get(), EventKind::kMouseMove);
  CHECK(moved.x_px == 2);
  CHECK(moved.y_px == 1);
  CHECK(display.xdotool("mousedown 3 mousemove 1000 500 mouseup 3"));
  const Event pressed = wait_for(screen.get(), EventKind::kMouseDown);
  CHECK(pressed.button == 3);
  CHECK(pressed.buttons == 4);
  const Event dragged = wait_for(screen.get(), EventKind::kMouseMove);
  CHECK(dragged.buttons == 4);
  CHECK(dragged.x_px == 125);
  CHECK(dragged.y_px == 62);
  const Event released = wait_for(screen.get(), EventKind::kMouseUp);
  CHECK(released.buttons == 0);
  CHECK(display.xdotool("click 5"));
  const Event wheel = wait_for(screen.get(), EventKind::kWheel);
  CHECK(wheel.steps == -1);

  CHECK(display.xdotool("keydown Left"));
  const Event key = wait_for(screen.get(), EventKind::kKeyDown);
  CHECK(key.key == Key::kLeft);
  CHECK_FALSE(key.repeated);
  CHECK(display.xdotool("keyup Left"));
  const Event up = wait_for(screen.get(), EventKind::kKeyUp);
  CHECK(up.key == Key::kLeft);
  CHECK(display.xdotool("type 'P?'"));
  const Event large = wait_for(screen.get(), EventKind::kText);
  CHECK(large.character == U'P');
  const Event question = wait_for(screen.get(), EventKind::kText);
  CHECK(question.character == U'?');
  drain(screen.get());

  // Half the size: the picture is 4 pixels a pixel, in the middle of what the panel leaves.
  CHECK(display.xdotool("search --name 'thimble window test' windowsize 600 400"));
  (void)wait_for(screen.get(), EventKind::kResize);
  CHECK(screen->width_px() == 600);
  CHECK(display.xdotool("mousemove 44 " + std::to_string((screen->height_px() - 4 * kWindowHeightPx) / 2)));
  const Event corner = wait_for(screen.get(), EventKind::kMouseMove);
  CHECK(corner.x_px == 0);
  CHECK(corner.y_px == 0);
  CHECK(display.xdotool("mousemove 39 3"));
  const Event outside = wait_for(screen.get(), EventKind::kMouseMove);
  CHECK(outside.x_px == -2);
  CHECK(outside.y_px < 0);

  // What a window manager sends when its close button is pressed.
  display.press_close_button();
  (void)wait_for(screen.get(), EventKind::kClose);
}

TEST_CASE("window: themes -> lit pixels, gaps and ground in their colours, eight screen pixels a pixel") {
  const VirtualDisplay display("1280x900x24");
  NEEDS_DISPLAY(display);
  for (const Theme theme : {Theme::kPlain, Theme::kOled, Theme::kLcd}) {
    const ScreenOptions options = options_of(theme);
    const Look& look = options.look;
    const auto screen = open_screen(ScreenKind::kWindow, options);
    const auto rgb = one_pixel(5, 3, {255, 255, 255});
    drain(screen.get());
    screen->show({rgb.data(), kWindowWidthPx, kWindowHeightPx});
    const int border = look.has_gaps ? 8 : 0;
    const auto at = [&](int x, int y) { return display.pixel(border + x, border + y); };
    CHECK(at(5 * 8, 3 * 8) == looks(look, {255, 255, 255}));
    CHECK(at(5 * 8 + 6, 3 * 8 + 6) == looks(look, {255, 255, 255}));
    CHECK(at(6 * 8, 3 * 8) == looks(look, {0, 0, 0}));
    CHECK(at(5 * 8 + 7, 3 * 8) == (look.has_gaps ? look.gap : Rgb8{255, 255, 255}));
    if (look.has_gaps) {
      CHECK(display.pixel(2, 2) == look.ground);
    }
  }
}

TEST_CASE("window: a display of 16 bits -> the same picture in its colours") {
  const VirtualDisplay display("640x480x16");
  NEEDS_DISPLAY(display);
  const auto screen = open_screen(ScreenKind::kWindow, options_of(Theme::kPlain));
  const auto rgb = one_pixel(1, 1, {255, 128, 8});
  drain(screen.get());
  screen->show({rgb.data(), kWindowWidthPx, kWindowHeightPx});
  CHECK(display.pixel(12, 12) == Rgb8{248, 128, 8});
  CHECK(display.pixel(4, 4) == Rgb8{0, 0, 0});
}

TEST_CASE("window: a display of 8 bits -> no window, and a sentence with its bits") {
  const VirtualDisplay display("640x480x8");
  NEEDS_DISPLAY(display);
  const std::string sentence = "the display " + std::string(std::getenv("DISPLAY")) +
                               " has 8 bits a pixel; a window takes one of true colours, of 16 bits or more";
  CHECK_THROWS_WITH_AS(open_screen(ScreenKind::kWindow, options_of(Theme::kPlain)), sentence.c_str(),
                       ScreenError);
  for (const char* tool : {"view", "sim", "particles"}) {
    CAPTURE(tool);
    std::vector<std::string> words{tool, "--display", "window"};
    if (std::string(tool) == "view") {
      words = {"view", "spheres,depth=4"};  // a window or a terminal; there is neither
    }
    thimble::tests::check_refused(words, 1, {sentence});
  }
}

TEST_CASE("window: destroyed by somebody else, or its server gone -> close, and the program lives") {
  VirtualDisplay display("1280x900x24");
  NEEDS_DISPLAY(display);
  const auto rgb = one_pixel(0, 0, {1, 2, 3});
  {
    const auto screen = open_screen(ScreenKind::kWindow, options_of(Theme::kPlain));
    screen->show({rgb.data(), kWindowWidthPx, kWindowHeightPx});
    CHECK(display.xdotool("search --name 'thimble window test' windowclose"));
    screen->show({rgb.data(), kWindowWidthPx, kWindowHeightPx});
    (void)wait_for(screen.get(), EventKind::kClose);
    screen->show({rgb.data(), kWindowWidthPx, kWindowHeightPx});
  }
  const auto screen = open_screen(ScreenKind::kWindow, options_of(Theme::kPlain));
  screen->show({rgb.data(), kWindowWidthPx, kWindowHeightPx});
  CHECK(screen->fault().empty());
  const std::string sentence = "the display " + std::string(std::getenv("DISPLAY")) + " has ended";
  display.stop();
  (void)wait_for(screen.get(), EventKind::kClose);
  CHECK(screen->fault() == sentence);
  screen->show({rgb.data(), kWindowWidthPx, kWindowHeightPx});
  screen->set_title("gone");
  CHECK_THROWS_AS(open_screen(ScreenKind::kWindow, options_of(Theme::kPlain)), ScreenError);
}

TEST_CASE("window: the simulator in one -> its picture is the one without a window, and real keys end it") {
  const VirtualDisplay display("1280x900x24");
  NEEDS_DISPLAY(display);
  const thimble::tests::TemporaryFolder folder;
  const std::string shot = folder.path("a.png");
  const auto sim = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"sim", "spheres,depth=4", "--frames", "4", "--quiet"});
    return thimble::tests::run_command(words);
  };
  REQUIRE(sim({"--display", "none", "--shot", shot}).status == 0);
  const auto shown = sim({"--fps", "1000", "--theme", "lcd", "--check", shot});
  CAPTURE(shown.describe());
  CHECK(shown.status == 0);
  // Escape ends a run that would last an hour.
  const int running = std::system((std::string(THIMBLE_COMMAND_PATH) +
                                   " sim spheres,depth=4 --quiet --frames 100000 >/dev/null & sim=$!; "
                                   "xdotool search --sync --name 'thimble sim' >/dev/null; "
                                   "xdotool key Left Escape; wait $sim")
                                      .c_str());
  CHECK(running == 0);
}
