// Trees, maps and worlds at the ends of what their functions take: views of nothing, headers that contradict
// one another, links and chains cut off, the last number that fits. Each answer is worked out by hand from
// src/FORMAT.md.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "support/compact_damage.h"
#include "support/scene_under_test.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::tests::tree_edges {
namespace {

void put(std::uint8_t* at, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) {
    at[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

std::string text_of(const char* text) {
  return text == nullptr ? "" : text;
}

// ---- compact trees

TEST_CASE("tree edges: views of no tree -> nothing in them, and no part of a world") {
  const CompactTree none;
  CHECK(none.voxel_count() == 0);
  CHECK(none.solid_added() == 0);
  const SharedTree no_shared;
  CHECK(no_shared.voxel_count() == 0);
  CHECK(no_shared.solid_added() == 0);
  CHECK(no_shared.bytes_with_materials() == 0);
  CHECK(no_shared.material({0, 0, 0}) == 0);

  // A view of nothing has the level of the smallest worlds, which does not make it one of the parts.
  OwnedPool pool(1);
  REQUIRE(pool.octree.insert({0, 0, 0}, 1) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  std::vector<CompactTree> parts(8, open_or_throw(bytes));
  HeapBytes out(500);
  CHECK(CompactTree::make({parts.data(), parts.size()}, out.span(), nullptr) == Status::kOk);
  for (const std::size_t place : {0U, 3U, 7U}) {
    std::vector<CompactTree> some = parts;
    some[place] = none;
    CHECK(CompactTree::make({some.data(), some.size()}, out.span(), nullptr) == Status::kBadArgument);
  }
  // More parts than the largest world has voxels: the count alone is looked at.
  const Span<const CompactTree> many{parts.data(), (std::size_t{1} << 36) + 1};
  CHECK(CompactTree::make(many, out.span(), nullptr) == Status::kBadArgument);
}

// A part whose masks promise more nodes than it has is solid where they lack: four nodes, and children 1 to 8.
TEST_CASE("tree edges: a part of a world with fewer nodes than its masks call for -> solid there") {
  OwnedPool pool(2);
  for (std::int32_t octant = 0; octant < 3; ++octant) {
    REQUIRE(pool.octree.insert({octant % 2 * 2, octant / 2 * 2, 0}, 4) == Status::kOk);
  }
  HeapBytes bytes = compact_of(pool.octree);
  REQUIRE(bytes.view().size == kCompactHeaderBytes + 8);
  bytes.span()[kCompactHeaderBytes] = 0xFF;
  repair_checksum(bytes.span());
  const CompactTree part = open_or_throw(bytes);
  HeapBytes out(500);
  CompactTree whole;
  REQUIRE(CompactTree::make({&part, 1}, out.span(), &whole) == Status::kOk);
  REQUIRE(whole.node_count() == 9);
  CHECK(whole.mask(0) == 0xFF);
  for (std::uint32_t node = 1; node < 9; ++node) {
    CHECK(whole.mask(node) == (node < 4 ? 1 : 0));
  }
  CHECK(whole.voxel_count() == 3 + 5 * 8);
  CHECK(CompactTree::validate(out.view()) == nullptr);
}

// ---- shared trees

/// The bytes of a shared tree by hand: its nodes behind one another, and where each level begins.
struct SharedByHand {
  int level = 3;
  int link_bytes = 1;
  int count_bytes = 0;
  bool merged = false;
  std::uint32_t leaves = 1;
  std::uint32_t nodes = 0;
  std::uint32_t root = 0;
  std::vector<std::uint32_t> begins;  // from level 2 on
  std::vector<std::uint8_t> node_bytes;
  Vec3i low;
  Vec3i high{1, 1, 1};

  std::uint32_t front() const { return static_cast<std::uint32_t>(shared_front_bytes(level)); }
  HeapBytes bytes() const {
    const std::size_t end = front() + node_bytes.size();
    const std::size_t padded = (end + 3) & ~std::size_t{3};
    const std::size_t size = padded + (count_bytes != 0 ? (leaves + 3U) & ~3U : 0U);
    HeapBytes made(size);
    std::uint8_t* const base = made.span().data;
    std::fill(base, base + size, std::uint8_t{0});
    put(base, 0x01474D54, 4);
    base[4] = static_cast<std::uint8_t>(level);
    base[5] = static_cast<std::uint8_t>(link_bytes);
    base[6] = static_cast<std::uint8_t>((count_bytes != 0 ? 1 : 0) | (merged ? 2 : 0));
    base[7] = count_bytes != 0 ? 0 : 9;
    put(base + 8, size, 4);
    put(base + 16, nodes, 4);
    put(base + 20, leaves, 4);
    put(base + 24, root, 4);
    for (int axis = 0; axis < 3; ++axis) {
      put(base + 28 + 2 * axis, static_cast<std::uint64_t>(low[axis]), 2);
      put(base + 34 + 2 * axis, static_cast<std::uint64_t>(high[axis]), 2);
    }
    put(base + 56, end, 4);
    put(base + 60, static_cast<std::uint64_t>(count_bytes), 4);
    for (std::size_t i = 0; i < begins.size(); ++i) {
      put(base + 64 + 4 * i, begins[i], 4);
    }
    std::copy(node_bytes.begin(), node_bytes.end(), base + front());
    for (std::uint32_t leaf = 0; count_bytes != 0 && leaf < leaves; ++leaf) {
      base[padded + leaf] = static_cast<std::uint8_t>(100 + leaf);
    }
    repair_checksum(made.span());
    return made;
  }
  std::string fault() const {
    const HeapBytes made = bytes();
    HeapBytes work(shared_check_bytes(made.view().size));
    return text_of(SharedTree::validate(made.view(), work.span()));
  }
};

SharedTree opened(const HeapBytes& bytes) {
  SharedTree tree;
  REQUIRE(SharedTree::open(bytes.view(), &tree) == Status::kOk);
  return tree;
}

// Two nodes of level 2, of a voxel at (0,0,0) and of a full block at (4,0,0), 8 voxels; the root of level 3.
SharedByHand two_nodes() {
  SharedByHand tree;
  tree.count_bytes = 1;
  tree.leaves = 9;
  tree.nodes = 3;
  tree.high = {6, 2, 2};
  tree.begins = {72, 76};
  tree.node_bytes = {1, 0x01, 1, 0xFF, 3, 9, 72, 74};
  tree.root = 76;
  return tree;
}

TEST_CASE("tree edges: a shared tree written by hand -> sound, each material where it belongs") {
  const SharedByHand made = two_nodes();
  CHECK(made.fault().empty());
  const HeapBytes bytes = made.bytes();
  const SharedTree tree = opened(bytes);
  CHECK(tree.material({0, 0, 0}) == 100);
  for (std::int32_t i = 0; i < 8; ++i) {
    CHECK(tree.material({4 + (i & 1), i >> 1 & 1, i >> 2}) == 101 + i);
  }
  // Empty: an octant without a child on each level; and outside, on each axis and side.
  for (const Vec3i& at : {Vec3i{1, 0, 0}, Vec3i{2, 0, 0}, Vec3i{0, 4, 0}, Vec3i{8, 0, 0}, Vec3i{0, 8, 0},
                          Vec3i{0, 0, 8}, Vec3i{-1, 0, 0}, Vec3i{0, -1, 0}, Vec3i{0, 0, INT32_MIN}}) {
    CHECK(tree.material(at) == 0);
  }
}

TEST_CASE("tree edges: a shared tree's header against itself -> the status says what is wrong") {
  SharedByHand tree = two_nodes();
  // Bounds: not below one another, beyond the world, or of nothing at all.
  for (int axis = 0; axis < 3; ++axis) {
    tree.low[axis] = tree.high[axis];
    CHECK(tree.fault() == "bounds outside the world");
    tree.low[axis] = 0;
    const std::int32_t before = tree.high[axis];
    tree.high[axis] = 9;
    CHECK(tree.fault() == "bounds outside the world");
    tree.high[axis] = 8;
    CHECK(tree.fault().empty());
    tree.high[axis] = before;
  }
  SharedByHand empty;
  empty.level = 1;
  empty.leaves = 0;
  empty.root = SharedTree::kNowhere;
  empty.high = {0, 0, 0};
  CHECK(empty.fault().empty());
  for (int axis = 0; axis < 3; ++axis) {
    empty.high[axis] = 1;
    CHECK(empty.fault() == "bounds outside the world");
    empty.low[axis] = 1;
    CHECK(empty.fault() == "bounds outside the world");
    empty.low[axis] = empty.high[axis] = 0;
  }
  // A world of 2 x 2 x 2 has no nodes, only a root.
  empty.node_bytes = {1};
  CHECK(empty.fault() == "another number of nodes");

  const HeapBytes bytes = two_nodes().bytes();
  HeapBytes work(shared_check_bytes(bytes.view().size));
  CHECK(SharedTree::validate(bytes.view(), work.span()) == nullptr);
  std::uint32_t place = 99;
  CHECK(text_of(SharedTree::validate(bytes.view(), {work.span().data, work.span().size - 1}, &place)) ==
        "the workspace is too small");
  CHECK(place == 0);
}

TEST_CASE(
    "tree edges: the root of a shared tree -> a node of the highest level, a block, or 8 voxels; else told") {
  SharedByHand tree = two_nodes();
  for (std::uint32_t root = 0; root < 90; ++root) {
    tree.root = root;
    CAPTURE(root);
    CHECK(tree.fault() == (root == 76 ? "" : "a root that is no node"));
  }
  for (const std::uint32_t root : {SharedTree::kInline | 5, SharedTree::kInline | SharedTree::kMergedBit}) {
    tree.root = root;
    CHECK(tree.fault() == "a root that is no node");
  }
  tree.root = SharedTree::kInline;  // a solid world, of one leaf
  CHECK(tree.fault() == "wrong count of leaves");

  SharedByHand small;
  small.level = 1;
  for (const std::uint32_t root : {0U, 5U, 64U, SharedTree::kInline | 0x205, SharedTree::kInline | 0x105}) {
    small.root = root;
    CHECK(small.fault() == "a root that is no node");
  }
  small.root = SharedTree::kInline | 5;
  CHECK(small.fault().empty());
  small.root = SharedTree::kInline;
  CHECK(small.fault().empty());
  small.merged = true;
  small.root = SharedTree::kInline | SharedTree::kMergedBit;
  CHECK(small.fault().empty());
}

// A node a level, its eight children all the node below; at level 1 seven voxels each: 7 * 8^(level - 1)
// leaves.
TEST_CASE("tree edges: a tree of as many leaves as take 1 to 4 bytes -> its bytes with a count a node") {
  for (int level = 2; level <= 11; ++level) {
    SharedByHand tree;
    tree.level = level;
    tree.nodes = static_cast<std::uint32_t>(level - 1);
    tree.high = {1 << level, 1 << level, 1 << level};
    tree.begins.push_back(tree.front());
    tree.node_bytes.assign(9, 0xFE);
    tree.node_bytes[0] = 0xFF;
    tree.leaves = 56;
    for (int above = 3; above <= level; ++above) {
      const std::uint32_t below = tree.begins.back();
      tree.begins.push_back(tree.front() + static_cast<std::uint32_t>(tree.node_bytes.size()));
      tree.node_bytes.push_back(0xFF);
      tree.node_bytes.insert(tree.node_bytes.end(), 8, static_cast<std::uint8_t>(below));
      tree.leaves *= 8;
    }
    tree.root = tree.begins.back();
    CAPTURE(level);
    REQUIRE(tree.fault().empty());
    const HeapBytes bytes = tree.bytes();
    // 9 bytes a node, and in all but the lowest a count; links stay of one byte below 257.
    const std::uint64_t count = tree.leaves < 256        ? 1
                                : tree.leaves < 65536    ? 2
                                : tree.leaves < 16777216 ? 3
                                                         : 4;
    const std::uint64_t above = static_cast<std::uint64_t>(level) - 2;
    const std::uint64_t end = tree.front() + 9 * (above + 1) + count * above;
    REQUIRE(end <= 256);
    CHECK(opened(bytes).bytes_with_materials() == ((end + 3) & ~std::uint64_t{3}) + tree.leaves);
  }
}

// Nothing is solid, and yet the header says that there are several materials: it takes no byte for them.
TEST_CASE("tree edges: an empty tree of several materials, shared -> empty") {
  OwnedPool pool(3);
  HeapBytes bytes = compact_of(pool.octree);
  bytes.span()[6] = 1;
  repair_checksum(bytes.span());
  REQUIRE(CompactTree::validate(bytes.view()) == nullptr);
  const CompactTree tree = open_or_throw(bytes);
  HeapBytes work(shared_work_bytes(0));
  HeapBytes out(200);
  SharedTree shared;
  SharedBuild build;
  REQUIRE(SharedTree::make(tree, out.span(), work.span(), &shared, &build) == Status::kOk);
  CHECK(shared.empty());
  CHECK(build.bytes == shared_front_bytes(3));
  CHECK(shared.material({1, 2, 3}) == 0);
  CHECK(SharedTree::validate({out.view().data, build.bytes}, work.span()) == nullptr);
}

// ---- brick maps

TEST_CASE("tree edges: a brick map of no tree, or of a level without maps -> out of range, and of no tree") {
  HeapBytes out(most_brick_map_bytes(2));
  BrickMap map;
  CHECK(BrickMap::make(CompactTree(), out.span(), &map) == Status::kOutOfRange);
  CHECK(most_brick_map_bytes(CompactTree()) == 0);
  for (const int level : {1, 11, 12}) {
    OwnedPool pool(level);
    REQUIRE(pool.octree.insert({1, 1, 1}, 2) == Status::kOk);
    const HeapBytes bytes = compact_of(pool.octree);
    CHECK(BrickMap::make(open_or_throw(bytes), out.span(), &map) == Status::kOutOfRange);
    CHECK(most_brick_map_bytes(open_or_throw(bytes)) == 0);
  }
  OwnedPool pool(2);
  REQUIRE(pool.octree.insert({1, 1, 1}, 2) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const OwnedMap made(open_or_throw(bytes), most_brick_map_bytes(2));
  REQUIRE(made.status == Status::kOk);
  CHECK(made.map.belongs_to(made.tree));
  CHECK_FALSE(map.belongs_to(made.tree));
  CHECK_FALSE(made.map.belongs_to(CompactTree()));
  // The same checksum in a world of another level: not its own.
  OwnedPool larger(3);
  REQUIRE(larger.octree.insert({1, 1, 1}, 2) == Status::kOk);
  HeapBytes other = compact_of(larger.octree);
  std::copy_n(bytes.view().data + 12, 4, other.span().data + 12);
  CHECK_FALSE(made.map.belongs_to(open_or_throw(other)));
}

TEST_CASE(
    "tree edges: a map with its checksum put right -> cells beyond its bricks and a first brick not empty "
    "told") {
  OwnedPool pool(3);
  REQUIRE(pool.octree.insert({1, 1, 1}, 2) == Status::kOk);
  REQUIRE(pool.octree.insert({5, 1, 1}, 2) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const auto fault_with = [&](std::size_t at, std::uint8_t value) {
    const OwnedMap made(open_or_throw(bytes), most_brick_map_bytes(3));
    REQUIRE(made.status == Status::kOk);
    REQUIRE(made.map.brick_count() == 3);
    made.room.span()[at] = value;
    repair_checksum({made.room.span().data, made.size});
    const ConstBytes view{made.room.view().data, made.size};
    BrickMap map;
    const std::string text = text_of(BrickMap::validate(view));
    CHECK(BrickMap::open(view, &map) == (text.empty() ? Status::kOk : Status::kDamaged));
    return text;
  };
  // Two cells, of 4 bytes and 4 more; then three bricks of 8.
  for (const std::size_t cell : {0U, 1U}) {
    CHECK(fault_with(kBrickMapHeaderBytes + 2 * cell, 2).empty());
    CHECK(fault_with(kBrickMapHeaderBytes + 2 * cell, 3) == "a cell names a brick that is not there");
    CHECK(fault_with(kBrickMapHeaderBytes + 2 * cell + 1, 1) == "a cell names a brick that is not there");
  }
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(fault_with(kBrickMapHeaderBytes + 8 + i, 0x80) == "brick 0 is not empty");
    CHECK(fault_with(kBrickMapHeaderBytes + 16 + i, 0x80).empty());
  }
}

// An origin says the place of a brick's first node in 24 bits. No world has as many nodes as that; damaged
// bytes may: a root (of level 2, a brick) whose child the directory puts at the very end of 2^24 masks.
TEST_CASE("tree edges: a brick whose nodes begin at 2^24 -> out of range; one before -> a map") {
  constexpr std::uint32_t kEnd = std::uint32_t{1} << 24;
  for (const std::uint32_t child : {kEnd - 1, kEnd}) {
    CompactShape shape;
    shape.level = 2;
    shape.nodes = kEnd + 1;
    shape.voxel_bits = 2;
    shape.many_materials = true;
    const std::size_t size = compact_bytes(shape);
    std::vector<std::uint64_t> words(size / 8 + 1);
    auto* const base = reinterpret_cast<std::uint8_t*>(words.data());
    put(base, 0x01424D54, 4);
    base[4] = 2;
    base[5] = kDefaultRankShift;
    base[6] = 1;
    put(base + 8, size, 4);
    put(base + 16, shape.nodes, 4);
    put(base + 24, shape.voxel_bits, 4);
    for (int axis = 0; axis < 3; ++axis) {
      put(base + 34 + 2 * axis, 4, 2);
    }
    std::uint8_t* const masks = base + kCompactHeaderBytes;
    masks[0] = 1;
    masks[child] = 3;
    // The directory: children before each 64 nodes. The root's is `child`; that one's are the two voxels.
    std::uint8_t* const ranks = masks + ((shape.nodes + 3) & ~3U);
    const std::size_t blocks = (shape.nodes + 63) / 64;
    put(ranks, child - 1, 4);
    put(ranks + 4 * std::size_t{child / 64}, shape.nodes - 1, 4);
    std::uint8_t* const materials = ranks + 4 * blocks;
    materials[0] = 6;
    materials[1] = 7;
    CompactTree tree;
    REQUIRE(CompactTree::open({base, size}, &tree) == Status::kOk);
    REQUIRE(tree.first_child(0) == child);
    const OwnedMap made(tree, most_brick_map_bytes(2));
    CHECK(made.status == (child < kEnd ? Status::kOk : Status::kOutOfRange));
    if (child < kEnd) {
      CHECK(made.map.mixed_count() == 1);
      CHECK(made.map.material(tree, 1, 0) == 6);
      CHECK(made.map.material(tree, 1, 1) == 7);
    }
  }
}

}  // namespace
}  // namespace thimble::tests::tree_edges
