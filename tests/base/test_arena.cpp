// `make` in an arena: it gives just the bytes that a thing takes, and after an error it is as it was.
#include <doctest/doctest.h>

#include <cstdint>
#include <initializer_list>

#include "thimble/light/water.h"
#include "thimble/plane/particles.h"
#include "thimble/thimble.h"
#include "thimble/tree/dense_grid.h"

using namespace thimble;  // NOLINT

namespace {

struct State {
  std::size_t used;
  std::size_t high_water;
  bool operator==(const State&) const = default;
};
State state_of(const Arena& arena) {
  return {arena.used_bytes(), arena.high_water_bytes()};
}

// `make(arena)` takes `bytes` from an arena that has just so many, and from one that is a byte short nothing.
// The address is aligned, so there is no padding.
template <class Make>
void takes_exactly(std::size_t bytes, Make make) {
  alignas(8) static std::uint8_t memory[8192];
  REQUIRE(bytes <= sizeof(memory));
  Arena enough(Bytes(memory, bytes));
  CHECK(make(enough) == Status::kOk);
  CHECK(enough.used_bytes() == bytes);
  CHECK(enough.high_water_bytes() == bytes);
  if (bytes != 0) {
    Arena short_of_one(Bytes(memory, bytes - 1));
    CHECK(make(short_of_one) == Status::kOutOfMemory);
    CHECK(state_of(short_of_one) == State{0, 0});
  }
  // Behind an odd byte: no more than the padding besides.
  Arena shifted{Bytes(memory)};
  shifted.take(1, 1);
  CHECK(make(shifted) == Status::kOk);
  CHECK(shifted.used_bytes() >= 1 + bytes);
  CHECK(shifted.used_bytes() <= 8 + bytes);
}

// `make(arena)` fails with `status` and leaves an arena with plenty of room alone.
template <class Make>
void fails_with(Status status, Make make) {
  alignas(8) static std::uint8_t memory[8192];
  Arena arena{Bytes(memory)};
  arena.take(24);
  arena.rewind(16);
  CHECK(make(arena) == status);
  CHECK(state_of(arena) == State{16, 24});
}

}  // namespace

TEST_CASE("arena: a dense grid") {
  DenseGrid grid;
  takes_exactly(14, [&](Arena& arena) { return DenseGrid::make({5, 3, 7}, arena, &grid); });
  CHECK(grid.used_bytes() == 14);
  fails_with(Status::kOutOfRange, [&](Arena& arena) { return DenseGrid::make({0, 3, 7}, arena, &grid); });
  fails_with(Status::kOutOfMemory, [&](Arena& arena) { return DenseGrid::make({64, 64, 64}, arena, &grid); });
  CHECK(grid.size() == Vec3i{5, 3, 7});
}

TEST_CASE("arena: a bit field") {
  BitField field;
  takes_exactly(0, [&](Arena& arena) { return BitField::make(0, 10, arena, &field); });
  takes_exactly(80, [&](Arena& arena) { return BitField::make(33, 10, arena, &field); });
  CHECK(field.used_bytes() == 80);
  fails_with(Status::kOutOfRange, [&](Arena& arena) { return BitField::make(-1, 10, arena, &field); });
  fails_with(Status::kOutOfMemory, [&](Arena& arena) { return BitField::make(1024, 100, arena, &field); });
  CHECK(field.width() == 33);
}

TEST_CASE("arena: a particle world") {
  ParticleConfig config;
  config.width = 128;
  config.height = 64;
  config.capacity = 60;
  config.most_diameter = 8;
  config.least_diameter = 2;
  ParticleWorld world;
  takes_exactly(3604, [&](Arena& arena) { return ParticleWorld::make(config, arena, &world); });
  CHECK(world.used_bytes() == 3604);
  ParticleConfig wrong = config;
  wrong.restitution_q16 = 65537;
  fails_with(Status::kOutOfRange, [&](Arena& arena) { return ParticleWorld::make(wrong, arena, &world); });
  wrong = config;
  wrong.width = 4096;
  fails_with(Status::kOutOfMemory, [&](Arena& arena) { return ParticleWorld::make(wrong, arena, &world); });
  CHECK(world.config().width == 128);
}

TEST_CASE("arena: water") {
  WaterConfig config;
  config.width = 16;
  config.depth = 8;
  config.rest_q8 = 512;
  config.greatest_q8 = 1024;
  Water water;
  takes_exactly(1059, [&](Arena& arena) { return Water::make(config, arena, &water); });
  CHECK(water.width() == 16);
  WaterConfig wrong = config;
  wrong.width = 0;
  fails_with(Status::kOutOfRange, [&](Arena& arena) { return Water::make(wrong, arena, &water); });
  wrong.width = 1024;
  fails_with(Status::kOutOfMemory, [&](Arena& arena) { return Water::make(wrong, arena, &water); });
  const std::uint8_t blocked[3] = {};
  wrong = config;
  wrong.blocked = {blocked, 3};
  fails_with(Status::kBadArgument, [&](Arena& arena) { return Water::make(wrong, arena, &water); });
  CHECK(water.depth() == 8);
}

TEST_CASE("arena: an octree") {
  Octree octree;
  takes_exactly(Octree::octree_bytes(100),
                [&](Arena& arena) { return Octree::make(5, 100, arena, &octree); });
  CHECK(octree.capacity() == 100);
  Arena nothing;  // holds a pool of no nodes
  CHECK(Octree::make(5, 0, nothing, &octree) == Status::kOk);
  CHECK(octree.capacity() == 0);
  fails_with(Status::kOutOfRange, [&](Arena& arena) { return Octree::make(13, 100, arena, &octree); });
  fails_with(Status::kOutOfMemory, [&](Arena& arena) { return Octree::make(5, 1 << 20, arena, &octree); });
  fails_with(Status::kOutOfMemory, [&](Arena& arena) { return Octree::make(5, SIZE_MAX, arena, &octree); });
  CHECK(octree.level() == 5);
}

TEST_CASE("arena: a compact tree") {
  alignas(8) std::uint8_t memory[4096];
  Octree octree;
  REQUIRE(Octree::make(4, Bytes(memory), &octree) == Status::kOk);
  for (std::int32_t i = 0; i < 16; ++i) {
    REQUIRE(octree.insert({i, i * 7 % 16, i * 5 % 16}, static_cast<std::uint8_t>(i % 3)) == Status::kOk);
  }
  CompactTree tree;
  takes_exactly(compact_bytes(compact_shape(octree)),
                [&](Arena& arena) { return CompactTree::make(octree, arena, &tree); });
  CHECK(tree.voxel_count() == 16);
  takes_exactly(compact_bytes(compact_shape(octree, 3)),
                [&](Arena& arena) { return CompactTree::make(octree, arena, nullptr, 3); });
  for (const int rank_shift : {-1, 2, 11, 64}) {
    fails_with(Status::kOutOfRange,
               [&](Arena& arena) { return CompactTree::make(octree, arena, &tree, rank_shift); });
  }
  CHECK(tree.rank_shift() == kDefaultRankShift);
}
