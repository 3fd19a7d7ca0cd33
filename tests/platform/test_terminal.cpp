// The terminal screen: what it sends, what it understands, and that it leaves the terminal as it found it.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "host/screen.h"
#include "host/terminal_cells.h"
#include "host/terminal_input.h"
#include "host/terminal_mode.h"
#include "support/pty.h"

namespace {

using namespace thimble;
using namespace thimble::host;
using thimble::tests::Pty;

constexpr const char* kAlternateOn = "\x1b[?1049h";
constexpr const char* kAlternateOff = "\x1b[?1049l";
constexpr const char* kMouseOff = "\x1b[?1003l";
constexpr const char* kCursorOn = "\x1b[?25h";

// Events as words: easier to write down and to compare.
std::string words_of(const Event& event) {
  const std::string at = std::to_string(event.x_px) + "," + std::to_string(event.y_px);
  switch (event.kind) {
    case EventKind::kKeyDown:
      return (event.repeated ? "again " : "down ") + std::to_string(static_cast<std::uint32_t>(event.key));
    case EventKind::kKeyUp:
      return "up " + std::to_string(static_cast<std::uint32_t>(event.key));
    case EventKind::kText:
      return "text " + std::to_string(static_cast<std::uint32_t>(event.character));
    case EventKind::kMouseMove:
      return "move " + at + " held " + std::to_string(event.buttons);
    case EventKind::kMouseDown:
      return "press " + std::to_string(event.button) + " " + at;
    case EventKind::kMouseUp:
      return "release " + std::to_string(event.button) + " " + at;
    case EventKind::kWheel:
      return "wheel " + std::to_string(event.steps) + " " + at;
    case EventKind::kResize:
      return "resize";
    case EventKind::kDrop:
      return "drop " + event.path;
    case EventKind::kClose:
      return "close";
  }
  return "?";
}

std::string words_of(const std::vector<Event>& events) {
  std::string words;
  for (const Event& event : events) {
    words += (words.empty() ? "" : "; ") + words_of(event);
  }
  return words;
}

std::string down(Key key) {
  return "down " + std::to_string(static_cast<std::uint32_t>(key));
}

// A program in a terminal: shows a picture, and says on it what it hears.
int show_and_listen() {
  ::unsetenv("COLORTERM");
  ScreenOptions options;
  options.title = "test";
  options.width_px = 16;
  options.height_px = 8;
  options.status_lines = 1;
  const std::vector<std::uint8_t> rgb(3 * 16 * 8, 200);
  const auto screen = open_terminal(options);
  screen->set_status("ready");
  screen->show({rgb.data(), 16, 8});
  while (true) {
    const auto event = screen->next_event(20000);
    if (!event || event->kind == EventKind::kClose) {
      return 3;
    }
    if (event->kind == EventKind::kText) {
      switch (event->character) {
        case 'q':
          return 0;
        case 'e':
          std::exit(4);
        case 'c': {
          volatile std::uintptr_t nowhere = 8;
          *reinterpret_cast<volatile char*>(nowhere) = 1;
          break;
        }
        case 'a':
          std::abort();
        default:
          break;
      }
    }
    screen->set_title(words_of(*event));  // a title is sent whole
  }
}

void check_restored(const Pty& pty, const termios& before) {
  const std::string& output = pty.output();
  const std::size_t on = output.find(kAlternateOn);
  const std::size_t off = output.rfind(kAlternateOff);
  REQUIRE(on != std::string::npos);
  REQUIRE(off != std::string::npos);
  CHECK(off > on);
  CHECK(off > output.rfind(kAlternateOn));
  CHECK(output.rfind(kMouseOff) != std::string::npos);
  CHECK(output.rfind(kCursorOn) > on);
  const termios after = pty.modes();
  CHECK(after.c_lflag == before.c_lflag);
  CHECK(after.c_iflag == before.c_iflag);
  CHECK(after.c_oflag == before.c_oflag);
}

}  // namespace

TEST_CASE("terminal input: keys in every form -> the key, and the character where there is one") {
  struct Case {
    std::string bytes;
    std::string words;
  };
  const std::vector<Case> cases{
      {"a", "down 97; text 97"},
      {"A", "down 97; text 65"},
      {" ", "down 32; text 32"},
      {"\r", "down 13; text 13"},
      {"\t", "down 9; text 9"},
      {"\x7f", "down 8; text 8"},
      {"\x1b[A", down(Key::kUp)},
      {"\x1bOB", down(Key::kDown)},
      {"\x1b[1;5C", down(Key::kRight)},
      {"\x1b[D", down(Key::kLeft)},
      {"\x1b[H\x1b[4~\x1b[5~\x1b[6~",
       down(Key::kHome) + "; " + down(Key::kEnd) + "; " + down(Key::kPageUp) + "; " + down(Key::kPageDown)},
      {"\x1b[2~\x1b[3~", down(Key::kInsert) + "; " + down(Key::kDelete)},
      {"\x1bx", "down 27; down 120; text 120"},
      {"\xC3\xA9", "text 233"},
      {"\xE2\x82\xAC", "text 8364"},
      {"\xF0\x9F\x98\x80", "text 128512"},
      {"\xFF\xC3(", "down 40; text 40"},
      {"\x1b[200~x", "down 120; text 120"},
      {"\x1b[?1;2c", ""},
      {"\x1b[<0;1;1M\x1b[<0;1;1m", "press 1 0,0; release 1 0,0"},
      {"\x1b[<2;300;200M\x1b[<34;301;199M\x1b[<2;301;199m",
       "press 3 299,199; move 300,198 held 4; release 3 300,198"},
      {"\x1b[<35;5;6M", "move 4,5 held 0"},
      {"\x1b[<64;5;6M\x1b[<65;5;6M", "wheel 1 4,5; wheel -1 4,5"},
      {"\x1b[<0;0;5M\x1b[<;5;6M\x1b[<M", ""},
  };
  for (const Case& each : cases) {
    CAPTURE(each.words);
    TerminalInput whole;
    std::vector<Event> events;
    whole.take(each.bytes, &events);
    whole.settle(&events);
    CHECK(words_of(events) == each.words);
    // In single bytes it means the same.
    TerminalInput bytewise;
    events.clear();
    for (const char byte : each.bytes) {
      bytewise.take(std::string(1, byte), &events);
    }
    bytewise.settle(&events);
    CHECK(words_of(events) == each.words);
  }
}

TEST_CASE("terminal input: an escape alone -> waits, and is the key when nothing follows") {
  TerminalInput input;
  std::vector<Event> events;
  input.take("\x1b", &events);
  CHECK(events.empty());
  CHECK(input.waits());
  input.settle(&events);
  CHECK(words_of(events) == down(Key::kEscape));
  CHECK_FALSE(input.waits());
}

TEST_CASE("terminal cells: only cells that changed are sent, with the colours that the terminal has") {
  for (const bool true_color : {true, false}) {
    TerminalCells cells(true_color, true);
    cells.reset(10, 4);
    Canvas canvas;
    canvas.resize(10, 6);
    canvas.fill(0, 0, 10, 6, {10, 20, 30});
    cells.put_canvas(&canvas);
    cells.put_text(0, 3, {255, 255, 255}, {0, 0, 0}, "hello\x07 long line");
    const std::string first = cells.changes();
    CHECK(first.find(true_color ? "48;2;10;20;30" : "48;5;233") != std::string::npos);
    CHECK(first.find("hello? lon") != std::string::npos);
    CHECK(first.find("long") == std::string::npos);
    CHECK(first.find('\x07') == std::string::npos);
    cells.put_canvas(&canvas);
    CHECK(cells.changes().empty());
    // One pixel: one cell, the upper half block in its colour.
    canvas.fill(3, 2, 1, 1, {255, 0, 0});
    cells.put_canvas(&canvas);
    const std::string second = cells.changes();
    CAPTURE(second);
    CHECK(second.find("\x1b[2;4H") != std::string::npos);
    CHECK(second.find(true_color ? "38;2;255;0;0;48;2;10;20;30m\u2580" : "38;5;196;48;5;233m\u2580") !=
          std::string::npos);
    CHECK(second.size() < 80);
    // A terminal that was cleared gets everything again.
    cells.reset(10, 4);
    cells.put_canvas(&canvas);
    CHECK(cells.changes().size() > second.size());
  }
}

TEST_CASE("terminal cells: without halves -> ASCII alone, and a cell has the light of both its pixels") {
  TerminalCells cells(true, false);
  cells.reset(3, 1);
  Canvas canvas;
  canvas.resize(3, 2);
  canvas.fill(0, 0, 1, 1, {200, 100, 10});
  canvas.fill(1, 0, 1, 2, {7, 8, 9});
  cells.put_canvas(&canvas);
  const std::string all = cells.changes();
  CHECK(all.find("48;2;141;71;7m ") != std::string::npos);
  CHECK(all.find("48;2;7;8;9m ") != std::string::npos);
  CHECK(std::all_of(all.begin(), all.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
}

TEST_CASE("terminal: the locale's codes -> halves in UTF-8, else not a byte beyond ASCII") {
  struct Case {
    const char* name;
    const char* value;
    bool has_halves;
  };
  // The last two are not installed here, so their names count.
  const std::vector<Case> cases{{"LC_ALL", "C", false},        {"LC_ALL", "POSIX", false},
                                {"LC_CTYPE", "C.UTF-8", true}, {"LANG", "C.UTF-8", true},
                                {"LANG", "", false},           {"LC_ALL", "de_XY.ISO-8859-1", false},
                                {"LC_ALL", "de_XY.utf8", true}};
  for (const Case& one : cases) {
    CAPTURE(one.name);
    CAPTURE(one.value);
    Pty pty(40, 13, [&] {
      for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
        ::unsetenv(name);
      }
      ::setenv(one.name, one.value, 1);
      ScreenOptions options;
      options.title = "a title: \u00E4";
      options.width_px = 40;
      options.height_px = 26;
      options.status_lines = 1;
      std::vector<std::uint8_t> rgb(3 * 40 * 26);
      for (std::size_t i = 0; i < rgb.size(); ++i) {
        rgb[i] = static_cast<std::uint8_t>(i / 120 * 9);  // each row its own grey
      }
      const auto screen = open_terminal(options);
      screen->set_status("caf\u00E9");
      screen->set_overlay("\u2580");
      screen->show({rgb.data(), 40, 26});
      return 0;
    });
    CHECK(pty.wait_for_end());
    CHECK(pty.exit_status() == 0);
    const std::string& all = pty.output();
    CHECK(all.size() > 500);
    const bool is_ascii =
        std::all_of(all.begin(), all.end(), [](char c) { return static_cast<unsigned char>(c) < 0x80; });
    CHECK(is_ascii == !one.has_halves);
    CHECK((all.find("\u2580") != std::string::npos) == one.has_halves);
  }
}

TEST_CASE("terminal cells: the nearest of 256 colours -> no other entry of the table is nearer") {
  const auto level = [](int i) { return i == 0 ? 0 : 55 + 40 * i; };
  const auto color_of = [&](int index) {
    if (index >= 232) {
      const auto gray = static_cast<std::uint8_t>(8 + 10 * (index - 232));
      return Rgb8{gray, gray, gray};
    }
    const int cube = index - 16;
    return Rgb8{static_cast<std::uint8_t>(level(cube / 36)), static_cast<std::uint8_t>(level(cube / 6 % 6)),
                static_cast<std::uint8_t>(level(cube % 6))};
  };
  const auto distance = [](Rgb8 a, Rgb8 b) {
    return (a.r - b.r) * (a.r - b.r) + (a.g - b.g) * (a.g - b.g) + (a.b - b.b) * (a.b - b.b);
  };
  for (int r = 0; r < 256; r += 15) {
    for (int g = 0; g < 256; g += 17) {
      for (int b = 0; b < 256; b += 5) {
        const Rgb8 color{static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                         static_cast<std::uint8_t>(b)};
        int best = 1 << 30;
        for (int index = 16; index < 256; ++index) {
          best = std::min(best, distance(color, color_of(index)));
        }
        REQUIRE(distance(color, color_of(nearest_of_256(color))) == best);
      }
    }
  }
}

TEST_CASE("terminal: return, exit, signals and crashes -> the screen is left and the modes are as before") {
  struct Case {
    std::string what;
    const char* typed;
    int signal;
    int exit_status;
    int end_signal;
  };
  const std::vector<Case> cases{
      {"return", "q", 0, 0, 0},
      {"SIGTERM", nullptr, SIGTERM, -1, SIGTERM},
      {"SIGHUP", nullptr, SIGHUP, -1, SIGHUP},
      {"Ctrl-C", "\x03", 0, -1, SIGINT},
      {"Ctrl-\\", "\x1c", 0, -1, SIGQUIT},
#ifdef __SANITIZE_ADDRESS__
      {"exit", "e", 0, -2, 0},  // the sanitizer says that the screen was not freed
      {"a crash", "c", 0, 1, 0},
#else
      {"exit", "e", 0, 4, 0},
      {"a crash", "c", 0, -1, SIGSEGV},
#endif
      {"SIGSEGV from outside", nullptr, SIGSEGV, -2, 0},
      {"abort", "a", 0, -1, SIGABRT},
  };
  for (const Case& each : cases) {
    CAPTURE(each.what);
    int go[2];
    REQUIRE(::pipe(go) == 0);
    Pty pty(40, 12, [&] {
      char byte = 0;
      return ::read(go[0], &byte, 1) == 1 ? show_and_listen() : 9;
    });
    const termios before = pty.modes();
    REQUIRE((before.c_lflag & ICANON) != 0);
    REQUIRE(::write(go[1], "x", 1) == 1);
    REQUIRE(pty.wait_for("ready"));
    CHECK((pty.modes().c_lflag & (ICANON | ECHO)) == 0);
    CHECK(pty.output().find("\x1b[?1006h") != std::string::npos);
    if (each.typed != nullptr) {
      pty.type(each.typed);
    } else {
      pty.send_signal(each.signal);
    }
    CHECK(pty.wait_for_end());
    if (each.exit_status != -2) {
      CHECK(pty.exit_status() == each.exit_status);
      CHECK(pty.end_signal() == each.end_signal);
    }
    check_restored(pty, before);
    ::close(go[0]);
    ::close(go[1]);
  }
}

TEST_CASE("terminal: stopped and continued -> left, entered again, and drawn anew") {
  // A shell in small: it starts the program as a job, takes the terminal back when that is stopped, and gives
  // it again.
  Pty pty(40, 12, [] {
    ::signal(SIGTTOU, SIG_IGN);
    const pid_t job = ::fork();
    if (job == 0) {
      ::setpgid(0, 0);
      ::tcsetpgrp(STDIN_FILENO, ::getpid());
      ::signal(SIGTTOU, SIG_DFL);
      ::_exit(show_and_listen());
    }
    ::setpgid(job, job);
    int status = 0;
    ::waitpid(job, &status, WUNTRACED);
    if (!WIFSTOPPED(status)) {
      return 20;
    }
    ::tcsetpgrp(STDIN_FILENO, ::getpgrp());
    termios modes{};
    ::tcgetattr(STDIN_FILENO, &modes);
    const std::string_view said = (modes.c_lflag & ICANON) != 0 ? "job stopped, sane" : "job stopped, raw";
    if (::write(STDOUT_FILENO, said.data(), said.size()) < 0) {
      return 21;
    }
    ::tcsetpgrp(STDIN_FILENO, job);
    ::kill(-job, SIGCONT);
    ::waitpid(job, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 22;
  });
  REQUIRE(pty.wait_for("ready"));
  pty.type("\x1a");
  REQUIRE(pty.wait_for(kAlternateOff));
  REQUIRE(pty.wait_for("job stopped, sane"));
  REQUIRE(pty.wait_for(kAlternateOn));
  CAPTURE(pty.output());
  REQUIRE(pty.wait_for("resize"));
  pty.type("q");
  CHECK(pty.wait_for_end());
  CHECK(pty.exit_status() == 0);
  CHECK(pty.output().rfind(kAlternateOff) > pty.output().rfind(kAlternateOn));
}

TEST_CASE("terminal: keys, mouse and a new size -> events in the picture's pixels") {
  Pty pty(40, 13, show_and_listen);
  REQUIRE(pty.wait_for("ready"));
  // 16 x 8 in 40 x 24 half cells: twice as large, 4 cells from the left, 2 cells from the top.
  pty.type("\x1b[<0;5;3M");
  CHECK(pty.wait_for("press 1 0,0"));
  pty.type("\x1b[<32;36;10M");
  CHECK(pty.wait_for("move 15,7 held 1"));
  pty.type("\x1b[<32;1;1M");
  CHECK(pty.wait_for("move -2,-2 held 1"));
  pty.type("\x1b[<0;9;3m");
  CHECK(pty.wait_for("release 1 2,0"));
  pty.type("\x1b[<65;9;4M");
  CHECK(pty.wait_for("wheel -1 2,1"));
  pty.type("\x1b[C");
  CHECK(pty.wait_for(down(Key::kRight)));
  pty.resize(80, 25);
  CHECK(pty.wait_for("\x1b[2J"));
  CHECK(pty.wait_for("resize"));
  pty.type("\x1b[<0;9;3M");
  CHECK(pty.wait_for("press 1 1,0"));
  pty.type("q");
  CHECK(pty.wait_for_end());
  CHECK(pty.exit_status() == 0);
}

TEST_CASE("terminal: a signal between a look and the wait -> not slept through") {
  for (const int number : {SIGWINCH, SIGCONT}) {
    for (const bool in_thread : {false, true}) {
      CAPTURE(number);
      CAPTURE(in_thread);
      Pty pty(40, 13, [number, in_thread] {
        TerminalMode mode(::open("/dev/tty", O_RDWR));
        if (mode.take_resized() || mode.take_reentered() || mode.wait(0) != Wakeup::kTime) {
          return 1;
        }
        if (in_thread) {
          std::thread([number] { ::raise(number); }).join();
        } else {
          ::raise(number);
        }
        if (mode.wait(60000) != Wakeup::kSignal) {
          return 2;
        }
        // Once is enough.
        return mode.take_resized() && mode.wait(0) == Wakeup::kTime ? 0 : 3;
      });
      CHECK(pty.wait_for_end());
      CHECK(pty.exit_status() == 0);
    }
  }
}

TEST_CASE("terminal: a key without a release -> let go by itself after a moment") {
  Pty pty(40, 13, show_and_listen);
  REQUIRE(pty.wait_for("ready"));
  pty.type("z");
  CHECK(pty.wait_for("up"));
  pty.type("q");
  CHECK(pty.wait_for_end());
}

TEST_CASE("terminal: no terminal, or a dumb one -> an error that says so") {
  Pty dumb(40, 13, [] {
    ::setenv("TERM", "dumb", 1);
    try {
      open_terminal({});
      return 1;
    } catch (const ScreenError& error) {
      return std::string(error.what()).find("TERM is dumb") != std::string::npos ? 0 : 2;
    }
  });
  CHECK(dumb.wait_for_end());
  CHECK(dumb.exit_status() == 0);
  Pty none(40, 13, [] {
    // In a session of its own a process has no terminal.
    const pid_t child = ::fork();
    if (child == 0) {
      ::setsid();
      try {
        open_terminal({});
        ::_exit(1);
      } catch (const ScreenError&) {
        ::_exit(0);
      }
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 3;
  });
  CHECK(none.wait_for_end());
  CHECK(none.exit_status() == 0);
}
