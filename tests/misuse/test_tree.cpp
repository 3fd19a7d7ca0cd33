// Every public function of base and tree with arguments that nobody means: refused, or done, and inside the
// bytes.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "misuse/odd_worlds.h"
#include "support/counts.h"
#include "thimble/base/memory.h"
#include "thimble/light/map_render.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/edited_world.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// Calls everything that views of nodes have, whatever its bytes hold.
template <class Tree>
void ask(const Tree& tree) {
  (void)tree.level();
  (void)tree.voxel_count();
  (void)tree.solid_added();
  (void)tree.bounds();
  (void)tree.uniform_material();
}

void ask_nodes(OddValues& odd, const CompactTree& tree) {
  ask(tree);
  for (int i = 0; i < 8 && tree.node_count() != 0; ++i) {
    const auto index = static_cast<std::uint32_t>(odd.between(0, std::int64_t{tree.node_count()} - 1));
    (void)tree.mask(index);
    (void)tree.first_child(index);
    (void)tree.is_merged(index);
    (void)tree.block_material(index);
    (void)tree.blocks_before(index);
    (void)tree.material_of_block(odd.any<std::uint32_t>());
    (void)tree.voxel_material(odd.any<std::uint32_t>());
  }
}

void ask_nodes(OddValues& odd, const SharedTree& tree) {
  ask(tree);
  (void)tree.bytes_with_materials();
  std::uint32_t node = tree.root();
  for (int i = 0; i < 16; ++i) {
    (void)tree.material(odd.any_vector());
    std::uint8_t mask = 0;
    if (!tree.load(odd.one_in(4) ? odd.any<std::uint32_t>() : node, &mask)) {
      node = tree.root();
      continue;
    }
    if (mask != 0 && (node & SharedTree::kInline) == 0) {
      const auto octant = static_cast<unsigned>(odd.bits() % 8);
      node = (std::uint32_t{mask} >> octant & 1U) != 0 ? tree.child(node, mask, octant) : tree.root();
    }
  }
}

// Calls everything that a map has, whatever its bytes hold.
void ask_map(OddValues& odd, const BrickMap& map, const CompactTree& tree) {
  (void)map.belongs_to(tree);
  (void)map.box();
  for (int i = 0; i < 8 && map.brick_count() > 1; ++i) {
    (void)map.material(tree, static_cast<std::uint32_t>(odd.between(1, std::int64_t{map.brick_count()} - 1)),
                       static_cast<unsigned>(odd.bits() % 64));
  }
}

// Changes an octree with anything, in a pool of any size.
void change(OddValues& odd, Octree& octree) {
  const std::int32_t side = std::int32_t{1} << octree.level();
  const auto place = [&] { return odd.one_in(3) ? odd.any_vector() : odd.vector_between(0, side - 1); };
  const std::uint64_t before = octree.voxels();
  Status status = Status::kOk;
  switch (odd.bits() % 11) {
    case 0:
      octree.clear();
      CHECK(octree.empty());
      return;
    case 1:
      octree.set_coarsen(odd.one_in(2));
      return;
    case 2:
    case 3:
      status = octree.insert(place(), odd.any<std::uint8_t>());
      break;
    case 4:
      status = octree.insert_block(place(), odd.any<std::int32_t>() % 16, odd.any<std::uint8_t>());
      break;
    case 5: {
      const int level = odd.between_32(0, octree.level());
      Vec3i corner = odd.vector_between(0, side - 1);
      for (int axis = 0; axis < 3; ++axis) {
        corner[axis] = corner[axis] >> level << level;
      }
      status = octree.insert_block(corner, level, odd.any<std::uint8_t>());
      break;
    }
    case 6: {
      // Boxes that leave the world, and small ones: a large one takes time in proportion to its surface.
      VoxelBox box{place(), place()};
      if (octree.level() > 6) {
        for (int axis = 0; axis < 3; ++axis) {
          if (box.low[axis] >= 0 && box.low[axis] < side && box.high[axis] > box.low[axis]) {
            box.high[axis] = std::min(box.high[axis], box.low[axis] + 20);
          }
        }
      }
      (void)octree.insert_box(box, odd.any<std::uint8_t>());
      return;
    }
    case 7:
      status = octree.remove(place());
      break;
    case 8:
      (void)octree.make_room(odd.any<std::size_t>());
      return;
    case 9:
      (void)octree.coarsen_to(odd.any<std::size_t>());
      return;
    default:
      (void)octree.nodes_at(odd.any<std::int32_t>());
      octree.coarsen_at(odd.any<std::int32_t>());
      return;
  }
  if (status == Status::kOutOfRange || status == Status::kBadArgument) {
    CHECK(octree.voxels() == before);
  }
}

}  // namespace

TEST_CASE("misuse: dense grid -> refused or done, inside its bytes") {
  misuse(1, 4000, [](OddValues& odd) {
    const Vec3i size = odd.one_in(3) ? odd.any_vector() : odd.vector_between(-1, 40);
    HeapBytes bytes(odd_size(odd, dense_grid_bytes(size)));
    DenseGrid grid;
    const Status status = DenseGrid::make(size, bytes.span(), &grid);
    CHECK((status == Status::kOk) ==
          (dense_grid_bytes(size) != 0 && bytes.span().size >= dense_grid_bytes(size)));
    for (int i = 0; i < 8; ++i) {
      const Vec3i at = odd.one_in(2) ? odd.any_vector() : odd.vector_between(-1, 40);
      const Status set = grid.set(at, odd.one_in(2));
      CHECK((set == Status::kOk) == grid.contains(at));
      (void)grid.test(at);
    }
  });
}

TEST_CASE("misuse: octree -> refused or done, inside its pool, and its compact tree is sound") {
  misuse(2, 1500, [](OddValues& odd) {
    const int level = odd.any_or(4, kMinLevel, kMaxLevel);
    const std::size_t nodes = odd.one_in(4) ? 0 : odd.bits() % 400;
    HeapBytes pool(odd_size(odd, Octree::octree_bytes(nodes)));
    Octree octree;
    const Status status = Octree::make(level, pool.span(), &octree);
    CHECK((status == Status::kOk) == (level >= kMinLevel && level <= kMaxLevel));
    for (int i = 0; i < 60; ++i) {
      change(odd, octree);
      CHECK(octree.nodes_used() <= octree.capacity());
      (void)octree.test(odd.any_vector());
      (void)octree.material(odd.any_vector());
      const Octree::NodeView node = octree.node(odd.one_in(2) ? odd.any<std::uint32_t>() : octree.root());
      if (!octree.empty()) {
        (void)octree.child(node, static_cast<int>(odd.bits() % 8));
      }
    }
    const int shift = odd.any_or(3, kMinRankShift, kMaxRankShift);
    std::size_t size = 0;
    HeapBytes none;
    CompactTree tree;
    if (CompactTree::make(octree, none.span(), nullptr, &size, shift) == Status::kOutOfRange) {
      CHECK((shift < kMinRankShift || shift > kMaxRankShift));
      return;
    }
    HeapBytes out(odd_size(odd, size));
    const Status made = CompactTree::make(octree, out.span(), &tree, &size, shift);
    CHECK((made == Status::kOk) == (out.span().size >= size));
    if (made == Status::kOk) {
      CHECK(CompactTree::validate(out.span()) == nullptr);
      CHECK(tree.voxel_count() == octree.voxels());
      ask_nodes(odd, tree);
    }
  });
}

TEST_CASE("misuse: a pool that something else wrote over -> no read or write outside it") {
  misuse(3, 600, [](OddValues& odd) {
    HeapBytes pool(Octree::octree_bytes(1 + odd.bits() % 200));
    Octree octree;
    REQUIRE(Octree::make(odd.between_32(kMinLevel, 6), pool.span(), &octree) == Status::kOk);
    for (int i = 0; i < 40; ++i) {
      change(odd, octree);
    }
    for (int i = 0; i < 8; ++i) {
      pool.span()[odd.bits() % pool.span().size] = odd.any<std::uint8_t>();
    }
    // Reading alone is promised to stay inside (law 4 is about what is baked; a pool belongs to its program).
    for (int i = 0; i < 50; ++i) {
      (void)octree.node(odd.any<std::uint32_t>());
    }
  });
}

TEST_CASE("misuse: keys and parts to compact trees -> refused or done, inside their bytes") {
  misuse(4, 1500, [](OddValues& odd) {
    const int level = odd.any_or(6, kMinLevel, 10);
    const int bits = level >= 1 && level <= 10 ? 3 * level : 30;
    std::vector<std::uint32_t> keys(odd.bits() % 60);
    for (std::uint32_t& key : keys) {
      key = static_cast<std::uint32_t>(odd.bits() & ((std::uint64_t{1} << bits) - 1));
    }
    sort_keys(Span<std::uint32_t>(keys.data(), keys.size()), bits);
    CHECK(std::is_sorted(keys.begin(), keys.end()));
    keys.resize(unique_keys(Span<std::uint32_t>(keys.data(), keys.size())));
    std::size_t size = 0;
    HeapBytes none;
    const int shift = odd.any_or(6, kMinRankShift, kMaxRankShift);
    const Span<const std::uint32_t> span(keys.data(), keys.size());
    if (CompactTree::make(span, level, odd.any<std::uint8_t>(), none.span(), nullptr, &size, shift) !=
        Status::kOutOfMemory) {
      return;
    }
    HeapBytes out(odd_size(odd, size));
    CompactTree tree;
    const Status made =
        CompactTree::make(span, level, odd.any<std::uint8_t>(), out.span(), &tree, &size, shift);
    CHECK((made == Status::kOk) == (out.span().size >= size));
    if (made != Status::kOk) {
      return;
    }
    CHECK(tree.voxel_count() == keys.size());
    std::vector<CompactTree> parts(odd.one_in(3) ? odd.bits() % 70 : 8, tree);
    if (!parts.empty() && odd.one_in(3)) {
      parts[odd.bits() % parts.size()] = CompactTree();
    }
    HeapBytes joined(odd_size(odd, size * parts.size() + 4096));
    CompactTree whole;
    if (CompactTree::make(Span<const CompactTree>(parts.data(), parts.size()), joined.span(), &whole,
                          &size) == Status::kOk) {
      CHECK(CompactTree::validate(joined.span()) == nullptr);
    }
  });
}

TEST_CASE("misuse: damaged compact, shared and brick bytes -> opened or refused, never read beyond") {
  OwnedPool pool(5);
  Octree& octree = pool.octree;
  OddValues odd_scene(5);
  for (int i = 0; i < 300; ++i) {
    REQUIRE(octree.insert(odd_scene.vector_between(0, 31), static_cast<std::uint8_t>(i % 3)) == Status::kOk);
  }
  REQUIRE(octree.insert_block({16, 0, 8}, 3, 2) == Status::kOk);
  const HeapBytes compact = compact_of(octree);
  const CompactTree tree = open_or_throw(compact);
  const CompactShape shape = compact_shape(octree);
  const HeapBytes shared_bytes = shared_of(tree);
  const HeapBytes map_bytes = map_of(tree);

  misuse(6, 4000, [&](OddValues& odd) {
    const HeapBytes bad = damaged(odd, compact.view());
    std::uint32_t place = 0;
    (void)CompactTree::validate(bad.span(), odd.one_in(2) ? &place : nullptr);
    CompactTree opened;
    if (CompactTree::open(bad.span(), &opened) == Status::kOk) {
      ask_nodes(odd, opened);
      // Whatever is made of it stays inside its bytes too.
      HeapBytes out(odd_size(odd, shared_tree_bytes(shape)));
      HeapBytes scratch(odd_size(odd, shared_work_bytes(opened.node_count())));
      SharedTree second;
      if (SharedTree::make(opened, out.span(), scratch.span(), &second) == Status::kOk) {
        ask_nodes(odd, second);
      }
      HeapBytes bricks(
          odd_size(odd, opened.level() <= kMaxBrickMapLevel && opened.level() >= kMinBrickMapLevel
                            ? most_brick_map_bytes(opened.level())
                            : 64));
      BrickMap made;
      if (BrickMap::make(opened, bricks.span(), &made) == Status::kOk) {
        CHECK(made.belongs_to(opened));
      }
    }
    const HeapBytes bad_shared = damaged(odd, shared_bytes.view());
    HeapBytes check(odd_size(odd, shared_check_bytes(bad_shared.span().size)));
    (void)SharedTree::validate(bad_shared.span(), check.span(), odd.one_in(2) ? &place : nullptr);
    SharedTree opened_shared;
    if (SharedTree::open(bad_shared.span(), &opened_shared) == Status::kOk) {
      ask_nodes(odd, opened_shared);
    }
    const HeapBytes bad_map = damaged(odd, map_bytes.view());
    (void)BrickMap::validate(bad_map.span());
    BrickMap opened_map;
    if (BrickMap::open(bad_map.span(), &opened_map) == Status::kOk) {
      ask_map(odd, opened_map, tree);
    }
    (void)crc32(bad.span(), odd.any<std::uint32_t>());
    (void)morton_voxel(odd.any<std::uint64_t>());
    (void)morton_code(odd.any<std::uint32_t>(), odd.any<std::uint32_t>(), odd.any<std::uint32_t>());
  });
}

/// A world of any room, edited with anything; of a damaged tree, too. What it then holds can be packed.
void edit_at_random(OddValues& odd, const CompactTree& tree) {
  EditRoom room = EditedWorld::room_of(tree);
  for (std::uint32_t* const part : {&room.nodes, &room.leaves, &room.bricks, &room.pages}) {
    *part += odd.one_in(20) ? odd.any<std::uint32_t>() : static_cast<std::uint32_t>(odd.between_32(0, 40));
  }
  const std::size_t wanted = edited_world_bytes(tree.level(), room);
  if (wanted > std::size_t{1} << 24) {
    return;
  }
  HeapBytes bytes(odd.one_in(8) ? odd_size(odd, wanted) : wanted);
  EditedWorld world;
  if (EditedWorld::make(tree, room, bytes.span(), &world) != Status::kOk) {
    CHECK(world.empty());
    return;
  }
  const Vec3i towards{odd.between_32(-9, 9), odd.between_32(-9, 9), odd.between_32(1, 9)};
  HeapBytes bits(SunBricks::bytes(world.map()));
  SunBricks sun;
  (void)SunBricks::make(world.map(), towards, bits.span(), &sun);
  HeapBytes entries(odd.bits() % 3000);
  EditJournal journal(entries.span());
  const auto number = [&] { return odd.any_or(9, 0, (1 << tree.level()) - 1); };
  for (int edit = 0; edit < 12; ++edit) {
    const Vec3i at{number(), number(), number()};
    const auto side = [&] { return odd.any_or(9, -1, 7); };
    const auto plus = [](std::int32_t a, std::int32_t b) {
      return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
    };
    const Vec3i to{plus(at.x, side()), plus(at.y, 5), plus(at.z, 3)};
    (void)world.set(at, odd.any<std::uint8_t>());
    (void)world.clear({number(), number(), number()});
    (void)world.edit({at, to}, odd.one_in(2) ? EditShape::kBox : EditShape::kBall, odd.between_32(-2, 257),
                     &journal);
    if (odd.one_in(3)) {
      (void)world.undo(&journal);
    }
    if (odd.one_in(3)) {
      (void)sun.follow(world, odd.one_in(9) ? odd.any<std::uint32_t>()
                                            : static_cast<std::uint32_t>(odd.between_32(0, 600)));
    }
    if (odd.one_in(4)) {  // at the wrong time, too
      world.forget_changes();
    }
  }
  while (sun.follow(world, 5000)) {
  }
  if (sun.belongs_to(world.map(), towards)) {
    HeapBytes fresh_bits(bits.span().size);
    SunBricks fresh;
    REQUIRE(SunBricks::make(world.map(), towards, fresh_bits.span(), &fresh) == Status::kOk);
    (void)fresh.prove();
    CHECK(std::memcmp(bits.span().data, fresh_bits.span().data, bits.span().size) == 0);
  }
  const HeapBytes bytes_of_it = packed(world);
  CHECK(CompactTree::validate(bytes_of_it.view()) == nullptr);
}

TEST_CASE(
    "misuse: maps of level 9 and 10 of sound and damaged trees -> made, opened or refused, in their bytes") {
  int made_of_damaged = 0;
  int opened_damaged = 0;
  misuse(7, many_or_few(400, 150), [&](OddValues& odd) {
    const OddDeepWorld world(odd);
    const std::size_t size = world.map_bytes.span().size;
    // Room to the byte.
    HeapBytes room(odd_size(odd, size));
    const bool is_odd = odd.one_in(8);
    const Bytes out = room.span().subspan(is_odd ? 1 : 0);
    BrickMap map;
    std::size_t written = 77;
    const Status status = BrickMap::make(world.compact, out, odd.one_in(4) ? nullptr : &map, &written);
    CHECK(status == (is_odd && !out.empty() ? Status::kBadArgument
                     : out.size < size      ? Status::kOutOfMemory
                                            : Status::kOk));
    CHECK(written == (status == Status::kOk ? size : 77));
    if (status == Status::kOk) {
      CHECK(std::equal(out.begin(), out.begin() + size, world.map_bytes.span().begin()));
      ask_map(odd, world.map, world.compact);
    } else {
      CHECK(map.directory() == nullptr);
    }
    EditedWorld edited;
    CHECK(EditedWorld::make(world.compact, EditRoom{100, 100, 100}, room.span(), &edited) != Status::kOk);

    const HeapBytes bad_tree = damaged(odd, world.compact_bytes.span());
    CompactTree opened_tree;
    if (odd.one_in(3)) {
      edit_at_random(odd, world.compact);
    }
    const OddWorld small(odd, odd.between_32(kMinBrickMapLevel, 5));
    edit_at_random(odd, small.compact);
    if (CompactTree::open(bad_tree.span(), &opened_tree) == Status::kOk) {
      edit_at_random(odd, opened_tree);
      const std::size_t most = most_brick_map_bytes(opened_tree);
      HeapBytes bricks(odd_size(odd, most));
      const Status of_damaged = BrickMap::make(opened_tree, bricks.span(), &map);
      CHECK((of_damaged == Status::kOk || of_damaged == Status::kOutOfRange || bricks.span().size < most));
      if (of_damaged == Status::kOk) {
        CHECK(map.belongs_to(opened_tree));
        CHECK(BrickMap::validate(bricks.span()) == nullptr);
        ask_map(odd, map, opened_tree);
        ++made_of_damaged;
      }
    }
    HeapBytes bad_map = damaged(odd, world.map_bytes.span());
    if (odd.one_in(2)) {
      bad_map = HeapBytes(world.map_bytes.view());
      damage_deep_map(odd, bad_map.span());
    }
    const char* const fault = BrickMap::validate(bad_map.span());
    BrickMap opened;
    if (BrickMap::open(bad_map.span(), &opened) == Status::kOk) {
      ask_map(odd, opened, odd.one_in(2) ? world.compact : CompactTree());
      ++opened_damaged;
    } else {
      CHECK(fault != nullptr);
      CHECK(opened.directory() == nullptr);
    }
  });
  CHECK(made_of_damaged > many_or_few(40, 12));
  CHECK(opened_damaged > many_or_few(30, 9));
}
