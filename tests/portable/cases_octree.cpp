// The octree that changes: what is in it, how many nodes it has, what a full pool does, what merging does.
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/base/memory.h"

namespace thimble::portable {
namespace {

constexpr uint32_t pool_bytes(uint32_t nodes) {
  return (8 * nodes + 3 + 7) & ~7U;
}

// The pool's bytes as they are, to see that nothing was written.
uint32_t pool_crc(Check& check) {
  return thimble::crc32(
      ConstBytes(check.arena.rest().data - check.arena.used_bytes(), check.arena.used_bytes()));
}

// The same voxels in the pool and in a bit grid: all of a small world compared.
void expect_same_as_grid(Check& check) {
  const int32_t side = int32_t{1} << check.world.pool.level();
  uint32_t solid = 0;
  bool same = true;
  for (int32_t i = 0; i < side * side * side; ++i) {
    const Vec3i at{i % side, i / side % side, i / side / side};
    same = same && check.world.pool.test(at) == check.world.grid.test(at);
    solid += check.world.grid.test(at) ? 1U : 0U;
  }
  THIMBLE_CHECK(same);
  THIMBLE_EQUAL(check.world.pool.voxels(), solid);
}

// Random insertions, removals and blocks, with a bit grid as the judge.
void random_edits(Check& check, int level) {
  const int32_t side = int32_t{1} << level;
  THIMBLE_REQUIRE(make_grid(check, {side, side, side}));
  THIMBLE_REQUIRE(make_pool(check, level == 3 ? 200U : 73U, level));
  Random random{static_cast<uint32_t>(100 + level)};
  for (int i = 0; i < 200; ++i) {
    const Vec3i at = random.vector(side);
    const int32_t what = random.below(10);
    if (what < 6) {
      THIMBLE_REQUIRE_OK(check.world.pool.insert(at, static_cast<uint8_t>(i % 3)));
      THIMBLE_REQUIRE_OK(check.world.grid.set(at));
    } else if (what < 9) {
      THIMBLE_REQUIRE_OK(check.world.pool.remove(at));
      THIMBLE_REQUIRE_OK(check.world.grid.set(at, false));
    } else {
      const Vec3i corner{at.x & ~1, at.y & ~1, at.z & ~1};
      THIMBLE_REQUIRE_OK(check.world.pool.insert_block(corner, 1, 2));
      for (int32_t octant = 0; octant < 8; ++octant) {
        THIMBLE_REQUIRE_OK(check.world.grid.set(
            {corner.x + (octant & 1), corner.y + (octant >> 1 & 1), corner.z + (octant >> 2)}));
      }
    }
    if (i % 20 == 0) {
      expect_same_as_grid(check);
    }
    check.note(check.world.pool.nodes_used());
  }
  expect_same_as_grid(check);
}

// A world filled voxel by voxel, in Morton order or in an order that jumps about.
void fill_voxel_by_voxel(Check& check, int stride) {
  THIMBLE_REQUIRE(make_pool(check, 73, 3));  // a node for each 2 x 2 x 2 at the most
  Octree& pool = check.world.pool;
  for (int32_t i = 0; i < 512; ++i) {
    const int32_t place = i * stride % 512;
    THIMBLE_REQUIRE_OK(pool.insert({place % 8, place / 8 % 8, place / 64}, 9));
  }
  THIMBLE_EQUAL(pool.nodes_used(), 1U);
  THIMBLE_EQUAL(pool.voxels(), 512U);
  THIMBLE_CHECK(pool.node(pool.root()).solid());
  THIMBLE_EQUAL(pool.node(pool.root()).material, 9);
}

// Every pool from no node to one too few: an insertion that does not fit is refused and changes no byte.
void full_pool(Check& check, int) {
  for (uint32_t nodes = 0; nodes < 12; ++nodes) {
    check.arena.rewind(0);
    THIMBLE_REQUIRE(make_pool(check, nodes, 4));
    Octree& pool = check.world.pool;
    bool refused = false;
    for (int32_t i = 0; i < 6; ++i) {
      const uint32_t used = pool.nodes_used();
      const uint64_t voxels = pool.voxels();
      const uint32_t before = pool_crc(check);
      const Status status = pool.insert({(i * 7) % 16, (i * 5) % 16, i}, 1);
      THIMBLE_CHECK(status == Status::kOk || status == Status::kOutOfMemory);
      if (status == Status::kOutOfMemory) {
        refused = true;
        THIMBLE_EQUAL(pool.nodes_used(), used);
        THIMBLE_EQUAL(pool.voxels(), voxels);
        THIMBLE_EQUAL(pool_crc(check) == before, true);
        THIMBLE_CHECK(!pool.test({(i * 7) % 16, (i * 5) % 16, i}));
      }
      check.note(pool.nodes_used());
    }
    THIMBLE_CHECK(refused);
  }
}

void streaming(Check& check, int nodes) {
  THIMBLE_REQUIRE(make_pool(check, static_cast<uint32_t>(nodes), 6));
  Octree& pool = check.world.pool;
  pool.set_coarsen(true);
  Random random{31};
  for (int i = 0; i < 200; ++i) {
    const Vec3i at{random.below(64), random.below(64), random.below(16)};
    THIMBLE_REQUIRE_OK(pool.insert(at, static_cast<uint8_t>(i % 5)));
    THIMBLE_REQUIRE(pool.test(at));
  }
  Random again{31};
  for (int i = 0; i < 200; ++i) {
    const Vec3i at{again.below(64), again.below(64), again.below(16)};
    THIMBLE_CHECK(pool.test(at));
  }
  THIMBLE_CHECK(pool.nodes_used() <= static_cast<uint32_t>(nodes));
  check.note(static_cast<int64_t>(pool.voxels()));
  check.note(static_cast<int64_t>(pool.solid_added()));
}

void insert_box_of(Check& check, int index) {
  constexpr VoxelBox kBoxes[] = {{{0, 0, 0}, {8, 8, 8}}, {{1, 2, 3}, {7, 6, 5}}, {{0, 0, 0}, {1, 1, 8}},
                                 {{3, 3, 3}, {4, 4, 4}}, {{0, 4, 0}, {8, 8, 8}}, {{2, 2, 2}, {2, 5, 5}}};
  const VoxelBox& box = kBoxes[index];
  THIMBLE_REQUIRE(make_grid(check, {8, 8, 8}));
  THIMBLE_REQUIRE(make_pool(check, 300, 3));
  THIMBLE_REQUIRE_OK(check.world.pool.insert_box(box, 1));
  for (int32_t z = box.low.z; z < box.high.z; ++z) {
    for (int32_t y = box.low.y; y < box.high.y; ++y) {
      for (int32_t x = box.low.x; x < box.high.x; ++x) {
        THIMBLE_REQUIRE_OK(check.world.grid.set({x, y, z}));
      }
    }
  }
  expect_same_as_grid(check);
  check.note(check.world.pool.nodes_used());
  if (!box.empty()) {
    THIMBLE_EQUAL(check.world.pool.bounds(), box);
  }
}

void outside(Check& check, int axis) {
  THIMBLE_REQUIRE(make_pool(check, 40, 3));
  Octree& pool = check.world.pool;
  constexpr int32_t kBeyonds[] = {-1, 8, INT32_MIN, INT32_MAX};
  for (const int32_t beyond : kBeyonds) {
    Vec3i at{1, 1, 1};
    at[axis] = beyond;
    THIMBLE_EQUAL(pool.insert(at), Status::kOutOfRange);
    THIMBLE_EQUAL(pool.remove(at), Status::kOutOfRange);
    THIMBLE_EQUAL(pool.insert_block(at, 1, 0), Status::kOutOfRange);
    THIMBLE_CHECK(!pool.test(at));
    THIMBLE_EQUAL(pool.material(at), -1);
  }
  THIMBLE_CHECK(pool.empty());
}

constexpr Case kCases[] = {
    {"octree_bytes: any number of nodes -> 8 a node and the slack of an address", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(Octree::octree_bytes(0), 3U);
       THIMBLE_EQUAL(Octree::octree_bytes(100), 803U);
       THIMBLE_CHECK(Octree::octree_bytes(SIZE_MAX / 2) == SIZE_MAX);
     }},
    {"init: levels 0 and 13 -> out of range", 64,
     [](Check& check, int) {
       const Bytes bytes = check.arena.take(64);
       THIMBLE_EQUAL(Octree::make(0, bytes, &check.world.pool), Status::kOutOfRange);
       THIMBLE_EQUAL(Octree::make(13, bytes, &check.world.pool), Status::kOutOfRange);
       THIMBLE_EQUAL(Octree::make(12, bytes, &check.world.pool), Status::kOk);
     }},
    {"init: bytes at odd addresses -> as many nodes as fit behind the padding", 80,
     [](Check& check, int) {
       const Bytes bytes = check.arena.take(80);
       for (size_t offset = 0; offset < 8; ++offset) {
         THIMBLE_REQUIRE_OK(Octree::make(3, bytes.subspan(offset, 40), &check.world.pool));
         THIMBLE_EQUAL(check.world.pool.capacity(), offset % 4 == 0 ? 5U : 4U);
       }
     }},
    {"never initialised -> nothing can be inserted", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(check.world.pool.insert({0, 0, 0}), Status::kOutOfMemory);
       THIMBLE_CHECK(check.world.pool.empty());
     }},
    {"an empty tree -> no root, no voxel, no node", 64,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 5, 3));
       THIMBLE_EQUAL(check.world.pool.root(), Octree::kNone);
       THIMBLE_EQUAL(check.world.pool.nodes_used(), 0U);
       THIMBLE_EQUAL(check.world.pool.nodes_free(), 5U);
       THIMBLE_EQUAL(check.world.pool.voxels(), 0U);
       THIMBLE_CHECK(check.world.pool.bounds().empty());
       THIMBLE_CHECK(!check.world.pool.test({0, 0, 0}));
     }},
    {"a node's index that never was -> a solid view without children", 64,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 5, 3));
       THIMBLE_CHECK(check.world.pool.node(4).solid());
       THIMBLE_EQUAL(check.world.pool.node(Octree::kNone).first_child, Octree::kNone);
     }},
    {"a full world voxel by voxel -> one node", pool_bytes(73), fill_voxel_by_voxel, 1, "in order"},
    {"a full world voxel by voxel -> one node", pool_bytes(73), fill_voxel_by_voxel, 37, "in leaps"},
    {"random edits -> what a bit grid holds, at every step", pool_bytes(73) + 64, random_edits, 2,
     "world of 4"},
    {"random edits -> what a bit grid holds, at every step", pool_bytes(200) + 64, random_edits, 3,
     "world of 8"},
    {"a pool that is too small -> out of memory, not a byte changed", pool_bytes(12), full_pool},
    {"insert_block: corner no multiple of the side -> bad argument", 64,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 5, 3));
       THIMBLE_EQUAL(check.world.pool.insert_block({2, 0, 0}, 2, 0), Status::kBadArgument);
       THIMBLE_EQUAL(check.world.pool.insert_block({0, 0, 1}, 1, 0), Status::kBadArgument);
       THIMBLE_CHECK(check.world.pool.empty());
     }},
    {"insert_block: larger than the world, or negative -> out of range", 64,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 5, 3));
       THIMBLE_EQUAL(check.world.pool.insert_block({0, 0, 0}, 4, 0), Status::kOutOfRange);
       THIMBLE_EQUAL(check.world.pool.insert_block({0, 0, 0}, -1, 0), Status::kOutOfRange);
       THIMBLE_CHECK(check.world.pool.empty());
     }},
    {"insert_box -> the voxels of the box and no other", pool_bytes(300) + 64, insert_box_of, 0, "box", 6},
    {"insert_box: leaving the world -> out of range, nothing changes", 64,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 1, 12));
       Octree& pool = check.world.pool;
       THIMBLE_EQUAL(pool.insert_box({{0, 0, 0}, {4096, 4096, 4097}}, 1), Status::kOutOfRange);
       THIMBLE_EQUAL(pool.insert_box({{-1, 0, 0}, {4, 4, 4}}, 1), Status::kOutOfRange);
       THIMBLE_CHECK(pool.empty());
     }},
    {"insert_box: the largest world -> one node of 2^36 voxels", 64,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 1, 12));
       THIMBLE_REQUIRE_OK(check.world.pool.insert_box({{0, 0, 0}, {4096, 4096, 4096}}, 1));
       THIMBLE_EQUAL(check.world.pool.voxels(), uint64_t{1} << 36);
       THIMBLE_EQUAL(check.world.pool.nodes_used(), 1U);
     }},
    {"insert_all -> as many as came before the first that failed", pool_bytes(20),
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 20, 3));
       const Voxel voxels[] = {{{1, 1, 1}, 0}, {{2, 2, 2}, 0}, {{8, 0, 0}, 0}, {{3, 3, 3}, 0}};
       size_t inserted = 9;
       THIMBLE_EQUAL(check.world.pool.insert_all(voxels, inserted), Status::kOutOfRange);
       THIMBLE_EQUAL(inserted, 2U);
       THIMBLE_EQUAL(check.world.pool.voxels(), 2U);
     }},
    {"outside the world -> out of range, and not solid", pool_bytes(40), outside, 0, "axis", 3},
    {"everything removed and inserted again -> the pool does not grow", pool_bytes(200),
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 200, 4));
       Octree& pool = check.world.pool;
       uint32_t high_water = 0;
       for (int round = 0; round < 4; ++round) {
         for (int32_t i = 0; i < 30; ++i) {
           THIMBLE_REQUIRE_OK(pool.insert({(i * 7) % 16, (i * 3) % 16, (i * 5) % 16}, 1));
         }
         high_water = round == 0 ? pool.nodes_high_water() : high_water;
         for (int32_t i = 0; i < 30; ++i) {
           THIMBLE_REQUIRE_OK(pool.remove({(i * 7) % 16, (i * 3) % 16, (i * 5) % 16}));
         }
         THIMBLE_EQUAL(pool.nodes_used(), 0U);
       }
       THIMBLE_EQUAL(pool.nodes_high_water(), high_water);
     }},
    {"clear -> as new", 64,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 5, 3));
       THIMBLE_REQUIRE_OK(check.world.pool.insert({7, 7, 7}, 1));
       check.world.pool.clear();
       THIMBLE_CHECK(check.world.pool.empty());
       THIMBLE_EQUAL(check.world.pool.nodes_high_water(), 0U);
       THIMBLE_CHECK(check.world.pool.bounds().empty());
     }},
    {"bounds: after removal -> still hold everything", 128,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 12, 4));
       Octree& pool = check.world.pool;
       THIMBLE_REQUIRE_OK(pool.insert({2, 3, 4}, 1));
       THIMBLE_REQUIRE_OK(pool.insert({9, 3, 11}, 1));
       THIMBLE_EQUAL(pool.bounds(), (VoxelBox{{2, 3, 4}, {10, 4, 12}}));
       THIMBLE_REQUIRE_OK(pool.remove({9, 3, 11}));
       THIMBLE_CHECK(pool.bounds().low == (Vec3i{2, 3, 4}) && pool.bounds().high.x >= 3);
     }},
    {"the largest world, a voxel in each corner -> exact", pool_bytes(96),
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 96, 12));
       Octree& pool = check.world.pool;
       for (int32_t corner = 0; corner < 8; ++corner) {
         THIMBLE_REQUIRE_OK(pool.insert({(corner & 1) * 4095, (corner >> 1 & 1) * 4095, (corner >> 2) * 4095},
                                        static_cast<uint8_t>(corner)));
       }
       THIMBLE_EQUAL(pool.nodes_used(), 89U);
       THIMBLE_EQUAL(pool.material({4095, 0, 4095}), 5);
       THIMBLE_EQUAL(pool.material({4095, 0, 4094}), -1);
     }},

    {"coarsen: to no node -> out of memory, unchanged", 64,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 5, 3));
       THIMBLE_REQUIRE_OK(check.world.pool.coarsen_to(0));
       THIMBLE_REQUIRE_OK(check.world.pool.insert({7, 7, 7}, 1));
       THIMBLE_EQUAL(check.world.pool.coarsen_to(0), Status::kOutOfMemory);
       THIMBLE_EQUAL(check.world.pool.nodes_used(), 3U);
     }},
    {"coarsen: make_room of what is free -> nothing happens", pool_bytes(12),
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 12, 3));
       THIMBLE_REQUIRE_OK(check.world.pool.insert({7, 7, 7}, 1));
       THIMBLE_REQUIRE_OK(check.world.pool.make_room(9));
       THIMBLE_EQUAL(check.world.pool.nodes_used(), 3U);
       THIMBLE_REQUIRE_OK(check.world.pool.make_room(10));
       THIMBLE_CHECK(check.world.pool.nodes_used() <= 2);
       THIMBLE_EQUAL(check.world.pool.make_room(12), Status::kOutOfMemory);
     }},
    {"a merged block: a voxel removed -> merged blocks around it, single voxels beside it", pool_bytes(30),
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 30, 3));
       Octree& pool = check.world.pool;
       THIMBLE_REQUIRE_OK(pool.insert({0, 0, 0}, 3));
       THIMBLE_REQUIRE_OK(pool.insert({7, 7, 7}, 4));
       THIMBLE_REQUIRE_OK(pool.coarsen_to(1));
       THIMBLE_REQUIRE_OK(pool.remove({0, 0, 0}));
       THIMBLE_EQUAL(pool.voxels(), 511U);
       THIMBLE_EQUAL(pool.solid_added(), 510U);
       const Octree::NodeView root = pool.node(pool.root());
       THIMBLE_CHECK(pool.node(pool.child(root, 7)).merged);
       const Octree::NodeView low = pool.node(pool.child(root, 0));
       THIMBLE_CHECK(pool.node(pool.child(low, 1)).merged);
       THIMBLE_EQUAL(pool.node(pool.child(low, 0)).mask, 254);
       THIMBLE_CHECK(!pool.node(pool.child(low, 0)).merged);
     }},
    {"coarsening pool of no node -> out of memory", 8,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 0, 12));
       check.world.pool.set_coarsen(true);
       THIMBLE_EQUAL(check.world.pool.insert({1, 2, 3}, 4), Status::kOutOfMemory);
       THIMBLE_CHECK(check.world.pool.empty());
     }},
    {"coarsening pool of one node -> the whole world", 16,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 1, 12));
       check.world.pool.set_coarsen(true);
       THIMBLE_REQUIRE_OK(check.world.pool.insert({1, 2, 3}, 4));
       THIMBLE_EQUAL(check.world.pool.solid_added(), (uint64_t{1} << 36) - 1);
       THIMBLE_EQUAL(check.world.pool.material({4095, 4095, 4095}), 4);
     }},
    {"coarsening pool of three nodes -> a block two levels down", 32,
     [](Check& check, int) {
       THIMBLE_REQUIRE(make_pool(check, 3, 12));
       check.world.pool.set_coarsen(true);
       THIMBLE_REQUIRE_OK(check.world.pool.insert({1, 2, 3}, 4));
       THIMBLE_EQUAL(check.world.pool.voxels(), uint64_t{1} << 30);
     }},
    {"streaming into a full pool -> every voxel solid, the same tree everywhere", pool_bytes(7), streaming, 7,
     "7 nodes"},
    {"streaming into a full pool -> every voxel solid, the same tree everywhere", pool_bytes(40), streaming,
     40, "40 nodes"},
    {"streaming into a full pool -> every voxel solid, the same tree everywhere", pool_bytes(500), streaming,
     500, "500 nodes"},
    {"coarsen_at: a higher price -> never more nodes, as many as nodes_at foretold", pool_bytes(120),
     [](Check& check, int) {
       uint32_t before = UINT32_MAX;
       for (int step = 60; step < Octree::kPriceSteps; step += 16) {
         check.arena.rewind(0);
         THIMBLE_REQUIRE(make_pool(check, 120, 5));
         Octree& pool = check.world.pool;
         Random random{9};
         for (int i = 0; i < 20; ++i) {
           THIMBLE_REQUIRE_OK(pool.insert(random.vector(32), 0));
         }
         const uint32_t foretold = pool.nodes_at(step);
         THIMBLE_CHECK(foretold <= before);
         before = foretold;
         pool.coarsen_at(step);
         THIMBLE_EQUAL(pool.nodes_used(), foretold);
       }
       THIMBLE_EQUAL(before, 1U);
     }},
};

}  // namespace

const Group kOctreeGroup = group_of<kCases>("octree", "cases_octree.cpp");

}  // namespace thimble::portable
