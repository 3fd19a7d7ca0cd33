// The application `dig` on a simulated board: what keys and buttons do to the world, what it says without room,
// and that its pictures are those of the world built anew.
#include <doctest/doctest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "apps/apps.h"
#include "apps/demo_view.h"
#include "boards/board_table.h"
#include "port.h"
#include "scene/random.h"
#include "support/baked_demo.h"
#include "support/scene_under_test.h"
#include "support/simulated_run.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/base/memory.h"
#include "thimble/tree/edited_world.h"

namespace {

using namespace thimble;
using tests::board_of;
using tests::demo_scene;
using tests::flagship;
using tests::Hand;

tests::SimulatedRun run_dig(const platform::BoardFacts& board, std::uint32_t frames, const Hand& hand = {}) {
  const ConstBytes scene(demo_scene().bytes.data(), demo_scene().bytes.size());
  return tests::run_simulated({&board, true, scene, apps::dig}, frames, hand);
}

/// Each line's `voxels N`.
std::vector<long> voxels_told(const std::string& out) {
  std::vector<long> voxels;
  for (std::size_t at = out.find(": voxels "); at != std::string::npos; at = out.find(": voxels ", at + 1)) {
    voxels.push_back(std::atol(out.c_str() + at + 9));
  }
  return voxels;
}

constexpr long kBite = 19;

}  // namespace

TEST_CASE(
    "dig: untouched -> it shows two bites and a ball, and the picture is that of the world built anew") {
  const tests::SimulatedRun ran = run_dig(flagship(), 6);
  REQUIRE(ran.status == 0);
  CAPTURE(ran.out);
  const std::vector<long> voxels = voxels_told(ran.out);
  REQUIRE(voxels.size() == 3);
  BakedScene scene;
  REQUIRE(BakedScene::open({demo_scene().bytes.data(), demo_scene().bytes.size()}, &scene) == Status::kOk);
  CHECK(voxels[0] < static_cast<long>(scene.tree().voxel_count()));
  CHECK(voxels[1] < voxels[0]);
  CHECK(voxels[2] > voxels[1]);

  // The same balls by hand, then the tree as bytes, and its picture without a map.
  std::vector<std::uint8_t> room(1 << 20);
  EditedWorld world;
  REQUIRE(EditedWorld::make(scene.tree(), EditedWorld::room_in(scene.tree(), room.size()),
                            {room.data(), room.size()}, &world) == Status::kOk);
  int bite = 0;
  for (std::size_t at = ran.out.find(" at "); at != std::string::npos; at = ran.out.find(" at ", at + 1)) {
    Vec3i middle;
    if (std::sscanf(ran.out.c_str() + at, " at %d,%d,%d:", &middle.x, &middle.y, &middle.z) != 3) {
      continue;
    }
    Camera camera;
    REQUIRE(apps::view_at(apps::orbit_of(scene), world.tree(), 0, {}, 128, 64, &camera) == Status::kOk);
    Hit hit;
    REQUIRE(closest_hit(world.tree(), camera.ray(64, 32), &hit) == Status::kOk);
    // A bite is round what was hit, the ball round the voxel before the face.
    Vec3i aimed = hit.voxel;
    if (bite == 2) {
      aimed[hit.axis] += camera.ray(64, 32).direction[hit.axis] > 0 ? -1 : 1;
    }
    CHECK(middle == aimed);
    for (int near = 0; near < 27; ++near) {
      const Vec3i step{near % 3 - 1, near / 3 % 3 - 1, near / 9 - 1};
      const Vec3i voxel{middle.x + step.x, middle.y + step.y, middle.z + step.z};
      if (step.x * step.x + step.y * step.y + step.z * step.z <= 2) {
        REQUIRE((bite < 2 ? world.clear(voxel) : world.set(voxel, hit.material)) == Status::kOk);
      }
    }
    CHECK(static_cast<long>(world.tree().voxel_count()) == voxels[static_cast<std::size_t>(bite)]);
    ++bite;
  }
  const tests::HeapBytes bytes = tests::packed(world);
  REQUIRE(CompactTree::validate(bytes.view()) == nullptr);
  const CompactTree fresh = tests::open_or_throw(bytes);
  Camera camera;
  REQUIRE(apps::view_at(apps::orbit_of(scene), fresh, 0, {}, 128, 64, &camera) == Status::kOk);
  std::vector<std::uint8_t> picture(64 * 64);
  REQUIRE(render_band(fresh, camera, apps::demo_shading(scene.palette()),
                      Band{{picture.data(), picture.size()}, PixelFormat::kGray4, 0, 0, 64}) == Status::kOk);
  int differ = 0;
  for (std::size_t i = 0; i < picture.size(); ++i) {
    differ += picture[i] != ran.last.bytes[i] ? 1 : 0;
  }
  CHECK(differ > 0);  // the cross: twelve pixels, six of them in bytes of two
  CHECK(differ <= 12);
}

TEST_CASE("dig: keys and buttons -> each press one bite, down and select a ball, arrows another view") {
  const tests::SimulatedRun keys = run_dig(flagship(), 3, {{{1, "ddu"}}, {}});
  const std::vector<long> by_keys = voxels_told(keys.out);
  REQUIRE(by_keys.size() == 3);
  CHECK(by_keys[1] < by_keys[0]);
  CHECK(by_keys[2] > by_keys[1]);
  CHECK(by_keys[2] - by_keys[1] <= kBite);
  const tests::SimulatedRun buttons = run_dig(flagship(), 9,
                                              {{},
                                               {{1, port::kSelect},
                                                {3, 0},
                                                {4, port::kSelect},
                                                {6, 0},
                                                {7, port::kDown},
                                                {8, port::kDown | port::kSelect}}});
  const std::vector<long> by_buttons = voxels_told(buttons.out);
  REQUIRE(by_buttons.size() == 3);
  CHECK(by_buttons[0] == by_keys[0]);
  CHECK(by_buttons[1] == by_keys[1]);
  CHECK(by_buttons[2] > by_buttons[1]);
  const tests::SimulatedRun turned = run_dig(flagship(), 3, {{}, {{1, port::kLeft}}});
  CHECK(voxels_told(turned.out).empty());
  CHECK(turned.pictures[0].bytes != turned.last.bytes);
  CHECK(run_dig(flagship(), 5, {{{1, "q"}}, {}}).status == 0);
}

TEST_CASE("dig: without room -> it says so and runs; boards that cannot hold the scene say why") {
  const std::string many = "uuuuuuuduuuuuuud";
  Hand hand;
  for (std::uint32_t frame = 1; frame < 60; ++frame) {
    hand.keys[frame] = many;
    hand.buttons[frame] = frame % 2 == 0 ? port::kLeft : port::kRight | port::kUp;
  }
  BakedScene scene;
  REQUIRE(BakedScene::open({demo_scene().bytes.data(), demo_scene().bytes.size()}, &scene) == Status::kOk);
  // A chip with room for the application, a band and a few bricks that are opened.
  platform::BoardFacts tight = flagship();
  const EditRoom least = EditedWorld::room_of(scene.tree());
  tight.ram_bytes =
      tight.stack_bytes + static_cast<std::uint32_t>(edited_world_bytes(scene.tree().level(), least)) + 1900;
  const tests::SimulatedRun full = run_dig(tight, 60, hand);
  CHECK(full.status == 0);
  CHECK(full.fault.empty());
  CAPTURE(full.out);
  CHECK(full.out.find("no room for all of it") != std::string::npos);
  const tests::SimulatedRun small = run_dig(board_of("microbit"), 3);
  CHECK(small.status == 1);
  CHECK(small.out.find("error: the arena does not hold the scene") != std::string::npos);
}
