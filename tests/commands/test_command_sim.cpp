// thimble sim as a user meets it, without a screen: pictures, recordings, scripts, statuses.
#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "apps/app_table.h"
#include "support/check_command.h"
#include "support/pty.h"

namespace {

using namespace thimble::tests;

// Small, so that baking takes no time worth the name.
constexpr const char* kSimScene = "spheres,depth=4";

Words sim_words(const Words& words) {
  return Words{"sim"} + words + Words{"--display", "none"};
}
CommandResult sim(const Words& words) {
  return run_command(sim_words(words));
}
void check_sim_refused(const Words& words, int status, const Words& named) {
  check_refused(sim_words(words), status, named);
}

// The grey pixels of a P5.
std::string pixels_of(const std::string& pgm) {
  const std::size_t at = pgm.find("\n255\n");
  REQUIRE(at != std::string::npos);
  return pgm.substr(at + 5);
}

}  // namespace

TEST_CASE("sim: --shot, then --check with it -> equal; with another frame -> status 1, how many and where") {
  const TemporaryFolder folder;
  const std::string shot = folder.path("a.png");
  CHECK(sim({kSimScene, "--frames", "2", "--shot", shot, "--quiet"}).status == 0);
  const CommandResult equal = sim({kSimScene, "--frames", "2", "--check", shot});
  CAPTURE(equal.describe());
  CHECK(equal.status == 0);
  CHECK(equal.err.find("equal") != std::string::npos);
  const CommandResult differs = sim({kSimScene, "--frames", "9", "--check", shot, "--quiet"});
  CAPTURE(differs.describe());
  CHECK(differs.status == 1);
  CHECK(is_one_sentence(differs.err));
  CHECK(differs.err.find("of 8,192 pixels differ") != std::string::npos);
  CHECK(differs.err.find("the first is at ") != std::string::npos);
  CHECK(folder.names() == Words{"a.png"});
}

TEST_CASE("sim: one pixel changed by hand -> that pixel is named, with both values") {
  const TemporaryFolder folder;
  const std::string shot = folder.path("a.ppm");
  REQUIRE(sim({kSimScene, "--shot", shot, "--quiet"}).status == 0);
  std::string bytes = read_text(shot);
  // From the end: 3 bytes a pixel, 128 pixels a row.
  const std::size_t at = bytes.size() - 3 * (2 * 128 - 5);
  const char before = bytes[at];
  bytes[at] = static_cast<char>(before ^ 1);
  const CommandResult result = sim({kSimScene, "--check", folder.write("b.ppm", bytes), "--quiet"});
  CAPTURE(result.describe());
  CHECK(result.status == 1);
  CHECK(result.err.find("1 of 8,192 pixels differs; the first is at 5,62: #") != std::string::npos);
}

TEST_CASE("sim: --keys -> buttons change the picture, the same script gives the same one, q ends") {
  const TemporaryFolder folder;
  const std::string keys = folder.write("keys.txt", "0: down left\n");
  const std::string with = folder.path("with.png");
  REQUIRE(sim({kSimScene, "--frames", "6", "--keys", keys, "--shot", with, "--quiet"}).status == 0);
  CHECK(sim({kSimScene, "--frames", "6", "--keys", keys, "--check", with, "--quiet"}).status == 0);
  CHECK(sim({kSimScene, "--frames", "6", "--check", with, "--quiet"}).status == 1);
  const std::string quits = folder.write("quits.txt", "3: type q\n");
  const CommandResult ended = sim({kSimScene, "--frames", "1000000", "--keys", quits});
  CHECK(ended.status == 0);
  CHECK(ended.err.find(": 3 frames") != std::string::npos);
}

TEST_CASE("sim: --record -> a YUV4MPEG2 file of so many frames, the last one as in --shot") {
  const TemporaryFolder folder;
  const std::string video = folder.path("a.y4m");
  const std::string shot = folder.path("a.pgm");
  REQUIRE(
      sim({kSimScene, "--frames", "4", "--fps", "25", "--record", video, "--shot", shot, "--quiet"}).status ==
      0);
  const std::string bytes = read_text(video);
  const std::string header = "YUV4MPEG2 W128 H64 F25:1 Ip A1:1 Cmono\n";
  CHECK(bytes.substr(0, header.size()) == header);
  REQUIRE(bytes.size() == header.size() + 4 * (6 + 8192));
  CHECK(bytes.substr(bytes.size() - 8198, 6) == "FRAME\n");
  CHECK(bytes.substr(bytes.size() - 8192) == pixels_of(read_text(shot)));

  const std::string color = folder.path("color.y4m");
  REQUIRE(sim({kSimScene, "--board", "raspi0", "--frames", "2", "--record", color, "--quiet"}).status == 0);
  const std::string color_header = "YUV4MPEG2 W640 H480 F30:1 Ip A1:1 C444\n";
  CHECK(read_text(color).substr(0, color_header.size()) == color_header);
  CHECK(read_text(color).size() == color_header.size() + 2 * (6 + 3 * 640 * 480));
}

TEST_CASE("sim: a baked scene -> the same picture as the scene that it was baked from") {
  const TemporaryFolder folder;
  const std::string baked = folder.path("a.oct");
  const std::string shot = folder.path("a.png");
  check_done({"bake", kSimScene, "--board", "lm3s6965evb", "-o", baked, "--quiet"});
  REQUIRE(sim({kSimScene, "--frames", "3", "--shot", shot, "--quiet"}).status == 0);
  CHECK(sim({baked, "--frames", "3", "--check", shot, "--quiet"}).status == 0);
}

TEST_CASE("sim: an application that goes wrong -> status 97, what it did, and no files") {
  const TemporaryFolder folder;
  struct Case {
    const char* keys;
    const char* says;
  };
  for (const Case& each :
       {Case{"0: type s", "stack overflowed"}, Case{"0: type r", "wrote past its RAM: byte 61440"},
        Case{"0: type f", "wrote at the address"}}) {
    const std::string keys = folder.write("keys.txt", each.keys);
    const CommandResult result = sim({"--app", "faults", "--keys", keys, "--shot", folder.path("a.png"),
                                      "--record", folder.path("a.y4m")});
    CAPTURE(each.keys);
    CAPTURE(result.describe());
    CHECK(result.status == 97);
    CHECK(is_one_sentence(result.err));
    CHECK(result.err.find(std::string("faults on lm3s6965evb was stopped: ")) != std::string::npos);
    CHECK(result.err.find(each.says) != std::string::npos);
    CHECK(folder.names() == Words{"keys.txt"});
  }
}

TEST_CASE("sim: an application that waits for keys which cannot come -> it takes those that do, and ends") {
  const TemporaryFolder folder;
  // The last line's frame never comes: it draws none.
  const std::string keys = folder.write("keys.txt", "0: down left\n0: type xyzb\n1: type s");
  CHECK(sim({"--app", "faults", "--frames", "9"}).status == 0);
  const CommandResult ended = sim({"--app", "faults", "--keys", keys});
  CAPTURE(ended.describe());
  CHECK(ended.status == 0);
  CHECK(ended.out.find("down: left\n") != std::string::npos);
}

TEST_CASE("sim: wrong usage -> status 2 and a sentence that quotes what is wrong") {
  check_sim_refused({"--board", "toaster"}, 2, {"\"toaster\"", "lm3s6965evb"});
  check_sim_refused({"--app", "editor"}, 2, {"\"editor\"", "demo"});
  check_sim_refused({"--theme", "neon"}, 2, {"\"neon\"", "oled"});
  check_sim_refused({"--scale", "0"}, 2, {"\"0\""});
  check_sim_refused({"--frames", "0"}, 2, {"\"0\""});
  check_sim_refused({"--frames", "many"}, 2, {"\"many\""});
  check_sim_refused({"--shot", "a.tga"}, 2, {"\"a.tga\"", ".png"});
  check_sim_refused({"--shot", "-"}, 2, {"\"-\""});
  check_sim_refused({"--record", "a.mp4"}, 2, {"\"a.mp4\"", ".y4m"});
  check_sim_refused({kSimScene, "more"}, 2, {"\"more\""});
}

TEST_CASE(
    "sim: files that cannot be used -> status 1, a sentence that names them, and nothing is left behind") {
  const TemporaryFolder folder;
  check_sim_refused({folder.path("none.vox")}, 1, {"none.vox", "cannot be opened"});
  check_sim_refused({kSimScene, "--check", folder.path("none.png")}, 1, {"none.png: cannot be opened"});
  check_sim_refused({kSimScene, "--check", folder.write("bad.png", "not a picture")}, 1,
                    {"bad.png: is no PNG"});
  check_sim_refused({kSimScene, "--check", folder.write("small.ppm", "P6\n2 1\n255\nabcdef")}, 1,
                    {"small.ppm: is 2 x 1 pixels, not 128 x 64"});
  check_sim_refused({kSimScene, "--keys", folder.path("none.txt")}, 1, {"none.txt: cannot be opened"});
  check_sim_refused({kSimScene, "--keys", folder.write("keys.txt", "0: down up\n1: jump")}, 1,
                    {"keys.txt: line 2: \"jump\""});
  check_sim_refused({kSimScene, "--shot", folder.path("none/a.png")}, 1, {"none/a.png"});
  check_sim_refused({kSimScene, "--record", folder.path("none/a.y4m")}, 1, {"none/a.y4m"});
  const std::string both = folder.path("keys.txt");
  check_sim_refused({kSimScene, "--keys", both, "--check", both}, 1, {"keys.txt"});
  check_sim_refused({"points:200000,depth=8", "--board", "stm32vldiscovery"}, 1,
                    {"stm32vldiscovery has ", " bytes of flash for a scene", "--coarsen"});
  CHECK(folder.names() == Words{"bad.png", "keys.txt", "small.ppm"});
}

TEST_CASE(
    "sim: in a terminal -> picture, memory and UART in it; afterwards the UART's text and the summary") {
  Pty pty(140, 40, [] {
    ::unsetenv("DISPLAY");
    ::execl(THIMBLE_COMMAND_PATH, "thimble", "sim", kSimScene, "--display", "terminal",
            static_cast<char*>(nullptr));
    return 127;
  });
  REQUIRE(pty.wait_for("\u2580"));
  CHECK(pty.wait_for("RAM "));
  CHECK(pty.wait_for("not the chip's; board: 4,096"));
  CHECK(pty.wait_for("UART: "));
  pty.type("?");
  CHECK(pty.wait_for("holds a rate of frames"));
  pty.type("\x1b[D");
  pty.type("\x1b");
  CHECK(pty.wait_for("\x1b[?1049l"));
  CHECK(pty.wait_for("thimble demo on lm3s6965evb"));
  CHECK(pty.wait_for(" frames, "));
  CHECK(pty.wait_for_end());
  CHECK(pty.exit_status() == 0);
}
