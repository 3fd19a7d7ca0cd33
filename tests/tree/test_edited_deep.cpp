// Worlds of level 9 and 10 that are edited: the same bytes when packed as a pool that was edited alike, the same pictures
// by the map, and room that comes back.
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
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"
#include "thimble/tree/edited_world.h"
#include "wide/raster/voxel_lists.h"
#include "wide/rays/ray_map.h"

namespace thimble::tests::edited_deep {
namespace {

const int kDeepEdits = many_or_few(6000, 800);

/// A pool and a world of the same voxels.
struct DeepPair {
  explicit DeepPair(int level, const EditRoom& more)
      : pool(level, 300000), bytes(0), journal_bytes(std::size_t{1} << 20) {
    // A hill of three materials across pages, and blocks of every size.
    for (int i = 0; i < 3; ++i) {
      insert({{200 + 16 * i, 200, 100}, {250 + 16 * i, 260, 140}}, i);
    }
    insert({{0, 0, 0}, {64, 64, 64}}, 4);
    insert({{256, 256, 256}, {384, 384, 320}}, 1);
    insert({{490, 490, 490}, {512, 512, 512}}, 2);
    const HeapBytes tree = compact_of(pool.octree);
    room = EditedWorld::room_of(open_or_throw(tree));
    room = {room.nodes + more.nodes, 0, room.bricks + more.bricks, room.pages + more.pages};
    bytes = HeapBytes(edited_world_bytes(level, room));
    REQUIRE(EditedWorld::make(open_or_throw(tree), room, bytes.span(), &world) == Status::kOk);
    REQUIRE(packed(world) == tree);
    journal = EditJournal(journal_bytes.span());
  }
  void insert(const VoxelBox& box, int material) {
    REQUIRE(pool.octree.insert_box(box, static_cast<std::uint8_t>(material)) == Status::kOk);
  }
  void put(const Vec3i& voxel, int material) {
    REQUIRE((material < 0 ? pool.octree.remove(voxel)
                          : pool.octree.insert(voxel, static_cast<std::uint8_t>(material))) == Status::kOk);
  }

  OwnedPool pool;
  HeapBytes bytes;
  HeapBytes journal_bytes;
  EditRoom room;
  EditedWorld world;
  EditJournal journal;
};

/// Pictures of the world: by its tree, and by its map, as colours of the materials, against those of a tree built anew.
void compare_pictures(std::mt19937_64& random, const EditedWorld& world) {
  const HeapBytes fresh = packed(world);
  REQUIRE(CompactTree::validate(fresh.view()) == nullptr);
  const CompactTree tree = open_or_throw(fresh);
  std::vector<Rgb8> palette(256);
  for (unsigned i = 0; i < 256; ++i) {
    palette[i] = {static_cast<std::uint8_t>(37 * i), static_cast<std::uint8_t>(255 - i),
                  static_cast<std::uint8_t>(90 * i)};
  }
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = {palette.data(), palette.size()};
  const Camera camera = hard_chip_camera(random, world.level());
  std::vector<std::uint8_t> pictures[6];
  for (std::vector<std::uint8_t>& rgb : pictures) {
    rgb.resize(band_bytes(PixelFormat::kRgb888, camera.width_px(), camera.height_px()));
  }
  const auto band = [&](int which) {
    return Band{
        {pictures[which].data(), pictures[which].size()}, PixelFormat::kRgb888, 0, 0, camera.height_px()};
  };
  REQUIRE(render_band(tree, camera, shading, band(0)) == Status::kOk);
  REQUIRE(render_band(world.tree(), camera, shading, band(1)) == Status::kOk);
  REQUIRE(render_band(world.tree(), world.map(), camera, shading, band(2)) == Status::kOk);
  REQUIRE(pictures[1] == pictures[0]);
  REQUIRE(pictures[2] == pictures[0]);
  Light sun;
  LitScene scene;
  scene.lights = {&sun, 1};
  scene.has_shadows = true;
  constexpr EffectSet kSun = Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion;
  REQUIRE(render_lit_band<kSun>(tree, camera, shading, scene, band(3)) == Status::kOk);
  REQUIRE(render_lit_band<kSun>(world.tree(), camera, shading, scene, band(4)) == Status::kOk);
  REQUIRE(render_lit_band<kSun>(world.tree(), world.map(), camera, shading, scene, {}, band(5)) ==
          Status::kOk);
  REQUIRE(pictures[4] == pictures[3]);
  REQUIRE(pictures[5] == pictures[3]);
}

TEST_CASE(
    "edited deep worlds: random edits at levels 9 and 10 -> bytes and pictures of a pool edited alike") {
  std::mt19937_64 random(seed_or(910));
  for (const int level : {9, 10}) {
    CAPTURE(level);
    DeepPair pair(level, {30000, 0, 6000, 600});
    Vec3i at{250, 250, 120};
    int undone = 0;
    int refused = 0;
    for (int edit = 0; edit < kDeepEdits; ++edit) {
      CAPTURE(edit);
      // Mostly near the last one; now and then at a surface, a corner, anywhere.
      constexpr Vec3i kPlaces[] = {
          {250, 250, 120}, {63, 63, 63}, {256, 300, 256}, {511, 511, 511}, {0, 0, 0}};
      const bool far = pick_int(random, 0, 29) == 0;
      const Vec3i from = far ? kPlaces[pick_int(random, 0, 4)] : at;
      for (int axis = 0; axis < 3; ++axis) {
        at[axis] = std::clamp(from[axis] + pick_int(random, -2, 2), 0, (1 << level) - 1);
      }
      const int material = pick_int(random, -1, edit / 200 % 2 == 0 ? 0 : 3);
      if (edit % 8 != 0) {
        const Status status =
            material < 0 ? pair.world.clear(at) : pair.world.set(at, static_cast<std::uint8_t>(material));
        refused += status == Status::kOutOfMemory ? 1 : 0;
        if (status == Status::kOk) {
          pair.put(at, material);
          REQUIRE(pair.world.material(at) == material);
        }
        continue;
      }
      VoxelBox box{at, at};
      for (int axis = 0; axis < 3; ++axis) {
        box.high[axis] += pick_int(random, 1, 9);
      }
      const HeapBytes before = packed(pair.world);
      const Status status = pair.world.edit(box, EditShape::kBox, material, &pair.journal);
      if (status == Status::kOk && pick_int(random, 0, 1) == 0) {
        REQUIRE(pair.world.undo(&pair.journal) == Status::kOk);
        ++undone;
      } else if (status == Status::kOk) {
        pair.journal.clear();
        for (Vec3i voxel = box.low; voxel.z < box.high.z; ++voxel.z) {
          for (voxel.y = box.low.y; voxel.y < box.high.y; ++voxel.y) {
            for (voxel.x = box.low.x; voxel.x < box.high.x; ++voxel.x) {
              if (std::max({voxel.x, voxel.y, voxel.z}) < 1 << level) {
                pair.put(voxel, material);
              }
            }
          }
        }
      }
      REQUIRE(packed(pair.world) == compact_of(pair.pool.octree));
      REQUIRE((status == Status::kOk || packed(pair.world) == before));
      if (edit % 64 == 0) {
        compare_pictures(random, pair.world);
      }
    }
    CHECK(undone > 20);
    CHECK(refused < kDeepEdits / 4);
  }
}

TEST_CASE(
    "edited deep worlds: too little room of each kind -> refused, with nothing changed; what goes comes "
    "back") {
  for (int lacking = 0; lacking < 3; ++lacking) {
    CAPTURE(lacking);
    EditRoom more{100, 0, 5, 3};
    (lacking == 0 ? more.nodes : lacking == 1 ? more.bricks : more.pages) = lacking == 0 ? 8 : 0;
    DeepPair pair(9, more);
    const HeapBytes before = packed(pair.world);
    CHECK(pair.world.set({150, 400, 30}, 3) == Status::kOutOfMemory);
    CHECK(pair.world.clear({300, 300, 300}) == Status::kOutOfMemory);
    CHECK(packed(pair.world) == before);
    CHECK(pair.world.set({282, 200, 100}, 7) == Status::kOk);  // where all there is suffices
    CHECK(EditedWorld::make(open_or_throw(before), {8, 0, 1, 1}, pair.bytes.span(), &pair.world) ==
          Status::kOutOfMemory);
  }
  DeepPair pair(10, {4000, 0, 4000, 200});
  const EditRoom free = pair.world.free_room();
  for (int edit = 0; edit < 3; ++edit) {
    const VoxelBox box{{40 + edit, 50, 60}, {60, 75, 80 + edit}};
    REQUIRE(pair.world.edit(box, EditShape::kBall, edit == 1 ? -1 : 9, &pair.journal) == Status::kOk);
  }
  CHECK(pair.world.free_room().bricks != free.bricks);
  while (pair.world.undo(&pair.journal) == Status::kOk) {
  }
  CHECK(pair.world.free_room().nodes == free.nodes);
  CHECK(pair.world.free_room().bricks == free.bricks);
  CHECK(pair.world.free_room().pages == free.pages);
  CHECK(packed(pair.world) == compact_of(pair.pool.octree));
}

TEST_CASE("edited deep worlds: emptied and begun again; room that bytes hold") {
  OwnedPool pool(9);
  REQUIRE(pool.octree.insert({500, 3, 77}, 5) == Status::kOk);
  const HeapBytes tree = compact_of(pool.octree);
  const std::size_t size = std::size_t{4} << 20;
  const EditRoom room = EditedWorld::room_in(open_or_throw(tree), size);
  CHECK(edited_world_bytes(9, room) <= size);
  CHECK(edited_world_bytes(9, room) + 4096 > size);
  CHECK(EditedWorld::room_in(open_or_throw(tree), std::size_t{1} << 18).pages == 0);
  HeapBytes bytes(size);
  EditedWorld world;
  REQUIRE(EditedWorld::make(open_or_throw(tree), room, bytes.span(), &world) == Status::kOk);
  const EditRoom free = world.free_room();
  for (int turn = 0; turn < 3; ++turn) {
    REQUIRE(world.clear({500, 3, 77}) == Status::kOk);
    CHECK(world.empty());
    CHECK(world.material({500, 3, 77}) == EditedWorld::kEmpty);
    REQUIRE(world.set({500, 3, 77}, 5) == Status::kOk);
  }
  CHECK(packed(world) == tree);
  CHECK(world.free_room().nodes == free.nodes);
  CHECK(world.free_room().bricks == free.bricks);
}

TEST_CASE("edited deep worlds: what reads nodes in order -> refused; of what is packed, made") {
  const DeepPair pair(9, {100, 0, 5, 3});
  const HeapBytes bytes = packed(pair.world);
  const CompactTree in_order = open_or_throw(bytes);
  std::vector<std::uint64_t> words(std::size_t{1} << 20);
  const Bytes memory(reinterpret_cast<std::uint8_t*>(words.data()), 8 * words.size());
  for (const bool is_packed : {false, true}) {
    CAPTURE(is_packed);
    const CompactTree& tree = is_packed ? in_order : pair.world.tree();
    const Status wanted = is_packed ? Status::kOk : Status::kDamaged;
    CHECK(tree.nodes_in_order() == is_packed);
    Arena arena(memory);
    wide::VoxelLists lists;
    CHECK(wide::VoxelLists::make(tree, &arena, &lists) == wanted);
    wide::RayMap map;
    CHECK(wide::RayMap::make(tree, &arena, &map) == wanted);
    NodeColors colors;
    CHECK(NodeColors::make(tree, {}, {}, memory, &colors) == wanted);
  }
}

}  // namespace
}  // namespace thimble::tests::edited_deep
