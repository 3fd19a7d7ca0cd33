#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "apps/apps.h"
#include "apps/demo_view.h"
#include "apps/scene_light.h"
#include "boards/board_table.h"
#include "scene/baking.h"
#include "scene/random.h"
#include "support/baked_demo.h"
#include "support/counts.h"
#include "support/scene_under_test.h"
#include "support/simulated_run.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"

namespace {

using namespace thimble;
using tests::bake_demo;
using tests::demo_scene;

const int kWandering = thimble::tests::many_or_few(2000, 200);

const tools::Baked& lit_scene() {
  static const tools::Baked baked = bake_demo(Effect::kDirectLight | Effect::kShadows);
  return baked;
}

ConstBytes bytes_of(std::span<const std::uint8_t> bytes) {
  return {bytes.data(), bytes.size()};
}

/// Looks for the solid at the eye with the reference's definition: the voxel that holds the point.
bool eye_in_solid(const CompactTree& tree, const Vec3Q8& eye) {
  // A ray straight down that starts in a solid voxel hits with axis -1.
  Hit hit;
  REQUIRE(closest_hit(tree, {eye, {0, 0, -1}}, &hit) == Status::kOk);
  return hit.kind == HitKind::kHit && hit.axis < 0;
}

using Run = tests::SimulatedRun;

/// Runs the demonstration for that many frames; `keys` come over the UART before the frame they stand for.
Run run_demo(const platform::BoardFacts& board, ConstBytes scene, std::uint32_t frames,
             const std::map<std::uint32_t, std::string>& keys = {}, bool connected = false,
             std::uint32_t hold_fps = 0) {
  return tests::run_simulated({&board, connected, scene, apps::demo, hold_fps}, frames, {keys, {}});
}

/// The number behind every `word` at the start of a line: `frame N crc X` -> X by N.
std::map<std::uint32_t, std::uint32_t> crcs_of(const std::string& out, const std::string& word) {
  std::map<std::uint32_t, std::uint32_t> result;
  for (std::size_t from = 0; (from = out.find("\n" + word + " ", from)) != std::string::npos; ++from) {
    unsigned frame = 0;
    unsigned crc = 0;
    if (std::sscanf(out.c_str() + from + 1 + word.size(), " %u crc %x", &frame, &crc) == 2) {
      result[frame] = crc;
    }
  }
  return result;
}

/// Frames with light.
std::size_t lit_frames(const std::string& out) {
  std::size_t count = 0;
  for (std::size_t at = 0; (at = out.find(" lit", at)) != std::string::npos; ++at) {
    ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("demo view: a baked camera -> the round begins at its eye and keeps its target and distance") {
  const BakedScene& scene = demo_scene().scene;
  REQUIRE(scene.has_camera());
  const Vec3Q8& eye = scene.camera().eye;
  const Vec3Q8& target = scene.camera().target;
  const apps::Orbit orbit = apps::orbit_of(scene);
  for (const std::uint32_t frame : {0U, 128U, 31U, 100U}) {
    CAPTURE(frame);
    Camera camera;
    REQUIRE(apps::view_at(orbit, scene.tree(), frame, {}, 128, 64, &camera) == Status::kOk);
    double distance = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (frame % 128 == 0) {
        CHECK(std::abs(camera.eye()[axis].raw - eye[axis].raw) <= 2);
      }
      distance += std::pow(camera.eye()[axis].raw - target[axis].raw, 2);
    }
    CHECK(std::abs(std::sqrt(distance) - orbit.distance_q8) < 4);
  }
}

TEST_CASE(
    "demo light: effects that are fast by the map -> turns lit, also with a hand on the buttons; t and l") {
  const platform::BoardFacts& board = *platform::find_board("lm3s6965evb");
  const ConstBytes scene = bytes_of(lit_scene().bytes);
  const Run turning = run_demo(board, scene, 8 * apps::kGoldenStep);
  CHECK(turning.status == 0);
  CHECK(turning.fault == "");
  const auto crcs = crcs_of(turning.out, "frame");
  REQUIRE(crcs.size() == 8 * apps::kGoldenStep);
  CHECK(lit_frames(turning.out) == crcs.size());
  for (std::uint32_t i = 0; i < apps::kGoldenFrames; ++i) {
    CHECK(crcs.at(i * apps::kGoldenStep) == golden::kDemoLitFrameCrc32[i]);
  }
  // Frames 0 to 9 turn; one is drawn where it stops; 11 to 19 are not drawn. Ten without light stand as well.
  const Run stopping = run_demo(board, scene, 40, {{10, "t"}, {20, "l"}, {30, "lt"}});
  const auto stopped = crcs_of(stopping.out, "frame");
  REQUIRE(stopped.size() == 11 + 10 + 10);
  CHECK(lit_frames(stopping.out) == 11 + 10);
  CHECK(stopped.at(10) == crcs.at(10));
  CHECK(stopped.at(11) == stopped.at(20));
  CHECK(stopped.at(11) != stopped.at(10));
  CHECK(stopped.at(21) == stopped.at(10));  // lit again
  CHECK(stopped.at(22) == crcs.at(11));
  const Run steered = tests::run_simulated({&board, false, scene, apps::demo}, 6, {{}, {{0, port::kRight}}});
  CHECK(lit_frames(steered.out) == 6);
  // A rate that is held leaves no time for light until it stands.
  const Run held = run_demo(board, scene, 9, {{6, "t"}}, false, 30);
  const auto holding = crcs_of(held.out, "frame");
  REQUIRE(holding.size() == 8);
  CHECK(lit_frames(held.out) == 1);
  CHECK(holding.at(7) == crcs.at(6));
}

TEST_CASE("demo light: edges -> it turns in light without them, and has them when it stands still") {
  const platform::BoardFacts& board = *platform::find_board("lm3s6965evb");
  const tools::Baked baked = bake_demo(Effect::kDirectLight | Effect::kShadows | Effect::kEdges);
  const Run run = run_demo(board, baked.scene.bytes(), 30, {{18, "t"}});
  CHECK(run.fault == "");
  const auto crcs = crcs_of(run.out, "frame");
  // 18 that turn, one where it stops, one with edges at the same place.
  REQUIRE(crcs.size() == 20);
  CHECK(lit_frames(run.out) == 20);
  CHECK(crcs.at(19) != crcs.at(18));
  apps::SceneLight light;
  REQUIRE(apps::open_light(baked.scene, &light) == nullptr);
  Camera camera;
  REQUIRE(apps::view_at(apps::orbit_of(baked.scene), baked.scene.tree(), 18, {}, 128, 64, &camera) ==
          Status::kOk);
  Shading shading = apps::demo_shading(baked.scene.palette());
  shading.background =
      apps::is_dark_behind(light.effects(), PixelFormat::kGray4) ? Rgb8{0, 0, 0} : shading.background;
  std::vector<std::uint8_t> picture(64 * 64);
  const Band band{Bytes(picture.data(), picture.size()), PixelFormat::kGray4, 0, 0, 64};
  REQUIRE(apps::draw_lit(baked.scene, camera, shading, light, band) == Status::kOk);
  CHECK(crcs.at(19) == crc32(bytes_of(picture)));
  REQUIRE(render_lit_band(Effect::kDirectLight | Effect::kShadows, baked.scene.tree(), camera, shading,
                          light.baked.scene, band) == Status::kOk);
  CHECK(crcs.at(18) == crc32(bytes_of(picture)));
}

TEST_CASE("demo light: effects that are slow -> a lit frame at first, and none until it moves") {
  const platform::BoardFacts& board = *platform::find_board("lm3s6965evb");
  const tools::Baked baked = bake_demo(Effect::kDirectLight | Effect::kAmbientOcclusion);
  const ConstBytes scene = baked.scene.bytes();
  const auto crc = [](const host::PackedPicture& picture) { return crc32(bytes_of(picture.bytes)); };
  const Run run = run_demo(board, scene, 40, {{10, "t"}, {11, "t"}, {20, "l"}, {30, "l"}});
  CHECK(run.status == 0);
  CHECK(run.fault == "");
  REQUIRE(run.pictures.size() == 40);
  for (std::size_t i = 1; i < 10; ++i) {
    CHECK(crc(run.pictures[i]) == crc(run.pictures[0]));
  }
  // Drawn: the lit one, one at the same place as it begins to turn, one as it stops, a lit one there, ten
  // without light, turning, one without and one with light as it stands still again.
  const auto crcs = crcs_of(run.out, "frame");
  REQUIRE(crcs.size() == 16);
  CHECK(crcs.at(0) != crcs.at(1));
  CHECK(crcs.at(1) == golden::kDemoFrameCrc32[0]);
  CHECK(crcs.at(2) != crcs.at(1));
  CHECK(lit_frames(run.out) == 3);
  // A scene without effects has no light to switch on.
  const Run plain = run_demo(board, bytes_of(demo_scene().bytes), 3, {{1, "l"}});
  CHECK(plain.out.find("the scene was baked for no effects") != std::string::npos);
  CHECK(crcs_of(plain.out, "frame").size() == 3);
}

TEST_CASE("demo view: any buttons for any time -> a camera, and never one in something solid") {
  const BakedScene& scene = demo_scene().scene;
  for (const apps::Orbit& orbit : {apps::orbit_of(scene), apps::orbit_of(scene.tree().bounds())}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      CAPTURE(seed);
      tools::SplitMix64 random(seed);
      apps::Steering steering;
      std::uint32_t held = 0;
      for (int frame = 0; frame < kWandering; ++frame) {
        CAPTURE(frame);
        if (random.below(12) == 0) {
          held = random.below(32);
        }
        apps::steer(held, &steering);
        Camera camera;
        REQUIRE(apps::view_at(orbit, scene.tree(), static_cast<std::uint32_t>(frame), steering, 128, 64,
                              &camera) == Status::kOk);
        REQUIRE_FALSE(eye_in_solid(scene.tree(), camera.eye()));
      }
    }
  }
}

TEST_CASE("demo view: each button -> turns, tilts or comes nearer, within limits") {
  apps::Steering steering;
  apps::steer(port::kRight, &steering);
  CHECK(steering.yaw == apps::kTurn / 64);
  apps::steer(port::kLeft | port::kRight, &steering);
  CHECK(steering.yaw == apps::kTurn / 64);
  apps::steer(port::kUp, &steering);
  CHECK(steering.pitch == apps::kTurn / 128);
  CHECK(steering.zoom == 0);
  for (int i = 0; i < 100; ++i) {
    apps::steer(port::kUp | port::kSelect, &steering);
  }
  CHECK(steering.zoom == apps::kNearest);
  CHECK(steering.pitch == apps::kTurn / 128);
  for (int i = 0; i < 1000; ++i) {
    apps::steer(port::kDown, &steering);
    apps::steer(port::kLeft, &steering);
  }
  CHECK(steering.pitch == -apps::kTurn / 4);
  CHECK((steering.yaw >= 0 && steering.yaw < apps::kTurn));
}

TEST_CASE(
    "demo view: a scene without a camera, an empty one, a single voxel -> a round of different pictures") {
  for (const VoxelBox& box : {VoxelBox{{0, 0, 0}, {0, 0, 0}}, VoxelBox{{9, 9, 9}, {10, 10, 10}}}) {
    tests::OwnedPool pool(5, 100);
    Octree& tree = pool.octree;
    if (!box.empty()) {
      REQUIRE(tree.insert(box.low, 1) == Status::kOk);
    }
    for (std::uint32_t frame = 0; frame < 4; ++frame) {
      Camera camera;
      REQUIRE(apps::view_at(apps::orbit_of(box), tree, frame, {}, 128, 64, &camera) == Status::kOk);
      Hit hit;
      REQUIRE(closest_hit(tree, camera.ray(64, 32), &hit) == Status::kOk);
      CHECK((hit.kind == HitKind::kHit) == !box.empty());
    }
  }
}

TEST_CASE("demo: on every board -> draws within its RAM, the golden frames where the display is 128 x 64") {
  for (const platform::BoardFacts& board : platform::boards()) {
    CAPTURE(std::string(board.name));
    const bool golden_display = board.width_px == 128 && board.format == PixelFormat::kGray4;
    const bool few = thimble::tests::takes_few();
    const std::uint32_t frames = golden_display ? (few ? 18 : 120) : (few ? 1 : 2);
    const Run run = run_demo(board, bytes_of(demo_scene().bytes), frames);
    CHECK(run.status == 0);
    CHECK(run.fault == "");
    CHECK(run.out.find("scene demo: depth 6 voxels ") != std::string::npos);
    CHECK(run.pictures.size() == frames);
    auto crcs = crcs_of(run.out, "frame");
    CHECK(crcs.size() == frames);
    for (std::uint32_t i = 0; golden_display && i * apps::kGoldenStep < frames; ++i) {
      CHECK(crcs[i * apps::kGoldenStep] == golden::kDemoFrameCrc32[i]);
    }
  }
}

TEST_CASE("demo: p over the UART -> the picture on the display, in its colours; q -> the end, status 0") {
  // 16 greys; red in the highest bits; blue there.
  for (const char* name : {"lm3s6965evb", "mps2-an500", "gba"}) {
    CAPTURE(std::string(name));
    const platform::BoardFacts& board = *platform::find_board(name);
    const Run run = run_demo(board, bytes_of(demo_scene().bytes), 100, {{0, "p"}, {2, "p"}, {3, "xq"}}, true);
    CHECK(run.status == 0);
    CHECK(run.pictures.size() == 3);
    CHECK(crcs_of(run.out, "frame").empty());
    const bool is_gray = board.format == PixelFormat::kGray4;
    const std::string header = (is_gray ? "P5\n" : "P6\n") + std::to_string(board.width_px) + " " +
                               std::to_string(board.height_px) + "\n255\n";
    const std::size_t start = run.out.find(header);
    REQUIRE(start != std::string::npos);
    REQUIRE(run.out.find(header, start + 1) == std::string::npos);
    const auto count = static_cast<std::size_t>(board.width_px) * static_cast<std::size_t>(board.height_px);
    const auto& shown = run.pictures[1].bytes;
    std::string right;
    for (std::size_t i = 0; i < count; ++i) {
      if (is_gray) {
        const int nibble = shown[i / 2] >> (i % 2 == 0 ? 4 : 0) & 15;
        right += static_cast<char>(nibble * 17);
        continue;
      }
      const int pixel = shown[2 * i] | shown[2 * i + 1] << 8;
      const int high = pixel >> 11;
      const int green = pixel >> 5 & 63;
      const int low = pixel & 31;
      const bool swaps = board.format == PixelFormat::kBgr565;
      for (const int five : {swaps ? low : high, -1, swaps ? high : low}) {
        right += static_cast<char>(five < 0 ? green << 2 | green >> 4 : five << 3 | five >> 2);
      }
    }
    CHECK(run.out.compare(start + header.size(), right.size(), right) == 0);
  }
}

TEST_CASE("demo: no scene, a damaged one, another kind of bytes -> a message, a cross, status 1") {
  const platform::BoardFacts& board = *platform::find_board("lm3s6965evb");
  std::vector<std::uint8_t> damaged(demo_scene().bytes.begin(), demo_scene().bytes.end());
  damaged[damaged.size() / 2] ^= 0x10;
  std::vector<std::uint8_t> cut(damaged.begin(), damaged.begin() + 300);
  struct Case {
    std::vector<std::uint8_t> bytes;
    const char* message;
  };
  for (const Case& bad : {Case{{}, "no scene"}, Case{damaged, "damaged"}, Case{cut, "damaged"},
                          Case{std::vector<std::uint8_t>(1000, 0xFF), "damaged"}}) {
    const Run run = run_demo(board, bytes_of(bad.bytes), 5);
    CHECK(run.status == 1);
    CHECK(run.out.find("error: ") != std::string::npos);
    CHECK(run.out.find(bad.message) != std::string::npos);
    CHECK(run.pictures.empty());
    REQUIRE(run.last.bytes.size() == 64 * 64);
    CHECK(run.last.bytes.front() == 0xF0);
    CHECK(run.last.bytes[63] == 0x0F);
    CHECK(run.last.bytes.back() == 0x0F);
    CHECK(std::count(run.last.bytes.begin(), run.last.bytes.end(), 0) > 3900);
  }
}

TEST_CASE(
    "demo: b over the UART -> spheres until the pool is full, then it coarsens; s -> the baked scene again") {
  const platform::BoardFacts& board = *platform::find_board("stm32vldiscovery");
  const auto building = [&] {
    return run_demo(board, bytes_of(demo_scene().bytes), 24, {{2, "b"}, {20, "s"}});
  };
  const Run run = building();
  CHECK(run.status == 0);
  CHECK(run.fault == "");
  CHECK(run.out.find("building in a pool of ") != std::string::npos);
  const std::size_t full = run.out.find("pool full: voxels ");
  REQUIRE(full != std::string::npos);
  // It added solid afterwards.
  unsigned voxels_full = 0;
  REQUIRE(std::sscanf(run.out.c_str() + full, "pool full: voxels %u", &voxels_full) == 1);
  unsigned frame = 0;
  unsigned crc = 0;
  unsigned voxels = 0;
  unsigned nodes = 0;
  unsigned added = 0;
  REQUIRE(std::sscanf(run.out.c_str() + run.out.rfind("\nbuild "),
                      " build %u crc %x voxels %u nodes %u added %u", &frame, &crc, &voxels, &nodes,
                      &added) == 5);
  CHECK(frame == 17);
  CHECK(voxels > voxels_full);
  CHECK(added > 0);
  CHECK(voxels < 64 * 64 * 64);
  // The baked scene begins anew, and all of it is the same the next time.
  auto frames = crcs_of(run.out.substr(run.out.rfind("\nbuild ")), "frame");
  CHECK(frames.size() == 4);
  CHECK(frames[0] == golden::kDemoFrameCrc32[0]);
  CHECK(building().out == run.out);
}

TEST_CASE("demo: rates that are held -> squares as small as the rate leaves time for") {
  const tools::Baked baked = bake_demo(Effect::kNone, true);
  std::set<int> steps;
  for (const char* name : {"gba", "lm3s6965evb", "pico", "pico-lcd-2", "raspi0"}) {
    const platform::BoardFacts& board = *platform::find_board(name);
    const auto width = static_cast<std::size_t>(board.width_px);
    const Run exact = run_demo(board, baked.scene.bytes(), 2, {}, true);
    REQUIRE(exact.pictures.size() == 2);
    int before = 1;
    for (const std::uint32_t fps : {1U, 2U, 4U, 10U, 30U, 45U, 60U, 120U}) {
      const Run held = run_demo(board, baked.scene.bytes(), 2, {}, true, fps);
      REQUIRE(held.pictures.size() == 2);
      const std::size_t told = held.out.find("a pixel of ");
      REQUIRE(told != std::string::npos);
      const int step = std::stoi(held.out.substr(told + 11));
      CAPTURE(name);
      CAPTURE(fps);
      CAPTURE(step);
      CHECK(step >= before);
      CHECK(step <= 8);
      before = step;
      steps.insert(step);
      const auto every = static_cast<std::size_t>(step);
      for (std::size_t frame = 0; frame < 2; ++frame) {
        const std::vector<std::uint8_t> shown = tests::pixels_of(held.pictures[frame]);
        const std::vector<std::uint8_t> wanted = tests::pixels_of(exact.pictures[frame]);
        REQUIRE(shown.size() == 3 * width * static_cast<std::size_t>(board.height_px));
        unsigned others = 0;
        for (std::size_t at = 0; at < shown.size(); ++at) {
          const std::size_t x = at / 3 % width;
          const std::size_t y = at / 3 / width;
          const std::size_t corner = (y - y % every) * width + x - x % every;
          others += shown[at] != wanted[corner * 3 + at % 3] ? 1U : 0U;
        }
        CHECK(others == 0);
      }
    }
  }
  CHECK(steps.size() >= 7);
}

TEST_CASE("demo: a rate is held with a tree alone -> refined by what there is time for, exact in the end") {
  const platform::BoardFacts& board = *platform::find_board("lm3s6965evb");
  const ConstBytes scene = bytes_of(demo_scene().bytes);
  const Run exact = run_demo(board, scene, 2);
  // Too small for a map in RAM beside it, so that rays go through the tree.
  platform::BoardFacts small = board;
  small.ram_bytes = 16384;
  const Run run = run_demo(small, scene, 90, {{1, "ht"}});
  CHECK(run.fault.empty());
  CHECK(run.out.find(" map 0 ") != std::string::npos);
  std::uint32_t before = 128 * 64;
  int frames = 0;
  for (std::size_t at = 0; (at = run.out.find(" inexact ", at)) != std::string::npos; ++at) {
    const auto inexact = static_cast<std::uint32_t>(std::stoul(run.out.substr(at + 9)));
    CHECK((inexact < before || inexact == 0));
    before = inexact;
    ++frames;
  }
  CHECK(frames == 89);
  CHECK(before == 0);
  CHECK(run.last.bytes == exact.pictures[1].bytes);
}

TEST_CASE(
    "demo: the scene built on the board while a rate is held -> the picture of the pool, exact at rest") {
  const platform::BoardFacts& board = *platform::find_board("lm3s6965evb");
  const ConstBytes scene = bytes_of(demo_scene().bytes);
  // The same pool: what holding takes is taken before it is begun in both.
  const std::uint32_t frames = 260;
  const Run held = run_demo(board, scene, frames, {{0, "hb"}, {200, "t"}});
  const Run exact = run_demo(board, scene, frames, {{0, "hbh"}, {200, "t"}});
  CHECK(held.fault.empty());
  const std::size_t last = held.out.rfind("build ");
  REQUIRE(last != std::string::npos);
  CHECK(held.out.find(" done inexact 0", last) != std::string::npos);
  CHECK(held.last.bytes == exact.last.bytes);
}

TEST_CASE("demo: a board that holds no rate, or has no room for a frame -> it says so and runs") {
  const ConstBytes scene = bytes_of(demo_scene().bytes);
  const Run none = run_demo(*platform::find_board("stm32vldiscovery"), scene, 2, {{0, "h"}});
  CHECK(none.status == 0);
  CHECK(none.out.find("this board holds no rate of frames") != std::string::npos);
  platform::BoardFacts small = *platform::find_board("lm3s6965evb");
  small.ram_bytes = 8192;
  const Run full = run_demo(small, scene, 2, {{0, "h"}});
  CHECK(full.status == 0);
  CHECK(full.out.find("no room for a whole frame") != std::string::npos);
  CHECK(full.last.bytes == none.last.bytes);
}
