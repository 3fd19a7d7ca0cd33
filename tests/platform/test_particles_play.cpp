// thimble particles, watched: in an X11 window by real pointer and key events, and in a terminal.
#include <doctest/doctest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "support/check_command.h"
#include "support/json.h"
#include "support/pty.h"
#include "support/virtual_display.h"

namespace {

using thimble::Rgb8;
using namespace thimble::tests;

/// The command in a process of its own; its end is waited for.
class Running {
 public:
  explicit Running(const Words& words)
      : thread_([this, words] { result_ = run_command(Words{"particles"} + words); }) {}
  ~Running() {
    if (thread_.joinable()) {
      thread_.join();
    }
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  const CommandResult& wait() {
    thread_.join();
    return result_;
  }

 private:
  CommandResult result_;
  std::thread thread_;
};

/// Looks again and again for up to ten seconds.
template <class Condition>
bool becomes_true(const Condition& condition) {
  for (int i = 0; i < 200; ++i) {
    if (condition()) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

bool is_wall(Rgb8 color) {
  return color.r > 100 && color.r < 140 && color.b > color.r && color.b < 160;
}

}  // namespace

TEST_CASE(
    "particles in a window: pointer and keys -> walls, balls, figures; its record gives the same state") {
  const VirtualDisplay display("1000x760x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  const std::string stats = folder.path("window.json");
  const std::string record = folder.path("input.txt");
  const Words world{"--size", "800x600", "--count", "200", "--seed", "3"};
  Running running(world + Words{"--display", "window", "--record-input", record, "--stats", stats, "--field",
                                folder.path("window.pbm"), "--state", folder.path("window.csv"), "--quiet"});
  REQUIRE(display.xdotool("search --sync --name 'thimble particles'"));
  // Figure 1's overlay: a panel with white text at the top left of the picture.
  CHECK(becomes_true([&] { return display.pixel(7, 7) == Rgb8{32, 34, 38}; }));
  // A wall drawn by the left button with the tool 6, another by the middle one.
  CHECK(display.xdotool("key 6 mousemove 300 200 mousedown 1 mousemove 340 220 mousemove 500 220 mouseup 1"));
  CHECK(becomes_true([&] { return is_wall(display.pixel(420, 220)); }));
  CHECK(is_wall(display.pixel(320, 210)));
  CHECK(display.xdotool("mousemove 300 300 mousedown 2 mousemove 360 300 mouseup 2"));
  CHECK(becomes_true([&] { return is_wall(display.pixel(330, 300)); }));
  CHECK_FALSE(is_wall(display.pixel(330, 330)));
  // The tool 5 erases it, help covers the picture, and goes.
  CHECK(display.xdotool("key 5 mousemove 330 300 mousedown 1"));
  CHECK(becomes_true([&] { return !is_wall(display.pixel(330, 300)); }));
  CHECK(display.xdotool("mouseup 1 type '?'"));
  CHECK(becomes_true([&] { return display.pixel(480, 330) == Rgb8{32, 34, 38}; }));
  CHECK(display.xdotool("type '?'"));
  CHECK(becomes_true([&] { return !(display.pixel(480, 330) == Rgb8{32, 34, 38}); }));
  // Ten more, a spawned one, pause, a step, and a drag; then the end.
  CHECK(display.xdotool("type 'C4'"));
  CHECK(display.xdotool("mousemove 700 100 click 1"));
  CHECK(display.xdotool("key space type '..'"));
  CHECK(display.xdotool("key space key 1 mousemove 400 590 mousedown 1 mousemove 420 300 mousemove 100 100"));
  CHECK(display.xdotool("mouseup 1 key Left"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  CHECK(display.xdotool("key q"));
  const CommandResult& result = running.wait();
  CAPTURE(result.describe());
  REQUIRE(result.status == 0);

  const std::string events = read_text(record);
  for (const char* const part :
       {": key 6\n", ": press left 300,200\n", ": move 500,220\n", ": release left 500,220\n",
        ": press middle 300,300\n", ": key space\n", ": key left\n", ": key q\n", ": end\n"}) {
    CAPTURE(std::string(part));
    CHECK(events.find(part) != std::string::npos);
  }
  check_done(Words{"particles"} + world +
             Words{"--display", "none", "--input", record, "--stats", folder.path("again.json"), "--field",
                   folder.path("again.pbm"), "--state", folder.path("again.csv"), "--quiet"});
  CHECK(read_json(folder.path("again.json")).at("state_crc32") == read_json(stats).at("state_crc32"));
  CHECK(read_json(folder.path("again.json")).at("steps") == read_json(stats).at("steps"));
  CHECK(read_json(stats).at("particles").get<int>() > 200);
  CHECK(read_text(folder.path("again.pbm")) == read_text(folder.path("window.pbm")));
  CHECK(read_text(folder.path("again.csv")) == read_text(folder.path("window.csv")));
}

TEST_CASE("particles in a window: no option but a display -> Figure 1 in a window; closing it ends it") {
  const VirtualDisplay display("1000x760x24");
  NEEDS_DISPLAY(display);
  Running running({});
  REQUIRE(display.xdotool("search --sync --name 'thimble particles'"));
  CHECK(becomes_true([&] { return display.pixel(7, 7) == Rgb8{32, 34, 38}; }));
  display.press_close_button();
  const CommandResult& result = running.wait();
  CAPTURE(result.describe());
  CHECK(result.status == 0);
  CHECK(result.err.find("693 balls, ") == 0);
}

TEST_CASE(
    "particles in a terminal: mouse and keys -> recorded in cells, figures in a line, the same state again") {
  const TemporaryFolder folder;
  const std::string record = folder.path("input.txt");
  const std::string stats = folder.path("terminal.json");
  Pty pty(80, 27, [&] {
    ::setenv("TERM", "xterm-256color", 1);
    ::setenv("COLORTERM", "truecolor", 1);
    ::unsetenv("DISPLAY");
    ::execl(THIMBLE_COMMAND_PATH, "thimble", "particles", "--size", "160x96", "--count", "40", "--display",
            "terminal", "--record-input", record.c_str(), "--stats", stats.c_str(),
            static_cast<char*>(nullptr));
    return 127;
  });
  // 80 x 48 half cells above three lines: half the size, and the picture begins at the first cell.
  REQUIRE(pty.wait_for("Total Colliders: 40"));
  CHECK(pty.output().find("\x1b[?1049h") != std::string::npos);
  CHECK(pty.output().find("\xE2\x96\x80") != std::string::npos);
  // Only cells that change are sent, so single words say little; what counts is in the record.
  const auto type = [&](const char* bytes) {
    pty.type(bytes);
    pty.wait_for("nothing like this", 0.2);
  };
  type("4\x1b[<0;41;5M");
  type("\x1b[<0;41;5m");
  type("C");
  type("?");
  CHECK(pty.output().find("left button: the tool chosen") != std::string::npos);
  type("?");
  type(" ");
  CHECK(pty.output().find("PAUSED") != std::string::npos);
  type(" ");
  type("\x1b[A");
  type("q");
  CHECK(pty.wait_for_end());
  CHECK(pty.exit_status() == 0);
  CHECK(pty.output().find("\x1b[?1049l") != std::string::npos);
  CHECK(pty.output().find(" balls, ") != std::string::npos);

  const std::string events = read_text(record);
  CHECK(events.find(": press left 81,18\n") != std::string::npos);
  CHECK(events.find(": key up\n") != std::string::npos);
  const CommandResult again = check_done({"particles", "--size", "160x96", "--count", "40", "--input", record,
                                          "--stats", folder.path("again.json"), "--quiet"});
  CHECK(read_json(folder.path("again.json")).at("state_crc32") == read_json(stats).at("state_crc32"));
  CHECK(read_json(stats).at("particles").get<int>() > 50);
}
