// A world that is edited is the world built anew: the same bytes when packed, the same bricks and materials in
// its map, the same pictures; and without room it stays as it was.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "support/compact_damage.h"
#include "support/counts.h"
#include "support/map_cells.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/picture/render.h"
#include "thimble/tree/edited_world.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

const int kWorlds = thimble::tests::many_or_few(200, 40);

/// The voxels of a world, one by one: a material, or -1.
class VoxelModel {
 public:
  explicit VoxelModel(int level)
      : level_(level), side_(1 << level), voxels_(static_cast<std::size_t>(side_ * side_ * side_), -1) {}

  int level() const { return level_; }
  int side() const { return side_; }
  std::int16_t& at(const Vec3i& voxel) {
    return voxels_[static_cast<std::size_t>((voxel.z * side_ + voxel.y) * side_ + voxel.x)];
  }
  template <class Visit>
  void for_each(const Visit& visit) {
    for (std::int32_t z = 0; z < side_; ++z) {
      for (std::int32_t y = 0; y < side_; ++y) {
        for (std::int32_t x = 0; x < side_; ++x) {
          visit(Vec3i{x, y, z}, at({x, y, z}));
        }
      }
    }
  }

  /// The compact tree of these voxels, by way of a pool.
  HeapBytes built() {
    OwnedPool pool(level_, 60000);
    for_each([&pool](const Vec3i& voxel, int material) {
      if (material >= 0) {
        REQUIRE(pool.octree.insert(voxel, static_cast<std::uint8_t>(material)) == Status::kOk);
      }
    });
    return compact_of(pool.octree);
  }

 private:
  int level_;
  int side_;
  std::vector<std::int16_t> voxels_;
};

/// Every voxel by the map: solid or not, and of which material.
bool map_is_right(const EditedWorld& world, VoxelModel& model) {
  return wrong_cells(
             world.map(), world.tree(), [&](const Vec3i& at) { return model.at(at); }, true) == 0;
}

/// Whether the pictures of `camera` are the same: by the edited world and its map, and by a tree built anew.
bool same_picture(const EditedWorld& world, const CompactTree& fresh, const PerspectiveView& view) {
  Camera camera;
  if (camera.set(view, fresh.level()) != Status::kOk) {
    return true;
  }
  Rgb8 palette[256];
  for (unsigned i = 0; i < 256; ++i) {
    palette[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(37 * i),
                  static_cast<std::uint8_t>(255 - i)};
  }
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = Span<const Rgb8>(palette);
  const std::size_t row = row_bytes(PixelFormat::kRgb565, view.width_px);
  std::vector<std::uint8_t> shown(row * static_cast<std::size_t>(view.height_px));
  std::vector<std::uint8_t> right(shown.size());
  const auto band = [&view](std::vector<std::uint8_t>& bytes) {
    return Band{{bytes.data(), bytes.size()}, PixelFormat::kRgb565, 0, 0, view.height_px};
  };
  REQUIRE(render_band(world.tree(), world.map(), camera, shading, band(shown)) == Status::kOk);
  REQUIRE(render_band(fresh, camera, shading, band(right)) == Status::kOk);
  return shown == right;
}

PerspectiveView random_view(std::mt19937_64& random, int side) {
  PerspectiveView view;
  for (int axis = 0; axis < 3; ++axis) {
    view.eye[axis] = Q8::from_raw(pick_int(random, -side * 256, 2 * side * 256));
    view.forward[axis] = side * 128 - view.eye[axis].raw + pick_int(random, -200, 200);
  }
  view.fov_degrees = Q16::saturate(pick_int(random, 20, 70));
  view.width_px = 40;
  view.height_px = 33;
  return view;
}

/// A world of boxes and strewn voxels; with few materials, solid blocks of every level.
void fill(std::mt19937_64& random, int materials, VoxelModel* model) {
  const int last = model->side() - 1;
  for (int boxes = pick_int(random, 0, 6); boxes > 0; --boxes) {
    Vec3i low;
    Vec3i high;
    for (int axis = 0; axis < 3; ++axis) {
      const int grid = pick_int(random, 0, 1) == 0 ? 1 : 4;
      low[axis] = pick_int(random, 0, last) / grid * grid;
      high[axis] = std::min(last, low[axis] + pick_int(random, 0, 3) * grid * 2 - 1);
    }
    const auto material = static_cast<std::int16_t>(pick_int(random, 0, materials - 1));
    model->for_each([&](const Vec3i& at, std::int16_t& voxel) {
      if (at.x >= low.x && at.y >= low.y && at.z >= low.z && at.x <= high.x && at.y <= high.y &&
          at.z <= high.z) {
        voxel = material;
      }
    });
  }
  // Voxels, and cubes of 2 x 2 x 2, which are blocks within bricks.
  for (int strewn = pick_int(random, 0, 1) * 60; strewn > 0; --strewn) {
    const Vec3i at{pick_int(random, 0, last), pick_int(random, 0, last), pick_int(random, 0, last)};
    const auto material = static_cast<std::int16_t>(pick_int(random, 0, materials - 1));
    for (int corner = 0; corner < (strewn % 2 == 0 ? 8 : 1); ++corner) {
      model->at({at.x ^ (corner & 1), at.y ^ (corner >> 1 & 1), at.z ^ (corner >> 2)}) = material;
    }
  }
}

// Of a tree and some edits: as often tight, so that edits are refused, as plenty.
EditRoom random_room(std::mt19937_64& random, const CompactTree& tree) {
  EditRoom room = EditedWorld::room_of(tree);
  const bool is_tight = pick_int(random, 0, 1) == 0;
  room.nodes += is_tight ? static_cast<std::uint32_t>(pick_int(random, 0, 40)) : 3000;
  room.leaves += is_tight ? static_cast<std::uint32_t>(pick_int(random, 0, 60)) : 5000;
  room.bricks += is_tight ? static_cast<std::uint32_t>(pick_int(random, 0, 4)) : 300;
  return room;
}

}  // namespace

TEST_CASE("edited world: random edits of random worlds -> bytes, map and pictures of the world built anew") {
  std::mt19937_64 random(20261);
  int refused = 0;
  int edits = 0;
  for (int trial = 0; trial < kWorlds; ++trial) {
    CAPTURE(trial);
    const int level = pick_int(random, 2, 5);
    const int materials = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 3 : 60;
    VoxelModel model(level);
    fill(random, materials, &model);
    const HeapBytes first = model.built();
    const EditRoom room = random_room(random, open_or_throw(first));
    HeapBytes bytes(edited_world_bytes(level, room));
    EditedWorld world;
    const Status made = EditedWorld::make(open_or_throw(first), room, bytes.span(), &world);
    if (materials == 60 && made == Status::kOutOfMemory) {
      continue;  // more kinds of solid bricks than there may be
    }
    REQUIRE(made == Status::kOk);
    REQUIRE(packed(world) == first);
    REQUIRE(map_is_right(world, model));
    const int last = model.side() - 1;
    Vec3i at{};
    for (int edit = 0; edit < 120; ++edit, ++edits) {
      CAPTURE(edit);
      // Near the last one more often than not, so that bricks fill up and empty.
      const bool far = pick_int(random, 0, 9) == 0;
      for (int axis = 0; axis < 3; ++axis) {
        at[axis] = far ? pick_int(random, 0, last) : std::clamp(at[axis] + pick_int(random, -1, 1), 0, last);
      }
      const int wish = pick_int(random, 0, 2) == 0 ? -1
                       : edit / 40 % 2 == 0        ? 0
                                                   : pick_int(random, 0, materials - 1);
      const HeapBytes before = packed(world);
      const Status status = wish < 0 ? world.clear(at) : world.set(at, static_cast<std::uint8_t>(wish));
      if (status == Status::kOk) {
        model.at(at) = static_cast<std::int16_t>(wish);
      } else {
        REQUIRE(status == Status::kOutOfMemory);
        REQUIRE(packed(world) == before);
        ++refused;
      }
      const EditRoom left = world.free_room();
      REQUIRE(left.nodes <= room.nodes);
      REQUIRE(left.leaves <= room.leaves);
      REQUIRE(left.bricks <= room.bricks);
      if (edit % 8 == 0 || status != Status::kOk) {
        REQUIRE(packed(world) == model.built());
        REQUIRE(map_is_right(world, model));
      }
    }
    const HeapBytes fresh = model.built();
    REQUIRE(packed(world) == fresh);
    REQUIRE(CompactTree::validate(packed(world).view()) == nullptr);
    for (int view = 0; view < 4; ++view) {
      REQUIRE(same_picture(world, open_or_throw(fresh), random_view(random, model.side())));
    }
  }
  CHECK(edits > 3000);
  CHECK(refused > 100);
}

TEST_CASE(
    "edited world: boxes and balls as one edit -> those voxels or none; taken back -> the bytes of before") {
  std::mt19937_64 random(40);
  int refused = 0;
  int undone = 0;
  for (int trial = 0; trial < kWorlds; ++trial) {
    CAPTURE(trial);
    const int materials = trial % 2 == 0 ? 3 : 60;
    VoxelModel model(pick_int(random, 2, 4));
    fill(random, materials, &model);
    const HeapBytes first = model.built();
    const EditRoom room = random_room(random, open_or_throw(first));
    HeapBytes bytes(edited_world_bytes(model.level(), room));
    EditedWorld world;
    if (EditedWorld::make(open_or_throw(first), room, bytes.span(), &world) != Status::kOk) {
      continue;  // more kinds of solid bricks than there may be
    }
    HeapBytes entries(static_cast<std::size_t>(pick_int(random, 0, 2000) * 8 + pick_int(random, 0, 7)));
    EditJournal journal(entries.span());
    std::vector<VoxelModel> states{model};
    for (int edit = 0; edit < 24; ++edit) {
      CAPTURE(edit);
      VoxelBox box;
      for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = pick_int(random, -3, model.side());
        box.high[axis] = box.low[axis] + pick_int(random, 0, 7);
      }
      const EditShape shape = pick_int(random, 0, 1) == 0 ? EditShape::kBox : EditShape::kBall;
      const int material = pick_int(random, -1, materials - 1);
      const Status status = world.edit(box, shape, material, &journal);
      REQUIRE(journal.size() <= journal.capacity());
      if (status == Status::kOk) {
        model.for_each([&](const Vec3i& at, std::int16_t& voxel) {
          double from_middle = 0;
          bool inside = true;
          for (int axis = 0; axis < 3; ++axis) {
            const double radius = (box.high[axis] - box.low[axis]) / 2.0;
            const double part = (at[axis] + 0.5 - box.low[axis] - radius) / radius;
            inside = inside && at[axis] >= box.low[axis] && at[axis] < box.high[axis];
            from_middle += part * part;
          }
          // A middle on the surface itself counts; none lies so near to it that doubles could not tell.
          if (inside && (shape == EditShape::kBox || from_middle <= 1 + 1e-9)) {
            voxel = static_cast<std::int16_t>(material);
          }
        });
        states.push_back(model);
      } else {
        REQUIRE(status == Status::kOutOfMemory);
        ++refused;
      }
      REQUIRE(packed(world) == model.built());
      REQUIRE(map_is_right(world, model));
    }
    model.for_each([&](const Vec3i& at, int voxel) { REQUIRE(world.material(at) == voxel); });
    for (; states.size() > 1; ++undone) {
      states.pop_back();
      REQUIRE(world.undo(&journal) == Status::kOk);
      REQUIRE(packed(world) == states.back().built());
      REQUIRE(map_is_right(world, states.back()));
    }
    REQUIRE(world.undo(&journal) == Status::kBadArgument);
  }
  CHECK(refused > 100);
  CHECK(undone > 300);
}

TEST_CASE("edited world: edits that cannot be -> a status, and nothing done") {
  VoxelModel model(3);
  const HeapBytes first = model.built();
  HeapBytes bytes(edited_world_bytes(3, {100, 100, 10}));
  EditedWorld world;
  REQUIRE(EditedWorld::make(open_or_throw(first), {100, 100, 10}, bytes.span(), &world) == Status::kOk);
  HeapBytes entries(800);
  EditJournal journal(entries.span());
  const VoxelBox one{{1, 1, 1}, {2, 2, 2}};
  CHECK(world.edit(one, EditShape::kBox, 256, &journal) == Status::kBadArgument);
  CHECK(world.edit(one, EditShape::kBox, -2, &journal) == Status::kBadArgument);
  CHECK(world.edit({{0, 0, 0}, {513, 1, 1}}, EditShape::kBox, 1, &journal) == Status::kOutOfRange);
  CHECK(world.edit({{INT32_MIN, 0, 0}, {1, 1, 1}}, EditShape::kBall, 1, &journal) == Status::kOutOfRange);
  CHECK(world.edit({{0, 0, 0}, {1, 1, INT32_MAX}}, EditShape::kBall, 1, &journal) == Status::kOutOfRange);
  CHECK(EditedWorld().edit(one, EditShape::kBox, 1, &journal) == Status::kBadArgument);
  EditJournal none;
  CHECK(world.edit(one, EditShape::kBox, 1, &none) == Status::kOutOfMemory);
  CHECK(world.undo(&none) == Status::kBadArgument);
  // Room for a voxel and its edit, and one voxel more.
  EditJournal small(entries.span().subspan(0, 23));
  CHECK(small.capacity() == 2);
  CHECK(world.edit({{1, 1, 1}, {2, 2, 3}}, EditShape::kBox, 1, &small) == Status::kOutOfMemory);
  CHECK(small.size() + journal.size() == 0);
  CHECK(world.empty());
  // A voxel and an edit; nothing outside, and nothing that is so already.
  CHECK(world.edit(one, EditShape::kBall, 7, &journal) == Status::kOk);
  CHECK(journal.size() == 2);
  CHECK(world.material({1, 1, 1}) == 7);
  CHECK(world.material({-1, 0, 0}) == EditedWorld::kEmpty);
  CHECK(world.edit({{-400, -400, -400}, {-3, -3, -3}}, EditShape::kBox, 1, &journal) == Status::kOk);
  CHECK(world.edit(one, EditShape::kBox, 7, &journal) == Status::kOk);
  CHECK(journal.size() == 4);
  journal.clear();
  CHECK(world.undo(&journal) == Status::kBadArgument);
  CHECK(world.material({1, 1, 1}) == 7);
}

TEST_CASE("edited world: emptied and filled voxel by voxel -> no node, then one solid block, and back") {
  VoxelModel model(3);
  const HeapBytes none = model.built();
  const EditRoom room{100, 600, 8};
  HeapBytes bytes(edited_world_bytes(3, room));
  EditedWorld world;
  REQUIRE(EditedWorld::make(open_or_throw(none), room, bytes.span(), &world) == Status::kOk);
  CHECK(world.empty());
  CHECK(world.clear({1, 2, 3}) == Status::kOk);
  model.for_each([&world](const Vec3i& voxel, int) { REQUIRE(world.set(voxel, 9) == Status::kOk); });
  CHECK(world.tree().node_count() == 1);
  CHECK(world.tree().voxel_count() == 512);
  CHECK(world.free_room().bricks == room.bricks);
  CHECK(world.bounds() == VoxelBox{{0, 0, 0}, {8, 8, 8}});
  model.for_each([&world](const Vec3i& voxel, int) { REQUIRE(world.clear(voxel) == Status::kOk); });
  CHECK(world.empty());
  CHECK(world.free_room().nodes == room.nodes);
  CHECK(world.free_room().leaves == room.leaves);
  CHECK(world.free_room().bricks == room.bricks);
  CHECK(packed(world) == none);
}

TEST_CASE("edited world: what cannot be -> a status, and nothing done") {
  VoxelModel model(3);
  model.at({1, 1, 1}) = 2;
  const HeapBytes tree = model.built();
  const CompactTree opened = open_or_throw(tree);
  const EditRoom room = EditedWorld::room_of(opened);
  CHECK(room.nodes == 3);
  CHECK(room.leaves == 1);
  CHECK(room.bricks == 1);
  HeapBytes bytes(edited_world_bytes(3, room));
  EditedWorld world;
  CHECK(world.set({0, 0, 0}, 1) == Status::kOutOfRange);
  CHECK(world.pack(bytes.span()) == Status::kBadArgument);
  CHECK(EditedWorld::make(opened, room, bytes.span().subspan(0, bytes.view().size - 1), &world) ==
        Status::kOutOfMemory);
  CHECK(EditedWorld::make(opened, {2, 1, 1}, bytes.span(), &world) == Status::kOutOfMemory);
  CHECK(EditedWorld::make(opened, {3, 0, 1}, bytes.span(), &world) == Status::kOutOfMemory);
  CHECK(EditedWorld::make(opened, {3, 1, 0}, bytes.span(), &world) == Status::kOutOfMemory);
  CHECK(EditedWorld::make(opened, {3, 1, 65001}, bytes.span(), &world) == Status::kOutOfRange);
  CHECK(EditedWorld::make(CompactTree(), room, bytes.span(), &world) == Status::kOutOfRange);
  REQUIRE(EditedWorld::make(opened, room, bytes.span(), &world) == Status::kOk);
  CHECK(world.set({8, 0, 0}, 1) == Status::kOutOfRange);
  CHECK(world.clear({0, -1, 0}) == Status::kOutOfRange);
  CHECK(world.set({1, 1, 1}, 2) == Status::kOk);
  CHECK(world.set({1, 1, 0}, 2) == Status::kOutOfMemory);
  CHECK(world.set({1, 1, 1}, 3) == Status::kOk);
  CHECK(world.tree().voxel_count() == 1);
  // Room is what is left over, in the proportions that digging wants.
  CHECK(EditedWorld::room_in(opened, bytes.view().size - 1).nodes == 0);
  for (std::size_t size = bytes.view().size; size < 4000; size += 97) {
    const EditRoom most = EditedWorld::room_in(opened, size);
    CHECK(edited_world_bytes(3, most) <= size);
    CHECK(edited_world_bytes(3, most) + 256 > size);
  }
}

TEST_CASE("edited world: trees whose counts lie -> kDamaged, before anything is copied") {
  VoxelModel model(4);
  std::mt19937_64 random(5);
  fill(random, 3, &model);
  model.at({3, 3, 3}) = 1;
  const HeapBytes tree = model.built();
  const EditRoom room{4000, 8000, 64};
  HeapBytes bytes(edited_world_bytes(4, room));
  EditedWorld world;
  int refused = 0;
  for (std::size_t at = kCompactHeaderBytes; at < kCompactHeaderBytes + open_or_throw(tree).node_count();
       ++at) {
    HeapBytes damaged(tree.view().size);
    std::copy(tree.view().begin(), tree.view().end(), damaged.span().begin());
    damaged.span()[at] ^= 0x11;
    CompactTree opened;
    REQUIRE(CompactTree::open(damaged.view(), &opened) == Status::kOk);
    if (EditedWorld::make(opened, room, bytes.span(), &world) == Status::kDamaged) {
      ++refused;
    } else {
      // Another sound tree, which can be edited like any.
      REQUIRE(world.clear({3, 3, 3}) == Status::kOk);
      REQUIRE(world.set({15, 0, 15}, 1) == Status::kOk);
    }
  }
  CHECK(refused > 10);
}

// Worlds that are edited, at the ends of what their functions take. Each answer is worked out by hand from
// src/FORMAT.md.
namespace thimble::tests::edited_world_edges {
namespace {

TEST_CASE("edited worlds: one of no tree, of a level without maps, of too much room -> refused") {
  OwnedPool pool(2);
  REQUIRE(pool.octree.insert({1, 1, 1}, 2) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const CompactTree tree = open_or_throw(bytes);
  const EditRoom room{100, 100, 10};
  const HeapBytes given(edited_world_bytes(2, room) / 8 * 8 + 16);
  const Bytes memory = given.span();
  EditedWorld world;
  const auto make = [&](const CompactTree& from, const EditRoom& wanted, Bytes to) {
    return EditedWorld::make(from, wanted, to, &world);
  };
  for (const int level : {1, 11}) {
    OwnedPool other(level);
    REQUIRE(other.octree.insert({1, 1, 1}, 2) == Status::kOk);
    const HeapBytes of_level = compact_of(other.octree);
    CHECK(make(open_or_throw(of_level), room, memory) == Status::kOutOfRange);
    CHECK(EditedWorld::room_in(open_or_throw(of_level), std::size_t{1} << 30).nodes == 0);
  }
  CHECK(make(tree, {1U << 24, 100, 10}, memory) == Status::kOutOfRange);
  CHECK(make(tree, {(1U << 24) - 1, 100, 10}, memory) == Status::kOutOfMemory);
  CHECK(make(tree, {100, 100, 65001}, memory) == Status::kOutOfRange);
  CHECK(make(tree, {100, 100, 65000}, memory) == Status::kOutOfMemory);
  for (std::size_t odd = 1; odd < 8; ++odd) {
    CHECK(make(tree, room, {memory.data + odd, memory.size - 8}) == Status::kBadArgument);
  }
  REQUIRE(pool.octree.insert({3, 3, 3}, 2) == Status::kOk);
  REQUIRE(pool.octree.coarsen_to(1) == Status::kOk);
  const HeapBytes coarse = compact_of(pool.octree);
  CHECK(make(open_or_throw(coarse), room, memory) == Status::kBadArgument);
  // A view of nothing is of level 1; a world of nothing takes no edit.
  CHECK(make(CompactTree(), room, memory) == Status::kOutOfRange);
  CHECK(world.set({0, 0, 0}, 1) == Status::kOutOfRange);
  CHECK(world.clear({0, 0, 0}) == Status::kOutOfRange);
  CHECK(world.pack({}) == Status::kBadArgument);
  REQUIRE(make(tree, room, memory) == Status::kOk);
  CHECK(world.tree().voxel_count() == 1);
}

TEST_CASE("edited worlds: a tree with solid bricks of 32 materials -> one of it; of 33 -> out of memory") {
  OwnedPool pool(4);
  for (std::int32_t kind = 0; kind < 33; ++kind) {
    const HeapBytes bytes = compact_of(pool.octree);
    const EditRoom room{1000, 1000, 10};
    const HeapBytes memory(edited_world_bytes(4, room));
    EditedWorld world;
    if (kind > 30) {
      REQUIRE(EditedWorld::make(open_or_throw(bytes), room, memory.span(), &world) == Status::kOk);
      // Nothing more of a material that none has, where all 32 are taken.
      const Vec3i brick{(kind & 3) * 4, (kind >> 2 & 3) * 4, (kind >> 4) * 4};
      Status status = Status::kOk;
      for (std::int32_t i = 0; i < 64 && status == Status::kOk; ++i) {
        status = world.set({brick.x + (i & 3), brick.y + (i >> 2 & 3), brick.z + (i >> 4)}, 90);
        CHECK((status == Status::kOk) == (kind < 32 || i < 63));
      }
    }
    REQUIRE(pool.octree.insert_block({(kind & 3) * 4, (kind >> 2 & 3) * 4, (kind >> 4) * 4}, 2,
                                     static_cast<std::uint8_t>(kind + 1)) == Status::kOk);
  }
  const HeapBytes bytes = compact_of(pool.octree);
  const EditRoom room{1000, 1000, 10};
  const HeapBytes memory(edited_world_bytes(4, room));
  EditedWorld world;
  CHECK(EditedWorld::make(open_or_throw(bytes), room, memory.span(), &world) == Status::kOutOfMemory);
  CHECK(world.tree().bytes() == nullptr);
}

}  // namespace
}  // namespace thimble::tests::edited_world_edges
