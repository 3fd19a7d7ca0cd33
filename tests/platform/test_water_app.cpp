// The application `water` on simulated boards: a still scene costs nothing, and what is drawn again is all
// that can have changed.
#include <doctest/doctest.h>

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "apps/apps.h"
#include "apps/demo_view.h"
#include "apps/moving_water.h"
#include "boards/board_table.h"
#include "port.h"
#include "scene/baking.h"
#include "scene/random.h"
#include "support/baked_demo.h"
#include "support/lit_world.h"
#include "support/simulated_run.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"

namespace {

using namespace thimble;

#ifdef __SANITIZE_ADDRESS__
constexpr const char* kWaterScene = "water,depth=5";
constexpr bool kIsSlow = true;
#else
constexpr const char* kWaterScene = "water";
constexpr bool kIsSlow = false;
#endif

const std::vector<std::uint8_t>& baked(const char* text) {
  static std::map<std::string, std::vector<std::uint8_t>> scenes;
  std::vector<std::uint8_t>& bytes = scenes[text];
  if (bytes.empty()) {
    const tools::Baked made = tests::bake_words(text);
    bytes.assign(made.bytes.begin(), made.bytes.end());
  }
  return bytes;
}
ConstBytes bytes_of(const std::vector<std::uint8_t>& bytes) {
  return {bytes.data(), bytes.size()};
}

struct Counters {
  unsigned frames = 0;
  unsigned drawn = 0;
  unsigned skipped = 0;
  unsigned steps = 0;
  unsigned columns = 0;
  unsigned touches = 0;
  unsigned splashes = 0;
  std::string rest;
};

using tests::Hand;

struct Run : tests::SimulatedRun {
  std::vector<Counters> counters;  ///< every line of them
};

Run run_water(const platform::BoardFacts& board, ConstBytes scene, std::uint32_t frames, const Hand& hand) {
  Run run{tests::run_simulated({&board, true, scene, apps::water}, frames, hand), {}};
  for (std::size_t at = run.out.find("\nframes "); at != std::string::npos;
       at = run.out.find("\nframes ", at + 1)) {
    Counters now;
    const std::size_t end = run.out.find('\n', at + 1);
    const std::string line = run.out.substr(at + 1, end - at - 1);
    REQUIRE(std::sscanf(line.c_str(),
                        "frames %u bands drawn %u bands skipped %u steps %u columns stepped %u touches %u "
                        "splashes %u",
                        &now.frames, &now.drawn, &now.skipped, &now.steps, &now.columns, &now.touches,
                        &now.splashes) == 7);
    now.rest = line.substr(line.find(" water "));
    run.counters.push_back(now);
  }
  return run;
}

platform::BoardFacts board_of(const char* name, std::int32_t width = 0, std::int32_t height = 0) {
  platform::BoardFacts board = platform::board_for(*platform::find_board(name), "water");
  if (width != 0) {
    board.width_px = width;
    board.height_px = height;
  }
  return board;
}

std::string at_pixel(char what, std::int32_t x, std::int32_t y) {
  return what + std::to_string(x) + "," + std::to_string(y) + ".";
}

}  // namespace

TEST_CASE("water app: nobody touches anything -> no column is stepped, one picture is drawn and then none") {
  const platform::BoardFacts board = board_of("raspi0", 96, 72);
  const Run run = run_water(board, bytes_of(baked(kWaterScene)), 12, {});
  CHECK(run.fault.empty());
  CHECK(run.status == 0);
  REQUIRE(run.counters.size() == 1);
  const Counters& counters = run.counters[0];
  CHECK(counters.frames == 12);
  CHECK(counters.drawn == 9);
  CHECK(counters.skipped == 11 * 9);
  CHECK(counters.steps == 0);
  CHECK(counters.columns == 0);
  CHECK(counters.rest.ends_with(" still"));
  CHECK(run.rows_sent == 72);
  CHECK(run.rows_kept == 11 * 72);
  REQUIRE(run.pictures.size() == 12);
  for (const host::PackedPicture& picture : run.pictures) {
    CHECK(picture.bytes == run.pictures[0].bytes);
  }
}

TEST_CASE(
    "water app: water that was touched -> moves, draws the bands that see it, and costs nothing after") {
  const std::int32_t width = kIsSlow ? 24 : 48;
  const platform::BoardFacts board = board_of("raspi0", width, width * 3 / 4);
  Hand hand;
  hand.keys[2] = at_pixel('@', width / 2, width * 34 / 64);
  const std::uint32_t frames = 700;
  hand.keys[frames - 20] = "i";
  const Run run = run_water(board, bytes_of(baked("water,depth=4")), frames, hand);
  CHECK(run.status == 0);
  REQUIRE(run.counters.size() == 2);
  CHECK(run.counters[0].touches == 1);
  CHECK(run.counters[0].columns > 1000);
  CHECK(run.counters[0].rest.ends_with(" still"));
  // Some bands show only sky and wall: they were drawn once.
  CHECK(run.counters[0].skipped > frames / 2);
  // It has come to rest: nothing since then.
  CHECK(run.counters[1].columns == run.counters[0].columns);
  CHECK(run.counters[1].steps == run.counters[0].steps);
  CHECK(run.counters[1].drawn == run.counters[0].drawn);
  // It looks as before.
  CHECK(run.pictures[3].bytes != run.pictures[0].bytes);
  CHECK(run.pictures.back().bytes == run.pictures[0].bytes);
}

TEST_CASE("water app: touches, drops, rain and a moving camera -> every frame as if all were drawn again") {
  struct Case {
    const char* board;
    const char* scene;
    std::int32_t width;
    std::int32_t height;
  };
  for (const Case& each : {Case{"raspi0", kWaterScene, 56, 42}, Case{"lm3s6965evb", "water,depth=5", 64, 48},
                           Case{"raspi0", "water,seed=3,depth=5", 50, 70},
                           // So narrow that a ball hides all of a band, and the water behind it.
                           Case{"raspi0", kWaterScene, 3, 160}}) {
    platform::BoardFacts board = board_of(each.board, each.width, each.height);
    CAPTURE(each.scene);
    CAPTURE(each.board);
    const std::uint32_t frames = kIsSlow ? 40 : 64;
    Hand hand;
    tools::SplitMix64 random(7);
    // One after the other, so that every compiler draws the same numbers.
    const auto pixel = [&](char what) {
      const std::int32_t y = random.between(0, each.height - 1);
      return at_pixel(what, random.between(0, each.width - 1), y);
    };
    for (std::uint32_t frame = 3; frame < frames; frame += 5) {
      hand.keys[frame] = pixel(frame % 10 == 3 ? '@' : '!');
      hand.keys[frame] += pixel('!');
    }
    hand.keys[4] = at_pixel('@', each.width / 2, each.height * 34 / 48);  // water, whatever the others hit
    hand.keys[frames / 2] += "m";
    hand.keys[frames * 3 / 4] += "k";
    hand.buttons[frames / 4] = port::kLeft;
    hand.buttons[frames / 4 + 3] = 0;
    hand.buttons[frames / 2] = port::kSelect;
    hand.buttons[frames / 2 + 1] = port::kSelect | port::kUp;
    hand.buttons[frames / 2 + 2] = 0;
    hand.buttons[frames * 7 / 8] = port::kDown;
    hand.buttons[frames * 7 / 8 + 1] = 0;
    const Run some = run_water(board, bytes_of(baked(each.scene)), frames, hand);
    Hand everything = hand;
    everything.keys[0] = "o";
    const Run all = run_water(board, bytes_of(baked(each.scene)), frames, everything);
    CHECK(some.fault.empty());
    REQUIRE(some.status == 0);
    REQUIRE(all.status == 0);
    REQUIRE(some.pictures.size() == frames);
    REQUIRE(all.pictures.size() == frames);
    for (std::size_t i = 0; i < frames; ++i) {
      CAPTURE(i);
      CHECK(some.pictures[i].bytes == all.pictures[i].bytes);
    }
    // The work was not the same.
    REQUIRE(some.counters.size() == 1);
    REQUIRE(all.counters.size() == 1);
    CHECK(all.counters[0].skipped == 0);
    CHECK(some.counters[0].skipped > 0);
    CHECK(some.counters[0].drawn + some.counters[0].skipped == all.counters[0].drawn);
    CHECK(some.counters[0].rest == all.counters[0].rest);
    CHECK(some.counters[0].splashes > 0);
    CHECK(some.counters[0].touches > 0);
  }
}

TEST_CASE("water app: its first picture -> that of the scene as it was baked, its water at rest") {
  const platform::BoardFacts board = board_of("raspi0", 96, 72);
  const std::vector<std::uint8_t>& bytes = baked(kWaterScene);
  const Run run = run_water(board, bytes_of(bytes), 1, {});
  BakedScene scene;
  REQUIRE(BakedScene::open(bytes_of(bytes), &scene) == Status::kOk);
  BakedLighting lighting;
  REQUIRE(BakedLighting::open(scene.section(SectionKind::kLighting), scene.tree().level(), &lighting) ==
          Status::kOk);
  Camera camera;
  REQUIRE(apps::view_at(apps::orbit_of(scene), scene.tree(), 0, {}, 96, 72, &camera) == Status::kOk);
  std::vector<std::uint8_t> pixels(band_bytes(board.format, 96, 72));
  const Band band{{pixels.data(), pixels.size()}, board.format, 0, 0, 72};
  REQUIRE(render_lit_band(lighting.effects, scene.tree(), camera, apps::demo_shading(scene.palette()),
                          lighting.scene, band) == Status::kOk);
  REQUIRE(run.pictures.size() == 1);
  CHECK(run.pictures[0].bytes == pixels);
}

TEST_CASE("water app: what it cannot show -> one sentence, status 1") {
  const auto source = tools::open_scene({.scene = "spheres,depth=4", .depth = std::nullopt});
  const tools::Baked dry = tools::bake_scene(*source, {});
  const platform::BoardFacts board = board_of("raspi0", 96, 72);
  const Run run = run_water(board, dry.scene.bytes(), 1, {});
  CHECK(run.status == 1);
  CHECK(run.out.find("error: the scene holds no water\n") != std::string::npos);
  platform::BoardFacts small = board;
  small.ram_bytes = small.stack_bytes + 12000;
  const Run short_of = run_water(small, bytes_of(baked("water")), 1, {});
  CHECK(short_of.status == 1);
  CHECK(short_of.out.find("error: the arena does not hold the water's columns\n") != std::string::npos);
}

TEST_CASE(
    "water app: a ball that falls -> darkens water and floor where it is not seen, and then nothing is as it "
    "was") {
  const platform::BoardFacts board = board_of("raspi0", 96, 72);
  Hand hand;
  hand.keys[1] = at_pixel('!', 48, 50);
  const Run run = run_water(board, bytes_of(baked(kWaterScene)), 6, hand);
  REQUIRE(run.pictures.size() == 6);
  // Frame 1 drops it: pixels turn red where it is seen, others dark, and there are reflections below.
  const std::vector<std::uint8_t>& before = run.pictures[0].bytes;
  const std::vector<std::uint8_t>& after = run.pictures[3].bytes;
  REQUIRE(board.format == PixelFormat::kRgb888);
  int red = 0;
  int dark = 0;
  for (std::size_t i = 0; i < before.size(); i += 3) {
    red += after[i] > before[i] + 20 && after[i] > after[i + 2] + 20 ? 1 : 0;
    dark +=
        after[i] + 10 < before[i] && after[i + 1] + 10 < before[i + 1] && after[i + 2] + 10 < before[i + 2]
            ? 1
            : 0;
  }
  CHECK(red > 8);
  CHECK(dark > 4);
}

TEST_CASE(
    "water app: a ball hides a mirror that shows water while the camera moves -> waves are drawn there, "
    "too") {
  // What looks into the mirror comes by no water before it. No column is blocked. So narrow and tall that the ball hides whole bands.
  testing::LitWorld world(4);
  world.surfaces[1] = testing::surface(SurfaceKind::kMetal, {255, 255, 255});
  world.box({0, 0, 0}, {16, 16, 1}, 0);
  world.box({0, 15, 1}, {16, 16, 16}, 1);
  world.box({0, 8, 1}, {16, 9, 2}, 0);
  world.box({0, 9, 1}, {1, 15, 2}, 0);
  world.box({15, 9, 1}, {16, 15, 2}, 0);
  world.finish();
  BakedLighting lighting;
  lighting.scene = world.scene;
  lighting.scene.has_water = true;
  lighting.scene.water = still_water({1, 9, 1}, 14, 6, 160);
  lighting.effects = Effect::kMirror | Effect::kWater | Effect::kDirectLight;
  std::vector<std::uint8_t> section(lighting_bytes(lighting.scene));
  REQUIRE(BakedLighting::make(lighting, 4, {section.data(), section.size()}) == Status::kOk);
  SceneCamera camera;
  camera.eye = testing::LitWorld::point({8 * 256 + 20, -3 * 256, 18 * 256});
  camera.target = testing::LitWorld::point({8 * 256 + 20, 12 * 256, 6 * 256});
  camera.fov_degrees = Q16::saturate(30);
  BakedParts parts;
  parts.tree = {world.tree.bytes(), world.tree.size_bytes()};
  parts.camera = &camera;
  parts.lighting = {section.data(), section.size()};
  std::vector<std::uint8_t> bytes(baked_bytes(parts));
  REQUIRE(BakedScene::make(parts, {bytes.data(), bytes.size()}, nullptr) == Status::kOk);

  const platform::BoardFacts board = board_of("raspi0", 2, 320);
  const std::uint32_t frames = 44;
  for (const int row : {240, 262}) {
    for (std::uint32_t moved = 4; moved < 20; moved += 3) {
      CAPTURE(row);
      CAPTURE(moved);
      Hand hand;
      hand.keys[1] = at_pixel('!', 1, row);
      hand.keys[moved] = "+";
      const Run some = run_water(board, bytes_of(bytes), frames, hand);
      hand.keys[0] = "o";
      const Run all = run_water(board, bytes_of(bytes), frames, hand);
      REQUIRE(some.pictures.size() == frames);
      REQUIRE(all.pictures.size() == frames);
      CHECK(some.counters[0].skipped > 0);
      CHECK(some.counters[0].splashes == 1);
      for (std::size_t i = 0; i < frames; ++i) {
        CAPTURE(i);
        CHECK(some.pictures[i].bytes == all.pictures[i].bytes);
      }
    }
  }
}
