// Brick maps of worlds of level 9 and 10: each voxel and what is seen of its material, the room that they take, and
// damage.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "support/map_cells.h"
#include "support/ray_cases.h"
#include "thimble/base/memory.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// What a ray along x from beside the voxel hits: the tree's own answer.
int tree_material(const CompactTree& tree, const Vec3i& voxel) {
  Ray ray;
  ray.origin = {Q8::from_raw(voxel.x * 256), Q8::from_raw(voxel.y * 256 + 128),
                Q8::from_raw(voxel.z * 256 + 128)};
  ray.direction = {1, 0, 0};
  Hit hit;
  REQUIRE(closest_hit(tree, ray, &hit) == Status::kOk);
  return hit.kind == HitKind::kHit && hit.t_numerator == 0 ? hit.material : -1;
}

}  // namespace

TEST_CASE(
    "deep map: random worlds of level 9 and 10 -> each voxel looked at, and its material where it is seen") {
  std::mt19937_64 random(910);
  constexpr int kKinds = std::size(kChipWorlds);
  for (int turn = 0; turn < 2 * kKinds; ++turn) {
    CAPTURE(turn);
    const int level = 9 + turn / kKinds;
    const MappedTree scene = make_chip_scene(random, kChipWorlds[turn % kKinds], level);
    const BrickMap& map = scene.map;
    REQUIRE(map.level() == level);
    REQUIRE(map.belongs_to(scene.tree));
    std::uint64_t solid = 0;
    std::uint64_t wrong = 0;
    const Vec3i size{map.box().high.x - map.box().low.x, map.box().high.y - map.box().low.y,
                     map.box().high.z - map.box().low.z};
    for (std::int32_t z = 0; z < size.z; ++z) {
      for (std::int32_t y = 0; y < size.y; ++y) {
        for (std::int32_t x = 0; x < size.x; ++x) {
          const std::uint32_t number = brick_at(map, {x, y, z});
          for (int half = 0; half < 8 && number != 0; half += 4) {
            solid += static_cast<unsigned>(
                __builtin_popcount(word_at(map.bricks() + 8 * std::size_t{number} + half)));
          }
        }
      }
    }
    CHECK(solid == scene.tree.voxel_count());
    const int side = 1 << level;
    for (int i = 0; i < 4000; ++i) {
      // Mostly near the box, whose corner is often solid.
      Vec3i at;
      for (int axis = 0; axis < 3; ++axis) {
        at[axis] = i % 4 == 0 ? pick_int(random, 0, side - 1)
                              : std::min(side - 1, 4 * map.box().low[axis] + pick_int(random, 0, 100));
      }
      const MapCell cell = cell_of(map, at);
      const int material = tree_material(scene.tree, at);
      wrong += cell.is_solid != (material >= 0) ? 1U : 0U;
      bool seen = false;
      for (int face = 0; face < 6; ++face) {
        Vec3i next = at;
        next[face / 2] += face % 2 != 0 ? 1 : -1;
        seen = seen || !cell_of(map, next).is_solid;
      }
      wrong += cell.is_solid && seen && map.material(scene.tree, cell.brick, cell.bit) != material ? 1U : 0U;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE(
    "deep map: solid pages of three materials, and the world's last voxel -> each brick of its material") {
  OwnedPool octree_pool(9, 300);
  Octree& octree = octree_pool.octree;
  const struct {
    Vec3i corner;
    int level;
    std::uint8_t material;
  } blocks[] = {{{32, 0, 64}, 5, 3}, {{64, 0, 64}, 4, 7}, {{80, 0, 64}, 4, 3}, {{128, 0, 64}, 6, 0}};
  for (const auto& block : blocks) {
    REQUIRE(octree.insert_block(block.corner, block.level, block.material) == Status::kOk);
  }
  REQUIRE(octree.insert({511, 511, 511}, 9) == Status::kOk);
  const MappedTree scene(compact_of(octree));
  const BrickMap& map = scene.map;
  CHECK(BrickMap::validate({scene.map_room.view().data, map.size_bytes()}) == nullptr);
  CHECK(map.brick_count() == 5);  // empty, one a material, the last voxel's
  for (const auto& block : blocks) {
    const int last = (1 << block.level) - 1;
    for (const Vec3i& at :
         {block.corner, Vec3i{block.corner.x + last, block.corner.y + last, block.corner.z + last}}) {
      const MapCell cell = cell_of(map, at);
      REQUIRE(cell.is_solid);
      CHECK(map.material(scene.tree, cell.brick, cell.bit) == block.material);
    }
  }
  const MapCell last = cell_of(map, {511, 511, 511});
  REQUIRE(last.is_solid);
  CHECK(map.material(scene.tree, last.brick, last.bit) == 9);
}

TEST_CASE("deep map: an empty world, a full one, one voxel -> the bytes that the format's page says") {
  const struct {
    int block;  // its level; -1 none
    std::size_t bytes;
    std::uint32_t bricks;
  } worlds[] = {{-1, 48 + 72 + 8 + 8 + 4, 1}, {0, 48 + 8 + 136 + 16 + 8 + 4, 2}, {9, 0, 2}};
  for (const auto& world : worlds) {
    CAPTURE(world.block);
    OwnedPool octree_pool(9, 100);
    Octree& octree = octree_pool.octree;
    if (world.block >= 0) {
      REQUIRE(octree.insert_block({0, 0, 0}, world.block, 5) == Status::kOk);
    }
    const MappedTree scene(compact_of(octree));
    const BrickMap& map = scene.map;
    CHECK(BrickMap::validate({scene.map_room.view().data, map.size_bytes()}) == nullptr);
    CHECK(map.brick_count() == world.bricks);
    CHECK(map.empty() == (world.block < 0));
    if (world.bytes != 0) {
      CHECK(map.size_bytes() == world.bytes);
    }
  }
}

TEST_CASE("deep map: each count of origins and each entry of the table moved -> damaged") {
  std::mt19937_64 random(913);
  const MappedTree scene = make_chip_scene(random, ChipWorld::kBlocks, 9);
  const std::size_t size = scene.map.size_bytes();
  const HeapBytes bytes(size);
  std::uint8_t* const base = bytes.span().data;
  std::memcpy(base, scene.map_room.view().data, size);
  const std::size_t bricks = word_at(base + 36);
  const std::size_t ranks = (bricks + 31) / 32;
  const std::size_t first = size - 12 * std::size_t{word_at(base + 40)} - (bricks + 3) / 4 * 4 - 8 * ranks;
  const auto is_refused_with = [&](std::size_t at, std::uint8_t more) {
    base[at] = static_cast<std::uint8_t>(base[at] + more);
    BrickMap map;
    const bool refused = BrickMap::open(bytes.view(), &map) == Status::kDamaged;
    base[at] = static_cast<std::uint8_t>(base[at] - more);
    return refused;
  };
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    REQUIRE(is_refused_with(first + 8 * rank + 4, 1));
  }
  const std::size_t page_0 = first - 8 * bricks - (68 * std::size_t{word_at(base + 32)} + 7) / 8 * 8;
  for (std::size_t entry = 0; entry < 64; ++entry) {
    REQUIRE(is_refused_with(page_0 + 4 + entry, 1));
  }
  for (std::size_t cell = 0; cell < 50; ++cell) {
    REQUIRE(is_refused_with(48 + 4 * cell, 1));       // between two pages
    REQUIRE(is_refused_with(48 + 4 * cell + 3, 68));  // beyond the last
  }
  BrickMap map;
  CHECK(BrickMap::open(bytes.view(), &map) == Status::kOk);
}
