// The Linux framebuffer's pixels, on files that stand in for a device.
#include <doctest/doctest.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "linux/framebuffer.h"
#include "linux/pixels.h"
#include "support/check_command.h"

namespace {

using namespace thimble;
using namespace thimble::linux_port;

struct Kind {
  int32_t bits;
  size_t slack_bytes;  // after a row's pixels
};
// A stride that is odd for all of them.
constexpr Kind kKinds[] = {{16, 1}, {16, 0}, {24, 0}, {24, 2}, {32, 0}, {32, 3}};

std::string temporary(const char* name) {
  return (std::filesystem::temp_directory_path() / ("thimble_fb_" + std::to_string(getpid()) + "_" + name))
      .string();
}

// A picture in which every pixel differs from its neighbours in every channel.
std::vector<uint8_t> picture(int32_t width, int32_t height) {
  std::vector<uint8_t> bytes;
  for (int32_t y = 0; y < height; ++y) {
    for (int32_t x = 0; x < width; ++x) {
      bytes.push_back(static_cast<uint8_t>(x * 37 + y * 11));
      bytes.push_back(static_cast<uint8_t>(x * 5 + y * 83 + 7));
      bytes.push_back(static_cast<uint8_t>(255 - x * 19 - y * 3));
    }
  }
  return bytes;
}

// What 8 bits become in `length` bits, from the definition: the nearest of 2^length even steps.
int nearest(int value, int length) {
  const double most = (1 << length) - 1;
  return static_cast<int>(value / 255.0 * most + 0.5);
}

}  // namespace

TEST_CASE(
    "linux framebuffer: 16, 24 and 32 bits with any stride -> every pixel where it belongs, slack "
    "untouched") {
  const int32_t width = 13;
  const int32_t height = 7;
  const std::vector<uint8_t> shown = picture(width, height);
  for (const Kind& kind : kKinds) {
    CAPTURE(kind.bits);
    CAPTURE(kind.slack_bytes);
    const int32_t screen_width = 47;  // three times, and 8 columns left over
    const int32_t screen_height = 23;
    const size_t pixel_bytes = static_cast<size_t>(kind.bits / 8);
    const Layout layout =
        usual_layout(screen_width, screen_height,
                     static_cast<size_t>(screen_width) * pixel_bytes + kind.slack_bytes, kind.bits);
    REQUIRE(fault_of(layout) == nullptr);
    const Placement placement = place(width, height, layout);
    REQUIRE(placement.scale == 3);
    std::vector<uint8_t> screen(layout.bytes(), 0x5E);
    // In bands of unequal height, the last one first.
    for (const auto& [first, rows] : {std::pair{5, 2}, std::pair{0, 4}, std::pair{4, 1}}) {
      std::vector<uint8_t> band_bytes(shown.begin() + first * width * 3,
                                      shown.begin() + (first + rows) * width * 3);
      Band band;
      band.pixels = Bytes(band_bytes.data(), band_bytes.size());
      band.format = PixelFormat::kRgb888;
      band.first_row = first;
      band.rows = rows;
      put_band(band, width, layout, placement, Bytes(screen.data(), screen.size()));
    }
    size_t wrong = 0;
    for (int32_t y = 0; y < screen_height; ++y) {
      for (size_t at = 0; at < layout.stride_bytes; ++at) {
        const int32_t x = static_cast<int32_t>(at / pixel_bytes);
        const uint8_t found = screen[static_cast<size_t>(y) * layout.stride_bytes + at];
        const bool inside = x >= placement.left_px && x < placement.left_px + 3 * width &&
                            y >= placement.top_px && y < placement.top_px + 3 * height;
        if (!inside) {
          wrong += found != 0x5E;
          continue;
        }
        const size_t pixel =
            static_cast<size_t>((y - placement.top_px) / 3 * width + (x - placement.left_px) / 3);
        const int r = shown[3 * pixel];
        const int g = shown[3 * pixel + 1];
        const int b = shown[3 * pixel + 2];
        const uint32_t value =
            kind.bits == 16 ? static_cast<uint32_t>(nearest(r, 5) << 11 | nearest(g, 6) << 5 | nearest(b, 5))
                            : static_cast<uint32_t>(r << 16 | g << 8 | b);
        wrong += found != static_cast<uint8_t>(value >> (8 * (at % pixel_bytes)));
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("linux framebuffer: channels in another order -> taken as the device says") {
  Layout layout = usual_layout(1, 1, 4, 32);
  layout.red = {0, 8};
  layout.blue = {24, 6};
  std::vector<uint8_t> screen(4);
  uint8_t pixel[3] = {10, 20, 255};
  Band band;
  band.pixels = Bytes(pixel);
  band.rows = 1;
  put_band(band, 1, layout, {0, 0, 1}, Bytes(screen.data(), screen.size()));
  CHECK(screen == std::vector<uint8_t>{10, 20, 0, 63});
}

TEST_CASE("linux framebuffer: layouts that cannot be drawn -> refused with the reason") {
  CHECK(fault_of(usual_layout(0, 5, 10, 32)) != nullptr);
  CHECK(fault_of(usual_layout(5, 5, 20, 8)) != nullptr);
  CHECK(fault_of(usual_layout(5, 5, 19, 32)) != nullptr);
  Layout overflowing = usual_layout(5, 5, 20, 32);
  overflowing.red = {28, 8};
  CHECK(fault_of(overflowing) != nullptr);
  CHECK(place(48, 10, usual_layout(47, 23, 94, 16)).scale == 0);
}

TEST_CASE(
    "linux framebuffer: a stand-in file -> made as large as the screen, drawn into, a longer one keeps its "
    "end") {
  const std::string path = temporary("stand_in");
  const Layout layout = usual_layout(10, 4, 31, 24);
  { std::ofstream(path, std::ios::binary) << std::string(200, 'x'); }
  {
    Framebuffer framebuffer;
    REQUIRE(framebuffer.open_stand_in(path, layout) == "");
    REQUIRE(framebuffer.bytes().size == 124);
    framebuffer.clear();
  }
  std::ifstream file(path, std::ios::binary);
  const std::string found{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const std::string row = std::string(30, '\0') + "x";
  CHECK(found == row + row + row + row + std::string(76, 'x'));
  std::filesystem::remove(path);

  Framebuffer none;
  CHECK(none.open_device("/nonexistent/fb0").find("cannot open /nonexistent/fb0") != std::string::npos);
  CHECK(none.open_device("/dev/null").find("is not a framebuffer") != std::string::npos);
  CHECK(none.open_stand_in("/dev/full", layout) != "");
}

TEST_CASE(
    "thimble-fb: the demonstration on 16, 24 and 32 bits with odd strides -> the simulator's picture, pixel "
    "by pixel") {
  const tests::TemporaryFolder folder;
  const std::string scene = folder.path("demo.oct");
  const std::string shot = folder.path("shot.ppm");
  REQUIRE(tests::run_command({"bake", "demo", "-o", scene, "--quiet"}).status == 0);
  tests::check_done(
      {"sim", scene, "--board", "raspi0", "--display", "none", "--frames", "2", "--shot", shot, "--quiet"});
  const std::string expected = tests::read_text(shot);
  const size_t header = expected.size() - size_t{640} * 480 * 3;
  for (const Kind& kind : kKinds) {
    CAPTURE(kind.bits);
    const size_t pixel_bytes = static_cast<size_t>(kind.bits / 8);
    const size_t stride = 643 * pixel_bytes + kind.slack_bytes;  // 3 columns left over: one left, two right
    const std::string screen = folder.path("screen.raw");
    std::filesystem::remove(screen);
    tests::CommandLimits limits;
    limits.program = THIMBLE_FB_PATH;
    const std::string layout = "643,482," + std::to_string(kind.bits) + "," + std::to_string(stride);
    tests::check_done({"--frames", "2", "--stand-in", screen, "--layout", layout, "--size", "640,480", scene},
                      limits);
    const std::string bytes = tests::read_text(screen);
    REQUIRE(bytes.size() == stride * 482);
    size_t wrong = 0;
    for (size_t y = 0; y < 480; ++y) {
      for (size_t x = 0; x < 640; ++x) {
        const uint8_t* found =
            reinterpret_cast<const uint8_t*>(bytes.data()) + (y + 1) * stride + (x + 1) * pixel_bytes;
        const uint8_t* color = reinterpret_cast<const uint8_t*>(expected.data()) + header + (y * 640 + x) * 3;
        if (kind.bits == 16) {
          const int value = nearest(color[0], 5) << 11 | nearest(color[1], 6) << 5 | nearest(color[2], 5);
          wrong += (found[0] | found[1] << 8) != value;
        } else {
          wrong += found[0] != color[2] || found[1] != color[1] || found[2] != color[0];
        }
      }
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("thimble-fb: wrong use, unusable screens and scenes -> status 2 or 1, and one sentence why") {
  const tests::TemporaryFolder folder;
  const std::string damaged = folder.write("damaged.oct", "not a scene");
  const std::string link = folder.path("link.oct");
  const std::string pipe = folder.path("pipe");
  std::filesystem::create_symlink(damaged, link);
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  using tests::operator+;
  const auto screen = [&](const char* layout, const tests::Words& more) {
    return tests::Words{"--stand-in", folder.path("x"), "--frames", "1", "--layout", layout} + more;
  };
  struct Case {
    tests::Words words;
    int status;
    std::string says;
  };
  const Case cases[] = {
      {{"--stand-in", folder.path("x")}, 2, "--stand-in requires --layout"},
      {screen("9,9,8,9", {}), 1, "x: "},
      {screen("9,9,8", {}), 2, "--layout: At least 4"},
      {{"--device", "/nonexistent"}, 1, "cannot open /nonexistent: No such file"},
      {screen("9,9,32,36", {"--app", "nothing"}), 2, "there are demo, "},
      {screen("9,9,32,36", {"--app", "selftest", damaged}), 2, "\" is not for the application selftest"},
      {screen("9,9,32,36", {"--size", "10,9"}), 1, "10 x 9"},
      {screen("9,9,32,36", {"--size", "9"}), 2, "--size: At least 2"},
      {screen("9,9,32,36", {"--size", "9,9,9"}), 2, "--size: At Most 2"},
      {screen("9,9,32,36", {"--memory", "4G"}), 2, "--memory: "},
      {screen("99,99,32,396", {folder.path("none")}), 1, "none: No such file"},
      {screen("99,99,32,396", {folder.path()}), 1, " is no regular file"},
      {screen("99,99,32,396", {"/dev/zero"}), 1, "/dev/zero is no regular file"},
      {screen("99,99,32,396", {pipe}), 1, "pipe is no regular file"},
      {screen("99,99,32,396", {damaged}), 1, "damaged.oct ended with status 1"},
      {{damaged, "--stand-in", link, "--layout", "9,9,32,36"}, 1, "link.oct is the scene and would be over"},
  };
  tests::CommandLimits limits;
  limits.program = THIMBLE_FB_PATH;
  for (const Case& each : cases) {
    const tests::CommandResult refused = tests::run_command(each.words, limits);
    CAPTURE(tests::line_of_words(each.words));
    CAPTURE(refused.describe());
    CHECK(refused.status == each.status);
    CHECK(refused.err.starts_with("thimble-fb: "));
    CHECK(refused.err.find('\n') == refused.err.size() - 1);
    CHECK(refused.err.find(each.says) != std::string::npos);
  }
  CHECK(tests::read_text(damaged) == "not a scene");
}
