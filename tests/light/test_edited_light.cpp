// Worlds that are edited while they are drawn in the sun: pictures by the map, with what is proven of the sun, are those
// of a tree built anew, whatever was edited since, and however little of it was proven again.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "support/counts.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/light/map_render.h"
#include "thimble/tree/edited_world.h"

namespace thimble::tests::edited_light {
namespace {

constexpr EffectSet kSun = Effect::kDirectLight | Effect::kShadows;

const int kSunnyWorlds = many_or_few(60, 12);

/// A world in bytes of its own, with room, and its sun.
struct SunnyWorld {
  SunnyWorld(const CompactTree& tree, const Vec3i& towards)
      : bytes(EditedWorld::least_bytes(tree) + (std::size_t{1} << 20)),
        proven(0),
        journal_bytes(std::size_t{1} << 18) {
    REQUIRE(EditedWorld::make(tree, EditedWorld::room_in(tree, bytes.view().size), bytes.span(), &world) ==
            Status::kOk);
    light.place = towards;
    proven = HeapBytes(SunBricks::bytes(world.map()));
    REQUIRE(SunBricks::make(world.map(), towards, proven.span(), &sun) == Status::kOk);
    sun.prove();
    journal = EditJournal(journal_bytes.span());
  }

  std::vector<std::uint8_t> draw(const CompactTree& tree, const BrickMap* map, const Camera& camera) const {
    LitScene scene;
    scene.lights = {&light, 1};
    scene.has_shadows = true;
    std::vector<std::uint8_t> rgb(band_bytes(PixelFormat::kRgb888, camera.width_px(), camera.height_px()));
    const Band band{{rgb.data(), rgb.size()}, PixelFormat::kRgb888, 0, 0, camera.height_px()};
    REQUIRE((map == nullptr ? render_lit_band<kSun>(tree, camera, Shading(), scene, band)
                            : render_lit_band<kSun>(tree, *map, camera, Shading(), scene, {&sun, 1}, band)) ==
            Status::kOk);
    return rgb;
  }
  /// By the map and what is proven; by the tree alone, its bytes made anew.
  void compare(const Camera& camera) const {
    const HeapBytes fresh = packed(world);
    REQUIRE(draw(world.tree(), &world.map(), camera) == draw(open_or_throw(fresh), nullptr, camera));
  }

  HeapBytes bytes;
  HeapBytes proven;
  HeapBytes journal_bytes;
  EditedWorld world;
  EditJournal journal;
  Light light;
  SunBricks sun;
};

/// One voxel, a box, a ball, or one of these taken back; mostly near a place.
void edit_at_random(std::mt19937_64& random, const Vec3i& near, SunnyWorld* sunny) {
  EditedWorld& world = sunny->world;
  const int last = (1 << world.level()) - 1;
  VoxelBox box;
  const int most = pick_int(random, 1, 3) == 1 ? 12 : 3;
  const bool anywhere = last < 64 || pick_int(random, 0, 9) == 0;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] =
        anywhere ? pick_int(random, 0, last) : std::clamp(near[axis] + pick_int(random, -32, 32), 0, last);
    box.high[axis] = box.low[axis] + pick_int(random, 1, most);
  }
  const int material = pick_int(random, 0, 2) - 1;
  switch (pick_int(random, 0, 4)) {
    case 0:
      (void)world.set(box.low, 1);
      break;
    case 1:
      (void)world.clear(box.low);
      break;
    case 2:
      (void)world.undo(&sunny->journal);
      break;
    default:
      (void)world.edit(box, pick_int(random, 0, 1) == 0 ? EditShape::kBox : EditShape::kBall, material,
                       &sunny->journal);
  }
}

TEST_CASE(
    "edited light: a roof put up, with and without following -> its shadow, as a tree built anew has it") {
  for (const int turn : {0, 1, 2, 3}) {
    CAPTURE(turn);
    const bool follows = turn % 2 == 1;
    const int level = turn < 2 ? 5 : 9;
    OwnedPool pool(level);
    REQUIRE(pool.octree.insert_box({{0, 0, 0}, {32, 32, 2}}, 1) == Status::kOk);
    const HeapBytes tree = compact_of(pool.octree);
    SunnyWorld sunny(open_or_throw(tree), {-3, 2, 9});
    Camera camera;
    REQUIRE(camera.set(PerspectiveView{{Q8::from_raw(-2000), Q8::from_raw(-2500), Q8::from_raw(6000)},
                                       {6100, 6600, -5500},
                                       {},
                                       Q16::saturate(60),
                                       64,
                                       48,
                                       0},
                       level) == Status::kOk);
    REQUIRE(sunny.sun.belongs_to(sunny.world.map(), sunny.light.place));
    const auto open = sunny.draw(sunny.world.tree(), &sunny.world.map(), camera);
    REQUIRE(sunny.world.edit({{10, 10, 16}, {22, 22, 18}}, EditShape::kBox, 1, &sunny.journal) ==
            Status::kOk);
    if (follows) {
      CHECK(sunny.sun.follow(sunny.world, 1));
      sunny.world.forget_changes();
    }
    CHECK(sunny.sun.belongs_to(sunny.world.map(), sunny.light.place) == follows);
    CHECK(sunny.draw(sunny.world.tree(), &sunny.world.map(), camera) != open);
    sunny.compare(camera);
  }
}

/// A camera that makes ties, or one that looks at a place from near by.
Camera camera_for(std::mt19937_64& random, const Vec3i& near, int level) {
  const Camera hard = hard_chip_camera(random, level);
  PerspectiveView view;
  for (int axis = 0; axis < 3; ++axis) {
    view.forward[axis] = pick_int(random, -1000, 1000);
    view.eye[axis] = Q8::from_raw(near[axis] * 256 - view.forward[axis] * pick_int(random, 4, 20));
  }
  view.fov_degrees = Q16::saturate(pick_int(random, 20, 90));
  view.width_px = 160;
  view.height_px = 90;
  Camera camera;
  return pick_int(random, 0, 2) == 0 || camera.set(view, level) != Status::kOk ? hard : camera;
}

TEST_CASE(
    "edited light: random edits, followed now and then -> the pictures of trees built anew, all proven in "
    "the end") {
  std::mt19937_64 random(seed_or(4040));
  int drawn = 0;
  for (int trial = 0; trial < kSunnyWorlds; ++trial) {
    CAPTURE(trial);
    const bool is_deep = trial % 3 == 2;
    const ChipWorld kind =
        is_deep ? ChipWorld::kBlocks : kChipWorlds[std::size_t{0} + static_cast<std::size_t>(trial % 4)];
    const int level = is_deep ? pick_int(random, 9, 10) : pick_int(random, 3, 6);
    const int last = (1 << level) - 1;
    const Vec3i near{pick_int(random, 0, last), pick_int(random, 0, last), pick_int(random, 0, last)};
    Vec3i towards{pick_int(random, -9, 9), pick_int(random, -9, 9),
                  pick_int(random, 0, 1) * pick_int(random, -9, 9)};
    towards.z += towards == Vec3i{} ? 1 : 0;
    SunnyWorld sunny(make_chip_scene(random, kind, level).tree, towards);
    for (int edit = 0; edit < 40; ++edit) {
      CAPTURE(edit);
      edit_at_random(random, near, &sunny);
      const int way = pick_int(random, 0, 9);
      if (way == 0) {
        sunny.world.forget_changes();  // before they were followed: nothing is known then
      } else if (way < 8) {
        (void)sunny.sun.follow(sunny.world, static_cast<std::uint32_t>(pick_int(random, 0, 200)));
        if (way < 6) {
          sunny.world.forget_changes();
        }
      }
      if (edit % 4 == 3) {
        sunny.compare(camera_for(random, near, level));
        ++drawn;
      }
    }
    while (sunny.sun.follow(sunny.world, is_deep ? 20000 : 100)) {
    }
    HeapBytes anew(sunny.proven.view().size);
    SunBricks fresh;
    REQUIRE(SunBricks::make(sunny.world.map(), towards, anew.span(), &fresh) == Status::kOk);
    fresh.prove();
    REQUIRE(std::equal(anew.view().begin(), anew.view().end(), sunny.proven.view().begin()));
  }
  CHECK(drawn >= 100);
}

}  // namespace
}  // namespace thimble::tests::edited_light
