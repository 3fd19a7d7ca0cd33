// Worlds that are edited, at the ends of what their functions take. Each answer is worked out by hand from
// src/FORMAT.md.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "support/scene_under_test.h"
#include "thimble/tree/edited_world.h"
#include "thimble/tree/octree.h"

namespace thimble::tests::edited_world_edges {
namespace {

TEST_CASE("edited worlds: one of no tree, of a level without maps, of too much room -> refused") {
  OwnedPool pool(2);
  REQUIRE(pool.octree.insert({1, 1, 1}, 2) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const CompactTree tree = open_or_throw(bytes);
  const EditRoom room{100, 100, 10};
  std::vector<std::uint64_t> words(edited_world_bytes(2, room) / 8 + 2);
  const Bytes memory{reinterpret_cast<std::uint8_t*>(words.data()), 8 * words.size()};
  EditedWorld world;
  const auto make = [&](const CompactTree& from, const EditRoom& wanted, Bytes to) {
    return EditedWorld::make(from, wanted, to, &world);
  };
  for (const int level : {1, 9}) {
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

TEST_CASE("edited worlds: edits outside, on each side of it -> out of range, nothing changed") {
  OwnedPool pool(3);
  REQUIRE(pool.octree.insert({1, 2, 3}, 2) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const CompactTree tree = open_or_throw(bytes);
  const EditRoom room{100, 100, 10};
  std::vector<std::uint64_t> words(edited_world_bytes(3, room) / 8 + 1);
  EditedWorld world;
  REQUIRE(EditedWorld::make(tree, room, {reinterpret_cast<std::uint8_t*>(words.data()), 8 * words.size()},
                            &world) == Status::kOk);
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::int32_t outside : {-1, 8, INT32_MIN, INT32_MAX}) {
      Vec3i at{4, 4, 4};
      at[axis] = outside;
      CHECK(world.set(at, 3) == Status::kOutOfRange);
      CHECK(world.clear(at) == Status::kOutOfRange);
    }
  }
  HeapBytes packed(bytes.view().size);
  REQUIRE(world.pack(packed.span()) == Status::kOk);
  CHECK(std::equal(packed.view().begin(), packed.view().end(), bytes.view().begin()));
}

TEST_CASE("edited worlds: a tree with solid bricks of 32 materials -> one of it; of 33 -> out of memory") {
  OwnedPool pool(4);
  for (std::int32_t kind = 0; kind < 33; ++kind) {
    const HeapBytes bytes = compact_of(pool.octree);
    const EditRoom room{1000, 1000, 10};
    std::vector<std::uint64_t> words(edited_world_bytes(4, room) / 8 + 1);
    const Bytes memory{reinterpret_cast<std::uint8_t*>(words.data()), 8 * words.size()};
    EditedWorld world;
    if (kind > 30) {
      REQUIRE(EditedWorld::make(open_or_throw(bytes), room, memory, &world) == Status::kOk);
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
  std::vector<std::uint64_t> words(edited_world_bytes(4, room) / 8 + 1);
  EditedWorld world;
  CHECK(EditedWorld::make(open_or_throw(bytes), room,
                          {reinterpret_cast<std::uint8_t*>(words.data()), 8 * words.size()},
                          &world) == Status::kOutOfMemory);
  CHECK(world.tree().bytes() == nullptr);
}

}  // namespace
}  // namespace thimble::tests::edited_world_edges
