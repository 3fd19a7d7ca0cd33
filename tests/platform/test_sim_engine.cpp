// What draws for a simulated board: the pictures, what the application says and what it takes of the board
// are the same, whoever draws.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "apps/apps.h"
#include "apps/demo_view.h"
#include "boards/board_table.h"
#include "host/drawn_frame.h"
#include "readers/source.h"
#include "scene/baking.h"
#include "scene/wide_frames.h"
#include "support/check_command.h"
#include "support/counts.h"
#include "support/json.h"
#include "support/simulated_run.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

const std::uint32_t kFrames = thimble::tests::many_or_few<std::uint32_t>(24, 6);

constexpr const char* kScene = "spheres,depth=4";

struct Ran {
  CommandResult result;
  Json stats;
  std::string video;
};

// Every frame of a run, and all that it says about itself.
Ran run_sim(const TemporaryFolder& folder, const Words& words) {
  Ran ran;
  const std::string stats = folder.path("stats.json");
  const std::string video = folder.path("frames.y4m");
  ran.result =
      run_command(Words{"sim"} + words + Words{"--display", "none", "--stats", stats, "--record", video});
  CAPTURE(ran.result.describe());
  REQUIRE(ran.result.status == 0);
  ran.stats = read_json(stats);
  ran.video = read_text(video);
  return ran;
}

// The same application on the same board: all but times and who drew.
void check_same(Ran one, Ran other) {
  CHECK(one.result.out == other.result.out);
  CHECK(one.video == other.video);
  for (const char* const differs : {"frame_seconds", "engine", "threads"}) {
    one.stats.erase(differs);
    other.stats.erase(differs);
  }
  CHECK(one.stats == other.stats);
}

const std::vector<std::uint8_t>& spheres() {
  static const tools::Baked baked =
      tools::bake_scene(*tools::open_scene({.scene = kScene, .depth = std::nullopt}), {});
  static const std::vector<std::uint8_t> bytes(baked.bytes.begin(), baked.bytes.end());
  return bytes;
}

// A run of an application whose frames `painter` draws; what its wait throws comes through.
struct Simulated : tests::SimulatedRun {
  std::uint32_t crc = 0;  ///< of all pictures, one after the other
};

Simulated simulate(int (*application)(), host::FramePainter* painter, std::uint32_t frames,
                   const std::string& typed = "") {
  const ConstBytes scene(spheres().data(), spheres().size());
  Simulated ran{
      tests::run_simulated({&flagship(), true, scene, application, 0, painter}, frames, {{{0, typed}}, {}})};
  for (const host::PackedPicture& picture : ran.pictures) {
    ran.crc = crc32({picture.bytes.data(), picture.bytes.size()}, ran.crc);
  }
  return ran;
}

// Draws with the core, on the other thread, and may do worse.
class CorePainter final : public host::FramePainter {
 public:
  bool draw(const CompactTree& tree, const Camera& camera, const Shading& shading, PixelFormat format,
            Bytes pixels) override {
    ++frames;
    if (refuses) {
      return false;
    }
    REQUIRE(render_band(tree, camera, shading, {pixels, format, 0, 0, camera.height_px()}) == Status::kOk);
    pixels.data[pixels.size / 2] = static_cast<std::uint8_t>(pixels.data[pixels.size / 2] ^ flips);
    return true;
  }
  std::uint32_t frames = 0;
  bool refuses = false;
  std::uint8_t flips = 0;
};

}  // namespace

TEST_CASE("sim --engine: every display, hands and keys -> pictures, UART and the board's figures are equal") {
  const TemporaryFolder folder;
  // Turned, near, still, sent over the UART; built in RAM, and back; a rate held, and not any more.
  const std::string keys =
      folder.write("keys.txt",
                   "0: type c\n1: down left\n3: up left\n3: down select up\n5: up select up\n"
                   "5: type tp\n7: type t\n8: type b\n11: type s\n13: type h\n"
                   "18: type t\n20: type th\n");
  for (const char* const board : {"lm3s6965evb", "microbit", "mps2-an500", "stm32vldiscovery"}) {
    CAPTURE(board);
    const Words words{kScene, "--board", board, "--frames", std::to_string(kFrames), "--keys", keys};
    const Ran core = run_sim(folder, words + Words{"--engine", "ray64"});
    const Ran wide = run_sim(folder, words + Words{"--engine", "wide"});
    CHECK(core.stats["engine"] == "ray64");
    CHECK(wide.stats["engine"] == "wide");
    CHECK(core.stats["frames"] == kFrames);
    check_same(core, wide);
    CHECK(core.result.err.find(", engine ray64\n") != std::string::npos);
    CHECK(wide.result.err.find(", engine wide\n") != std::string::npos);
  }
}

TEST_CASE("sim --engine: the demonstration at 640 x 480, by one thread and by two -> the core's frames") {
  const TemporaryFolder folder;
  const Words words{"demo", "--board", "raspi0", "--frames", "3"};
  const Ran core = run_sim(folder, words + Words{"--engine", "ray64"});
  for (const char* const threads : {"1", "2"}) {
    const Ran wide = run_sim(folder, words + Words{"--threads", threads});
    CHECK(wide.stats["engine"] == "wide");  // unasked
    CHECK(wide.stats["threads"] == std::stoi(threads));
    check_same(core, wide);
  }
}

TEST_CASE("sim --engine: frames with light, and a rate that is held -> the same, whoever draws the others") {
  const TemporaryFolder folder;
  const Words lit{kScene,
                  "--board",
                  "lm3s6965evb",
                  "--frames",
                  "5",
                  "--effects",
                  "direct-light,ambient-occlusion",
                  "--keys",
                  folder.write("keys.txt", "0: type c\n2: down right\n3: up right\n")};
  const Ran core_lit = run_sim(folder, lit + Words{"--engine", "ray64"});
  CHECK(core_lit.result.out.find(" lit\n") != std::string::npos);
  check_same(core_lit, run_sim(folder, lit + Words{"--engine", "wide"}));
  const Words held{
      kScene, "--hold", "30", "--frames", "8", "--keys", folder.write("still.txt", "4: type t\n")};
  check_same(run_sim(folder, held + Words{"--engine", "ray64"}), run_sim(folder, held));
}

TEST_CASE(
    "sim --engine: words that there are not, applications that it is not for -> status 2, one sentence") {
  const auto refused = [](const Words& words, const Words& named) {
    check_refused(Words{"sim"} + words + Words{"--display", "none"}, 2, named);
  };
  refused({"--engine", "fast"}, {"--engine", "\"fast\"", "auto, wide or ray64"});
  refused({"--engine", "ray32"}, {"\"ray32\""});
  refused({"--threads", "0"}, {"--threads", "\"0\""});
  refused({"--engine", "wide", "--app", "selftest"}, {"--engine", "selftest"});
  refused({"--engine", "wide", "--app", "water"}, {"--engine", "water"});
}

TEST_CASE("sim --engine: applications that nothing else draws for -> statistics name no engine") {
  const TemporaryFolder folder;
  const std::string stats = folder.path("stats.json");
  const CommandResult result =
      check_done({"sim", "--app", "particles", "--frames", "2", "--display", "none", "--stats", stats});
  CHECK_FALSE(read_json(stats).contains("engine"));
  CHECK(result.err.find("engine") == std::string::npos);
}

TEST_CASE(
    "sim --engine: a camera that is too fine -> the core draws, or --engine wide says so with status 1") {
  const TemporaryFolder folder;
  const std::string fine = folder.path("fine.oct");
  check_done({"bake", "points:2000,depth=6", "--fov", "1", "--direction-bits", "8", "--eye=-200,20,30",
              "--board", "lm3s6965evb", "-o", fine, "--quiet"});
  const Words words{fine, "--frames", "3"};
  const Ran core = run_sim(folder, words + Words{"--engine", "ray64"});
  const Ran any = run_sim(folder, words);
  CHECK(any.stats["engine"] == "ray64");
  check_same(core, any);
  const std::string shot = folder.path("shot.png");
  const CommandResult refused =
      run_command({"sim", fine, "--engine", "wide", "--display", "none", "--shot", shot});
  CHECK(refused.status == 1);
  CHECK(refused.err.find("--engine wide does not take the rays of this camera") != std::string::npos);
  CHECK(folder.names() == Words{"fine.oct", "frames.y4m", "stats.json"});
}

TEST_CASE("wide frames: no room for them -> the core draws the same, or an error that says so") {
  const Simulated core = simulate(apps::demo, nullptr, kFrames);
  tools::WideFrames roomy(true);
  const Simulated wide = simulate(apps::demo, &roomy, kFrames);
  CHECK(wide.crc == core.crc);
  // The core draws the first frame, so that its stack is seen. Others may sweep more tiles, which takes more.
  CHECK(wide.use.stack_bytes >= simulate(apps::demo, nullptr, 1).use.stack_bytes);
  CHECK(wide.use.stack_bytes <= core.use.stack_bytes);
  CHECK(roomy.drawn() == kFrames);
  CHECK(roomy.left() == 0);
  tools::WideFrames narrow(false, 1, 1000);
  CHECK(simulate(apps::demo, &narrow, kFrames).crc == core.crc);
  CHECK(narrow.drawn() == 0);
  CHECK(narrow.left() == kFrames);
  tools::WideFrames insisting(true, 1, 1000);
  CHECK_THROWS_WITH_AS(simulate(apps::demo, &insisting, 1), "no room for --engine wide", tools::InputError);
}

TEST_CASE(
    "painted frames: a picture that differs in a bit -> the application is stopped in the first frame") {
  CorePainter painter;
  painter.flips = 1;
  const Simulated ran = simulate(apps::demo, &painter, 4);
  CHECK(ran.status == port::kFaultStatus);
  CHECK(ran.fault.find("another picture than the core: row 32") != std::string::npos);
}

TEST_CASE("painted frames: bands of some rows -> drawn once a frame, and again for a picture over the UART") {
  const Simulated core = simulate(apps::demo, nullptr, 6);
  CorePainter painter;
  CHECK(simulate(apps::demo, &painter, 6).crc == core.crc);
  CHECK(painter.frames == 6);
  CorePainter refusing;
  refusing.refuses = true;
  CHECK(simulate(apps::demo, &refusing, 6).crc == core.crc);
  CHECK(refusing.frames == 6);
  // It stands still: each frame is drawn all the same.
  CorePainter still;
  CHECK(simulate(apps::demo, &still, 6, "t").status == 0);
  CHECK(still.frames == 6);
  // The scene that is built in RAM may change at any time, and is the core's.
  CorePainter building;
  CHECK(simulate(apps::demo, &building, 6, "b").status == 0);
  CHECK(building.frames == 0);
}

TEST_CASE("painted frames: bands that cannot be, trees and palettes outside flash -> left to the core") {
  BakedScene scene;
  REQUIRE(BakedScene::open({spheres().data(), spheres().size()}, &scene) == Status::kOk);
  CorePainter painter;
  host::DrawnFrame frame(&painter, scene.bytes());
  const CompactTree& tree = scene.tree();
  const apps::Orbit orbit = apps::orbit_of(scene);
  const Shading shading = apps::demo_shading(scene.palette());
  Camera camera;
  REQUIRE(apps::view_at(orbit, tree, 0, {}, 32, 16, &camera) == Status::kOk);
  std::vector<std::uint8_t> pixels(32 * 16);
  const auto band = [&](std::int32_t first, std::int32_t rows, std::size_t stride = 0,
                        std::size_t size = 512) {
    return Band{{pixels.data(), size}, PixelFormat::kGray8, stride, first, rows};
  };
  std::uintptr_t stack = 1000;
  const auto hand_out = [&](const Band& wanted, const Shading& with) {
    if (frame.begins_with(tree, camera, with, wanted, stack)) {
      frame.draw();
    }
    return frame.hand_out(wanted);
  };
  // The first frame is left to the core; what it drew is looked at.
  CHECK_FALSE(hand_out(band(0, 16), shading));
  REQUIRE(render_band(tree, camera, shading, band(0, 16)) == Status::kOk);
  CHECK_FALSE(frame.contradicts(band(0, 16)));
  const std::vector<std::uint8_t> right = pixels;
  pixels.assign(pixels.size(), 0x33);
  CHECK(hand_out(band(0, 16), shading));
  CHECK(pixels == right);
  CHECK_FALSE(frame.contradicts(band(0, 16)));
  CHECK(painter.frames == 2);
  // Rows beyond the picture, too few bytes, a stride that is too short.
  CHECK_FALSE(hand_out(band(8, 9), shading));
  CHECK_FALSE(hand_out(band(-1, 2), shading));
  CHECK_FALSE(hand_out(band(0, 0), shading));
  CHECK_FALSE(hand_out(band(0, 2, 0, 63), shading));
  CHECK_FALSE(hand_out(band(0, 2, 31), shading));
  CHECK_FALSE(hand_out(band(0, 2, SIZE_MAX), shading));
  CHECK(hand_out(band(0, 2, 0, 64), shading));
  CHECK(hand_out(band(2, 2, 100, 132), shading));
  // A palette in RAM: after a frame with the same camera and tree, too.
  const std::vector<Rgb8> palette(scene.palette().begin(), scene.palette().end());
  Shading other = shading;
  other.palette = {palette.data(), palette.size()};
  CHECK_FALSE(hand_out(band(4, 2), other));
  // Another light: drawn anew in the middle of the picture.
  const std::uint32_t before = painter.frames;
  other = shading;
  other.face_light[5] = 9;
  CHECK(hand_out(band(8, 2), other));
  CHECK(painter.frames == before + 1);
  // From deeper on the stack: left to the core, but only once.
  stack = 999;
  CHECK_FALSE(hand_out(band(0, 2), shading));
  CHECK_FALSE(hand_out(band(2, 2), shading));
  CHECK(hand_out(band(0, 2), shading));
  // A tree in RAM.
  const std::vector<std::uint8_t> copy = spheres();
  host::DrawnFrame elsewhere(&painter, {copy.data(), copy.size()});
  CHECK_FALSE(elsewhere.begins_with(tree, camera, shading, band(0, 2), stack));
  CHECK_FALSE(elsewhere.hand_out(band(0, 2)));
}
