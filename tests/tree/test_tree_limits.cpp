// Trees and maps where their numbers change kind: exactly as much room as is taken, one less, headers at the ends of their
// ranges, prices of nodes by their definition.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "support/compact_damage.h"
#include "support/map_cells.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/tree/edited_world.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// ---- the octree

// A world of 4 x 4 x 4 with n voxels in m nodes: to merge it adds 64 - n for m nodes.
TEST_CASE(
    "tree limits: prices of a world of two levels -> merged from the step on that the definition says") {
  std::mt19937_64 random(20260811);
  for (int world = 0; world < 200; ++world) {
    OwnedPool owned(2, 20);
    int voxels = 0;
    int nodes = 0;
    for (std::int32_t octant = 0; octant < 8; ++octant) {
      const int here = pick_int(random, 0, 7) - 2;  // never a full node, which would be a block
      nodes += here > 0 ? 1 : 0;
      for (std::int32_t i = 0; i < here; ++i, ++voxels) {
        REQUIRE(owned.octree.insert({(octant & 1) * 2 + (i & 1), (octant >> 1 & 1) * 2 + (i >> 1 & 1),
                                     (octant >> 2) * 2 + (i >> 2)},
                                    3) == Status::kOk);
      }
    }
    if (nodes == 0) {
      continue;
    }
    CAPTURE(world);
    const double ratio = (64.0 - voxels) / nodes;
    for (int step = -3; step < Octree::kPriceSteps + 3; ++step) {
      const int taken = std::clamp(step, 0, Octree::kPriceSteps - 1);
      const double price = std::ldexp(1 + taken % 4 / 4.0, taken / 4 - 27);
      const auto wanted = static_cast<std::uint32_t>(ratio <= price ? 1 : nodes + 1);
      REQUIRE(owned.octree.nodes_at(step) == wanted);
      REQUIRE(owned.octree.nodes_used() == static_cast<std::uint32_t>(nodes) + 1);
    }
    const int step = world % 10 == 0 ? INT32_MIN : world % 10 == 1 ? INT32_MAX : pick_int(random, 90, 140);
    const std::uint32_t foretold = owned.octree.nodes_at(step);
    CHECK(foretold == owned.octree.nodes_at(std::clamp(step, 0, Octree::kPriceSteps - 1)));
    owned.octree.coarsen_at(step);
    CHECK(owned.octree.nodes_used() == foretold);
  }
}

// ---- brick maps

TEST_CASE("tree limits: maps of mixed bricks alone, of others alone and of one -> each material as it is") {
  for (int kind = 0; kind < 4; ++kind) {
    for (const int side : {4, 8, 16}) {
      OwnedPool owned(side == 4 ? 2 : side == 8 ? 3 : 4);
      const auto material = [&](const Vec3i& at) {
        const int mixed = kind == 0 ? 1 : kind == 1 ? 0 : (at.x / 4 + at.y / 4 + at.z / 4) % 2;
        return static_cast<std::uint8_t>(mixed != 0 ? 1 + (at.x + at.y + at.z) % 3 : 7);
      };
      const auto solid = [&](const Vec3i& at) { return (at.x * 3 + at.y * 5 + at.z) % 4 != 0 || kind == 3; };
      for (std::int32_t i = 0; i < side * side * side; ++i) {
        const Vec3i at{i % side, i / side % side, i / side / side};
        if (solid(at)) {
          REQUIRE(owned.octree.insert(at, material(at)) == Status::kOk);
        }
      }
      const HeapBytes bytes = compact_of(owned.octree);
      const OwnedMap made(open_or_throw(bytes), most_brick_map_bytes(owned.octree.level()));
      REQUIRE(made.status == Status::kOk);
      CHECK(BrickMap::validate({made.room.view().data, made.size}) == nullptr);
      CHECK((made.map.mixed_count() == 0) == (kind == 1 || (kind > 1 && side == 4)));
      if (kind == 0) {
        CHECK(made.map.mixed_count() == made.map.brick_count() - 1);
      }
      CHECK(wrong_cells(made.map, made.tree,
                        [&](const Vec3i& at) { return solid(at) ? int{material(at)} : -1; }) == 0);
      // While it is made it takes 2 bytes a brick more, and nothing else where no brick is shared.
      if (kind != 3) {
        const std::size_t least = made.size + 2 * std::size_t{made.map.brick_count()};
        const OwnedMap again(open_or_throw(bytes), least);
        REQUIRE(again.status == Status::kOk);
        CHECK(again.size == made.size);
        CHECK(std::equal(made.room.view().begin(), made.room.view().begin() + made.size,
                         again.room.view().begin()));
        CHECK(OwnedMap(open_or_throw(bytes), least - 2).status == Status::kOutOfMemory);
      }
    }
  }
}

// ---- shared trees

std::string shared_fault(const HeapBytes& bytes) {
  HeapBytes work(shared_check_bytes(bytes.view().size));
  std::fill(work.span().begin(), work.span().end(), std::uint8_t{0xFF});
  const char* const text = SharedTree::validate(bytes.view(), work.span());
  return text == nullptr ? "" : text;
}

HeapBytes some_shared(int level, int materials, std::uint64_t seed) {
  OwnedPool owned(level);
  std::mt19937_64 random(seed);
  for (int i = 0; i < 60; ++i) {
    const int side = (1 << level) - 1;
    REQUIRE(
        owned.octree.insert({pick_int(random, 0, side), pick_int(random, 0, side), pick_int(random, 0, side)},
                            static_cast<std::uint8_t>(i % materials)) == Status::kOk);
  }
  const HeapBytes compact = compact_of(owned.octree);
  return shared_of(open_or_throw(compact));
}

// Where things stand in a shared tree's header: src/FORMAT.md.
constexpr std::size_t kLinkBytes = 5;
constexpr std::size_t kCountBytes = 60;

TEST_CASE("tree limits: a shared tree's header -> links of 1 to 4 bytes, counts of 1 to 4 or of none") {
  for (const int materials : {1, 3}) {
    const HeapBytes bytes = some_shared(5, materials, 11);
    REQUIRE(shared_fault(bytes).empty());
    SharedTree opened;
    for (int value = 0; value < 256; ++value) {
      std::uint8_t& byte = bytes.span()[kLinkBytes];
      const std::uint8_t before = byte;
      byte = static_cast<std::uint8_t>(value);
      const bool fine = value >= 1 && value <= 4;
      CHECK((SharedTree::open(bytes.view(), &opened) == Status::kOk) == fine);
      CHECK((shared_fault(bytes) == "links of no such size") == !fine);
      byte = before;
    }
    for (int value = 0; value < 256; ++value) {
      std::uint8_t& byte = bytes.span()[kCountBytes];
      const std::uint8_t before = byte;
      byte = static_cast<std::uint8_t>(value);
      const bool fine = materials == 1 ? value == 0 : value >= 1 && value <= 4;
      CHECK((SharedTree::open(bytes.view(), &opened) == Status::kOk) == fine);
      CHECK((shared_fault(bytes) == "counts of no such size") == !fine);
      byte = before;
    }
  }
}

// Links grow from 1 to 2 bytes where the nodes pass 256 bytes, and the counts of several materials may do that.
TEST_CASE("tree limits: bytes with materials where links grow by a byte -> those of two materials") {
  int grown = 0;
  for (int points = 1; points < 120; ++points) {
    OwnedPool one(5);
    OwnedPool two(5);
    std::mt19937_64 random(static_cast<std::uint64_t>(points));
    for (int i = 0; i < points; ++i) {
      // At even places, so that no block of eight is full.
      const Vec3i at{2 * pick_int(random, 0, 15), 2 * pick_int(random, 0, 15), 2 * pick_int(random, 0, 15)};
      REQUIRE(one.octree.insert(at, 7) == Status::kOk);
      REQUIRE(two.octree.insert(at, 2) == Status::kOk);
    }
    REQUIRE(one.octree.insert({30, 30, 30}, 7) == Status::kOk);
    REQUIRE(two.octree.insert({30, 30, 30}, 3) == Status::kOk);
    REQUIRE(one.octree.insert({0, 0, 0}, 7) == Status::kOk);
    REQUIRE(two.octree.insert({0, 0, 0}, 2) == Status::kOk);
    const HeapBytes first = compact_of(one.octree);
    const HeapBytes second = compact_of(two.octree);
    const HeapBytes plain = shared_of(open_or_throw(first));
    const HeapBytes colored = shared_of(open_or_throw(second));
    grown += plain.view()[kLinkBytes] != colored.view()[kLinkBytes] ? 1 : 0;
    SharedTree tree;
    REQUIRE(SharedTree::open(plain.view(), &tree) == Status::kOk);
    CHECK(tree.bytes_with_materials() == colored.view().size);
  }
  CHECK(grown > 2);
}

// ---- worlds that are edited

TEST_CASE(
    "tree limits: a block opened with exactly the room it takes -> done; with one less -> nothing done") {
  for (int level = 2; level <= 5; ++level) {
    OwnedPool owned(level);
    REQUIRE(owned.octree.insert_block({0, 0, 0}, level, 4) == Status::kOk);
    const HeapBytes compact = compact_of(owned.octree);
    const CompactTree tree = open_or_throw(compact);
    const auto levels = static_cast<std::uint32_t>(level);
    const EditRoom exact{1 + 8 * (levels - 1), 1 + 7 * levels, 1};
    for (int less = 0; less < 4; ++less) {
      for (const bool clears : {true, false}) {
        EditRoom room = exact;
        room.nodes -= less == 1 ? 1 : 0;
        room.leaves -= less == 2 ? 1 : 0;
        room.bricks -= less == 3 ? 1 : 0;
        HeapBytes bytes(edited_world_bytes(level, room));
        EditedWorld world;
        REQUIRE(EditedWorld::make(tree, room, bytes.span(), &world) == Status::kOk);
        const Status status = clears ? world.clear({1, 0, 1}) : world.set({1, 0, 1}, 5);
        CAPTURE(level);
        CAPTURE(less);
        CHECK(status == (less == 0 ? Status::kOk : Status::kOutOfMemory));
        CHECK(world.tree().node_count() == (less == 0 ? exact.nodes : 1));
        if (less == 0) {
          CHECK(world.free_room().nodes == 0);
          CHECK(world.free_room().bricks == 0);
          // As many bytes as the tree takes that it is, with a material a leaf.
          CompactShape shape;
          shape.level = level;
          shape.nodes = exact.nodes;
          shape.solid_blocks = 7 * (levels - 1);
          shape.voxel_bits = clears ? 7 : 8;
          shape.many_materials = true;
          CHECK(world.tree().size_bytes() == compact_bytes(shape));
        }
      }
    }
  }
}

// Bricks solid of one material stand in a list of kSolidBrickKinds; the next material's is refused before it is made,
// whichever voxel of the brick is the last.
TEST_CASE(
    "tree limits: solid bricks of as many materials as there may be, and one more -> refused, unchanged") {
  OwnedPool owned(4);
  const HeapBytes none = compact_of(owned.octree);
  const EditRoom room{4000, 6000, 60};
  HeapBytes bytes(edited_world_bytes(4, room));
  EditedWorld world;
  REQUIRE(EditedWorld::make(open_or_throw(none), room, bytes.span(), &world) == Status::kOk);
  const auto voxel_of = [](std::uint32_t brick, std::uint32_t bit) {
    return Vec3i{static_cast<std::int32_t>((brick & 3U) * 4 + (bit & 3U)),
                 static_cast<std::int32_t>((brick >> 2 & 3U) * 4 + (bit >> 2 & 3U)),
                 static_cast<std::int32_t>((brick >> 4) * 4 + (bit >> 4))};
  };
  for (std::uint32_t kind = 0; kind < kSolidBrickKinds; ++kind) {
    for (std::uint32_t bit = 0; bit < 64; ++bit) {
      REQUIRE(world.set(voxel_of(kind, bit), static_cast<std::uint8_t>(kind + 1)) == Status::kOk);
    }
  }
  CHECK(world.free_room().bricks == room.bricks);
  constexpr std::uint32_t kBrick = kSolidBrickKinds;
  for (std::uint32_t bit = 1; bit < 64; ++bit) {
    REQUIRE(world.set(voxel_of(kBrick, bit), 200) == Status::kOk);
  }
  for (std::uint32_t last = 0; last < 64; ++last) {
    const std::uint32_t nodes = world.tree().node_count();
    CHECK(world.set(voxel_of(kBrick, last), 200) == Status::kOutOfMemory);
    CHECK(world.tree().node_count() == nodes);
    CHECK_FALSE(cell_of(world.map(), voxel_of(kBrick, last)).is_solid);
    // Of a material that bricks have it may be, and elsewhere another may come.
    REQUIRE(world.set(voxel_of(kBrick, last), 1) == Status::kOk);
    CHECK(cell_of(world.map(), voxel_of(kBrick, last)).is_solid);
    REQUIRE(world.clear(voxel_of(kBrick, (last + 1) % 64)) == Status::kOk);
    REQUIRE(world.set(voxel_of(kBrick, last), 200) == Status::kOk);
  }
}

TEST_CASE("tree limits: room in any number of bytes -> as much as fits, 65,000 bricks at most, level 8 too") {
  for (const int level : {2, 5, 8}) {
    OwnedPool owned(level);
    REQUIRE(owned.octree.insert({1, 1, 1}, 4) == Status::kOk);
    const HeapBytes compact = compact_of(owned.octree);
    const CompactTree tree = open_or_throw(compact);
    const EditRoom least = EditedWorld::room_of(tree);
    const std::size_t bytes = edited_world_bytes(level, least);
    CHECK(EditedWorld::room_in(tree, bytes - 1).nodes == 0);
    for (const std::size_t more : {0U, 1U, 63U, 64U, 65U}) {
      CHECK(EditedWorld::room_in(tree, bytes + more).nodes == least.nodes);
    }
    std::size_t last = 0;
    for (std::size_t more = 64; more < 4000; more += 7) {
      const EditRoom room = EditedWorld::room_in(tree, bytes + more);
      CHECK(edited_world_bytes(level, room) <= bytes + more);
      CHECK(room.bricks >= last);
      CHECK(room.nodes - least.nodes == 9 * (room.bricks - least.bricks));
      CHECK(room.leaves - least.leaves == 24 * (room.bricks - least.bricks));
      last = room.bricks;
    }
    CHECK(last > 50);
    CHECK(EditedWorld::room_in(tree, std::size_t{1} << 28).bricks == 65000);
  }
  OwnedPool large(11);
  REQUIRE(large.octree.insert({1, 1, 1}, 4) == Status::kOk);
  const HeapBytes compact = compact_of(large.octree);
  CHECK(EditedWorld::room_in(open_or_throw(compact), std::size_t{1} << 30).nodes == 0);
}

TEST_CASE(
    "tree limits: as many bricks as a map and an edited world have, and one more -> made, or out of range") {
  for (const std::uint32_t bricks : {65000U, 65001U, 65280U, 65281U}) {
    CAPTURE(bricks);
    std::vector<std::uint32_t> keys(bricks);
    for (std::uint32_t i = 0; i < bricks; ++i) {
      keys[i] = i << 6;  // the first voxel of each brick, in Morton order
    }
    const Span<const std::uint32_t> span{keys.data(), keys.size()};
    std::size_t size = 0;
    REQUIRE(CompactTree::make(span, 8, 3, {}, nullptr, &size) == Status::kOutOfMemory);
    HeapBytes bytes(size);
    CompactTree tree;
    REQUIRE(CompactTree::make(span, 8, 3, bytes.span(), &tree) == Status::kOk);
    const OwnedMap made(open_or_throw(bytes), most_brick_map_bytes(8));
    CHECK(made.status == (bricks <= 65280 ? Status::kOk : Status::kOutOfRange));
    const EditRoom room = EditedWorld::room_in(tree, std::size_t{1} << 26);
    CHECK(room.bricks == (bricks <= 65000 ? bricks : 0));
    CHECK((room.nodes != 0) == (bricks <= 65000));
  }
}

}  // namespace
