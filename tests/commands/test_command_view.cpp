// thimble view, as a user does it: in a window under Xvfb with real pointer and keys, in a terminal, and where
// there is neither. Windows are skipped where Xvfb or xdotool are missing.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "support/check_command.h"
#include "support/file_bytes.h"
#include "support/pty.h"
#include "support/virtual_display.h"

namespace {

using namespace thimble::tests;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool wait_until(double seconds, const std::function<bool()>& done) {
  const auto start = Clock::now();
  while (!done()) {
    if (seconds_since(start) > seconds) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

// Replaces this process by the command.
[[noreturn]] void become_command(const Words& words) {
  std::string program = THIMBLE_COMMAND_PATH;
  std::vector<char*> argv{program.data()};
  for (const std::string& word : words) {
    argv.push_back(const_cast<char*>(word.c_str()));
  }
  argv.push_back(nullptr);
  ::execv(program.c_str(), argv.data());
  ::_exit(127);
}

// The viewer in the folder, with what it prints in files there.
class Viewing {
 public:
  Viewing(const TemporaryFolder& folder, const Words& words) : folder_(folder) {
    child_ = ::fork();
    if (child_ == 0) {
      const auto to_file = [&](const char* name, int descriptor) {
        ::dup2(::open(folder.path(name).c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600), descriptor);
      };
      to_file("out.txt", 1);
      to_file("err.txt", 2);
      if (::chdir(folder.path().c_str()) == 0) {
        become_command(words);
      }
      ::_exit(126);
    }
  }
  ~Viewing() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
    }
  }
  Viewing(const Viewing&) = delete;
  Viewing& operator=(const Viewing&) = delete;

  std::string out() const { return read_text(folder_.path("out.txt")); }
  std::string err() const { return read_text(folder_.path("err.txt")); }
  bool prints(const std::string& text) const {
    return wait_until(60, [&] { return out().find(text) != std::string::npos; });
  }
  bool complains(const std::string& text) const {
    return wait_until(20, [&] { return err().find(text) != std::string::npos; });
  }
  // The exit status once it ends; -1 where it does not.
  int wait() {
    int status = 0;
    const bool ended = wait_until(20, [&] { return ::waitpid(child_, &status, WNOHANG) == child_; });
    child_ = ended ? -1 : child_;
    return ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  const TemporaryFolder& folder_;
  pid_t child_ = -1;
};

// Until the window is there and the pointer in it.
bool point_into(const VirtualDisplay& display) {
  return display.xdotool("search --sync --onlyvisible --name '^thimble: '") &&
         display.xdotool("mousemove 60 60");
}

// What a window of 640 x 480 shows beside its text.
std::string shown(const VirtualDisplay& display) {
  std::string grid;
  for (int y = 250; y < 470; y += 20) {
    for (int x = 330; x < 630; x += 20) {
      const thimble::Rgb8 pixel = display.pixel(x, y);
      grid += {static_cast<char>(pixel.r), static_cast<char>(pixel.g), static_cast<char>(pixel.b)};
    }
  }
  return grid;
}

// A shell's words of a printed command; none of those here is quoted.
Words words_of(const std::string& line) {
  return split(line, ' ');
}

std::string line_with(const std::string& text, const std::string& part) {
  for (const std::string& line : lines_of(text)) {
    if (line.find(part) != std::string::npos) {
      return line;
    }
  }
  return {};
}

// The line with this part, once the viewer prints it.
std::string printed(const Viewing& viewing, const std::string& part) {
  REQUIRE(viewing.prints(part));
  return line_with(viewing.out(), part);
}

// The words after a word, as numbers.
double first_number_after(const Words& words, const std::string& name) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] == name) {
      return std::stod(words[i + 1]);
    }
  }
  return 1e9;
}

// Runs the printed command with another output and compares the files.
void check_same_picture(const TemporaryFolder& folder, const std::string& line) {
  CAPTURE(line);
  Words words = words_of(line);
  REQUIRE(words.size() > 4);
  CHECK(words[0] == "thimble");
  const std::string saved = words.back();
  words.erase(words.begin());
  words.back() = "again.png";
  CommandLimits limits;
  limits.directory = folder.path();
  check_done(words, limits);
  CHECK(read_text(folder.path(saved)) == read_text(folder.path("again.png")));
}

}  // namespace

TEST_CASE("view: dragged, moved, nearer, named views, resized -> what s saves is what its command renders") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  Viewing viewing(folder, {"spheres,depth=5", "--size", "120x90"});
  REQUIRE(point_into(display));
  REQUIRE(display.xdotool("key s"));
  const std::string first = printed(viewing, "-o spheres-depth-5.png");
  CHECK(first.find("--eye") == std::string::npos);  // nobody moved: the view of the command
  CHECK(first.find("--size 120x90") != std::string::npos);
  check_same_picture(folder, first);

  REQUIRE(display.xdotool("mousedown 1 mousemove 78 66 mousemove 90 66 mouseup 1 key s"));
  const std::string turned = printed(viewing, "-o spheres-depth-5-2.png");
  CHECK(turned.find("--eye") != std::string::npos);
  check_same_picture(folder, turned);

  REQUIRE(display.xdotool("click 4 click 4 click 4 mousedown 3 mousemove 72 36 mouseup 3 key s"));
  check_same_picture(folder, printed(viewing, "-o spheres-depth-5-3.png"));

  REQUIRE(display.xdotool("key 5 key s"));  // from above: up has to be named
  const std::string above = printed(viewing, "-o spheres-depth-5-4.png");
  CHECK(above.find("--up") != std::string::npos);
  check_same_picture(folder, above);

  REQUIRE(display.xdotool("search --name '^thimble: ' windowsize 150 110 sleep 0.3 key 1 key s"));
  const std::string front = printed(viewing, "-o spheres-depth-5-5.png");
  CHECK(front.find("--size 150x110") != std::string::npos);
  check_same_picture(folder, front);

  REQUIRE(display.xdotool("key q"));
  CHECK(viewing.wait() == 0);
  CHECK(viewing.err().empty());
}

TEST_CASE("view: shift drag, flight and a double click -> the eye goes where they say") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  std::string cube;
  for (int i = 0; i < 512; ++i) {
    cube += std::to_string(i % 8) + " " + std::to_string(i / 8 % 8) + " " + std::to_string(i / 64) + "\n";
  }
  folder.write("cube.xyz", cube);
  Viewing viewing(folder, {"view", "cube.xyz", "--as-voxels", "--size", "300x200", "--samples", "1"});
  REQUIRE(point_into(display));
  int saved = 0;
  // What s prints after these words of xdotool, as words.
  const auto after = [&](const std::string& gesture) {
    REQUIRE(display.xdotool(gesture + " sleep 0.1 key s"));
    ++saved;
    const std::string name = "-o cube" + (saved == 1 ? "" : "-" + std::to_string(saved)) + ".png";
    return words_of(printed(viewing, name));
  };
  const double front = first_number_after(after("key 1"), "--eye");
  // Shift and the left button: the scene goes right, so the eye goes left (towards smaller x).
  const double moved = first_number_after(
      after("mousemove 100 100 keydown shift mousedown 1 mousemove 150 100 mouseup 1 keyup shift"), "--eye");
  CHECK(moved < front - 1);
  const double flown = first_number_after(after("keydown d sleep 0.5 keyup d"), "--eye");
  CHECK(flown > moved + 1);
  const Words before = after("key 1");
  const Words looked = after("mousemove 130 100 sleep 0.5 click 1 click 1");
  CHECK(first_number_after(looked, "--eye") == doctest::Approx(front).epsilon(0.001));
  CHECK(first_number_after(looked, "--target") < first_number_after(before, "--target") - 0.2);
  REQUIRE(display.xdotool("mousemove 150 100"));  // what was looked at is in the middle now
  REQUIRE(display.xdotool("key p"));
  const std::string picked = printed(viewing, "voxel ");
  CHECK(picked.find("front face (-y), material ") != std::string::npos);
  REQUIRE(display.xdotool("key Escape"));
  CHECK(viewing.wait() == 0);
}

TEST_CASE("view: keys shown, Escape in the middle of a slow picture -> over at once") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  Viewing viewing(folder, {"water,depth=6", "--size", "900x700", "--samples", "64"});
  REQUIRE(point_into(display));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  const thimble::Rgb8 before = display.pixel(30, 150);
  REQUIRE(display.xdotool("key question sleep 0.5"));
  const thimble::Rgb8 panel = display.pixel(6, 150);
  CHECK(panel == thimble::Rgb8{32, 34, 38});
  CHECK_FALSE(before == panel);
  REQUIRE(display.xdotool("key question"));
  const auto start = Clock::now();
  REQUIRE(display.xdotool("key Escape"));
  CHECK(viewing.wait() == 0);
  const double seconds = seconds_since(start);
  MESSAGE("Escape to the end of the process, xdotool's own time in it: " << seconds << " s");
  CHECK(seconds < 0.5);  // 0.1 on a machine that does nothing else
}

TEST_CASE(
    "view: the file changes, or a model of the scene -> read again; half written -> the old picture, a "
    "sentence") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  for (const bool is_model : {false, true}) {
    const TemporaryFolder folder;
    folder.write("dots.xyz", "0 0 0\n9 9 9\n");
    const std::string shown = is_model ? "whole" : "dots";
    Words words{"dots.xyz", "--as-voxels"};
    if (is_model) {
      folder.write("whole.scene", "model dots.xyz as-voxels at 2 2 2\n");
      words = {"whole.scene"};
    }
    Viewing viewing(folder, words + Words{"--size", "300x200", "--samples", "1"});
    REQUIRE(point_into(display));
    int number = 0;
    const auto saved = [&] {
      const std::string name = shown + (++number == 1 ? "" : "-" + std::to_string(number)) + ".png";
      REQUIRE(display.xdotool("key s"));
      REQUIRE(viewing.prints("-o " + name));
      return read_text(folder.path(name));
    };
    const std::string first = saved();
    if (!is_model) {
      folder.write("dots.xyz", "0 0 0\n1 2 nothi");
      REQUIRE(viewing.complains("dots.xyz has changed and cannot be read: line 2"));
      CHECK(is_one_sentence(viewing.err()));
      CHECK(saved() == first);
    }
    folder.write("dots.xyz", "0 0 0\n9 9 9\n4 5 4\n3 3 3\n");
    CHECK(wait_until(20, [&] { return saved() != first; }));
    REQUIRE(display.xdotool("key Escape"));
    CHECK(viewing.wait() == 0);
  }
}

TEST_CASE(
    "view: a file is dropped on the window -> it is opened, and nothing is kept; other things are not") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  folder.write("first.xyz", "0 0 0\n9 9 9\n");
  const std::string other = folder.write("an other.xyz", "0 0 0\n1 5 9\n4 4 4\n");
  Viewing viewing(folder, {"first.xyz", "--size", "200x150", "--view", "front"});
  REQUIRE(point_into(display));
  const auto names = folder.names();
  CHECK_FALSE(display.drop("words", false));
  CHECK_FALSE(display.drop("http://nowhere.invalid/a.vox\r\n"));
  CHECK(display.drop("file:///nowhere/at%20all.vox\r\n"));
  CHECK(viewing.complains("/nowhere/at all.vox cannot be read"));
  std::string path = other;
  path.replace(path.find(' '), 1, "%20");
  CHECK(display.drop("file://" + path + "\r\n"));
  CHECK(display.xdotool("search --sync --name 'an other.xyz'"));
  CHECK(folder.names() == names);
  REQUIRE(display.xdotool("key s"));
  const std::string line = printed(viewing, "-o an-other.png");
  CHECK(line.find("--view front") != std::string::npos);
  CHECK(std::system(("cd " + folder.path() + " && '" THIMBLE_COMMAND_PATH "'" +
                     line.substr(line.find(' '), line.find(" -o") - line.find(' ')) +
                     " -o again.png --quiet && cmp -s again.png an-other.png")
                        .c_str()) == 0);
  REQUIRE(display.xdotool("key Escape"));
  CHECK(viewing.wait() == 0);
}

TEST_CASE(
    "view: an animation -> its frames play, space stops them; what is saved is the frame that was shown") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  // Models without a scene graph are frames: a voxel that walks along x.
  std::string models;
  for (int frame = 0; frame < 8; ++frame) {
    models += vox_model({8, 8, 8}, {{frame, 0, 0, 1}});
  }
  folder.write("walk.vox", vox_file(models));
  Viewing viewing(folder, {"walk.vox", "--size", "200x150"});
  REQUIRE(point_into(display));
  const auto frame_saved = [&](const std::string& name) {
    REQUIRE(display.xdotool("key s"));
    const std::string line = printed(viewing, "-o " + name);
    check_same_picture(folder, line);
    return first_number_after(words_of(line), "--frame");
  };
  double first = 0;
  CHECK(wait_until(20, [&] {  // it plays by itself
    static int number = 0;
    first = frame_saved(++number == 1 ? "walk.png" : "walk-" + std::to_string(number) + ".png");
    return first >= 1 && first <= 7;
  }));
  REQUIRE(display.xdotool("key space sleep 0.5"));
  const std::size_t taken = folder.names().size();
  const double stopped = frame_saved("walk-" + std::to_string(taken - 3) + ".png");
  CHECK(display.xdotool("sleep 0.5"));
  CHECK(frame_saved("walk-" + std::to_string(taken - 2) + ".png") == stopped);
  REQUIRE(display.xdotool("key Escape"));
  CHECK(viewing.wait() == 0);
  CHECK(viewing.err().empty());
}

TEST_CASE("view: water -> still; space lets it rain, space again lays it to rest as render draws it") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  Viewing viewing(folder, {"water,depth=5", "--size", "640x480", "--samples", "1"});
  REQUIRE(point_into(display));
  // Whether nothing moves for as long as the slowest step to the finished picture takes.
  std::string still;
  const auto rests = [&] {
    return wait_until(60, [&] {
      still = shown(display);
      std::this_thread::sleep_for(std::chrono::milliseconds(kSanitized ? 8000 : 1500));
      return still == shown(display);
    });
  };
  REQUIRE(rests());
  const std::string own = still;
  REQUIRE(display.xdotool("key space"));
  // One place takes more colours than water at rest has by the viewer's sizes of pixels; sanitized, where a frame takes
  // seconds, fewer do. Of all places each 101st: keeping the colours of every one takes longer than the frames do.
  constexpr std::size_t kMany = kSanitized ? 9 : 24;
  std::map<std::size_t, std::set<std::string>> colors;
  CHECK(wait_until(kSanitized ? 150 : 60, [&] {
    const std::string now = shown(display);
    bool many = false;
    for (std::size_t at = 0; at + 3 <= now.size(); at += std::size_t{3} * 101) {
      colors[at].insert(now.substr(at, 3));
      many = many || colors[at].size() > kMany;
    }
    return many;
  }));
  REQUIRE(display.xdotool("key space"));
  if (!kSanitized) {  // there it takes half a minute
    CHECK(rests());
    CHECK(still == own);
  }
  REQUIRE(display.xdotool("key s"));
  check_same_picture(folder, printed(viewing, "-o water-depth-5.png"));
  REQUIRE(display.xdotool("key Escape"));
  CHECK(viewing.wait() == 0);
  CHECK(viewing.err().empty());
}

TEST_CASE("view: without a display, in a terminal -> drawn there; keys, saving, Escape") {
  const TemporaryFolder folder;
  Pty pty(80, 24, [&] {
    ::unsetenv("DISPLAY");
    ::setenv("TERM", "xterm-256color", 1);
    if (::chdir(folder.path().c_str()) != 0) {
      return 126;
    }
    become_command({"spheres,depth=4"});
  });
  REQUIRE(pty.wait_for("\xe2\x96\x80", 20));  // the upper half block
  pty.type("?");
  CHECK(pty.wait_for("turns around the model", 20));
  pty.type("?s");
  CHECK(wait_until(30, [&] {
    pty.wait_for("saved", 0.1);
    return folder.names() == Words{"spheres-depth-4.png"};
  }));
  pty.type("\x1b[<0;20;10M\x1b[<32;30;10M\x1b[<0;30;10m");  // a drag
  pty.wait_for("frames/s", 5);
  pty.type("\x1b");
  REQUIRE(pty.wait_for_end(10));
  CHECK(pty.exit_status() == 0);
  // Told once the terminal is free again.
  const std::string end = pty.output().substr(pty.output().rfind("\x1b[?1049l"));
  CHECK(end.find("thimble render spheres,depth=4 --size 80x48 ") != std::string::npos);
}

TEST_CASE("sim: Escape in the middle of a frame that takes seconds -> over at once, as if it had ended") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  Viewing running(folder, {"sim", "water,depth=8", "--board", "raspi0"});
  REQUIRE(display.xdotool("search --sync --onlyvisible --name '^thimble sim' mousemove 100 100 sleep 0.3"));
  const auto start = Clock::now();
  REQUIRE(display.xdotool("key Escape"));
  CHECK(running.wait() == 0);
  const double seconds = seconds_since(start);
  MESSAGE("Escape to the end of the process, xdotool's own time in it: " << seconds << " s");
  CHECK(seconds < 0.5);
}

TEST_CASE("view: neither display nor terminal -> one sentence that names render, status 1") {
  ::unsetenv("DISPLAY");
  for (const Words& words : {Words{"spheres,depth=4"}, Words{"view", "spheres,depth=4"}}) {
    check_refused(words, 1, {"thimble render spheres,depth=4 -o picture.png"});
  }
  check_refused({"view", "spheres", "--display", "window"}, 1, {"DISPLAY"});
}

TEST_CASE("view: scenes that cannot be, options that contradict -> a sentence and no window") {
  const TemporaryFolder folder;
  check_refused({"nosuch.vox"}, 1, {"nosuch.vox"});
  check_refused({folder.write("empty.vox", "")}, 1, {"empty.vox"});
  check_refused({"points:x"}, 1, {"points"});
  check_refused({"view"}, 2, {"SCENE"});
  check_refused({"view", "spheres", "--samples", "65"}, 2, {"--samples", "auto", "1 to 64"});
  check_refused({"view", "spheres", "--display", "tv"}, 2, {"auto, window or terminal"});
  check_refused({"view", "spheres", "--shade", "depth", "--effects", "shadows"}, 2, {"--effects"});
  check_refused({"spheres", "--wheel"}, 2, {"thimble view"});
}

TEST_CASE("view: --bench -> a line of CSV under its columns, on any machine") {
  const auto lines =
      lines_of(check_done({"points:500,depth=6", "--bench", "5", "--size", "160x120", "--threads", "1"}).out);
  REQUIRE(lines.size() == 2);
  const Words names = split(lines[0]);
  // The scene's name has a comma of its own, and stands in quotes.
  CHECK(names.size() == 12);
  CHECK(lines[1].find("\"points:500,depth=6\",") == 0);
  CHECK(split(lines[1]).size() == names.size() + 1);
}

TEST_CASE("view, sim, particles: their display ends -> status 1 and one sentence that says so") {
  const std::vector<Words> tools{{"view", "spheres,depth=5", "--size", "200x150"},
                                 {"view", "water,depth=6", "--size", "600x500", "--samples", "64"},
                                 {"sim", "--display", "window"},
                                 {"particles", "--display", "window"}};
  for (const Words& words : tools) {
    CAPTURE(words[0]);
    VirtualDisplay display("1000x800x24");
    NEEDS_DISPLAY(display);
    const TemporaryFolder folder;
    const std::string wanted = "thimble: the display " + std::string(std::getenv("DISPLAY")) + " has ended\n";
    Viewing viewing(folder, words);
    REQUIRE(display.xdotool("search --sync --onlyvisible --class thimble"));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    display.stop();
    CHECK(viewing.wait() == 1);
    const std::string err = viewing.err();
    CAPTURE(err);
    CHECK(err.size() >= wanted.size());
    CHECK(err.substr(err.size() - std::min(err.size(), wanted.size())) == wanted);
    CHECK(err.find("X connection") == std::string::npos);
  }
}

TEST_CASE("view: a window too small for its rays says so, and no more once it has grown") {
  const VirtualDisplay display("1000x800x24");
  NEEDS_DISPLAY(display);
  const TemporaryFolder folder;
  Viewing viewing(folder, {"view", "spheres,depth=5", "--size", "900x300", "--samples", "1", "--fov", "120"});
  REQUIRE(point_into(display));
  // The panel of the text, on the line below the state: it is there for a message alone.
  const auto has_message = [&] { return display.pixel(5, 8 + 20 + 12) == thimble::Rgb8{32, 34, 38}; };
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  CHECK_FALSE(has_message());
  REQUIRE(display.xdotool("search --name '^thimble: ' windowsize 900 1 sleep 0.5"));
  REQUIRE(display.xdotool("search --name '^thimble: ' windowsize 900 300 sleep 0.5"));
  CHECK(wait_until(60, [&] { return !has_message(); }));
  REQUIRE(display.xdotool("mousemove 890 290 key p"));
  CHECK(wait_until(60, has_message));  // where a message would have been
  REQUIRE(display.xdotool("key q"));
  CHECK(viewing.wait() == 0);
}
