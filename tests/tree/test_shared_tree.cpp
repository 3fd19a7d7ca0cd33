// The shared tree: the same hits as the tree that it was made from, as many bytes as counting by hand says,
// and what happens when they are too few or damaged.
#include <doctest/doctest.h>

#include <algorithm>

#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "support/subtree_count.h"
#include "thimble/picture/render.h"
#include "thimble/tree/shared_tree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

const int kWorldScale = thimble::tests::many_or_few(8, 1);

// A shared tree that owns its bytes, exactly as many as it takes, made in exactly the workspace that it
// takes.
struct OwnedShared {
  explicit OwnedShared(const CompactTree& compact, std::size_t offset = 0) : bytes(0) {
    HeapBytes work(shared_work_bytes(compact.node_count()), 1);
    SharedBuild first;
    CHECK(SharedTree::make(compact, {}, work.span(), nullptr, &first) == Status::kOutOfMemory);
    bytes = HeapBytes(first.bytes, offset);
    REQUIRE(SharedTree::make(compact, bytes.span(), work.span(), nullptr, &build) == Status::kOk);
    CHECK(build.bytes == first.bytes);
    CHECK(build.work_bytes <= work.view().size);
    REQUIRE(SharedTree::open(bytes.view(), &tree) == Status::kOk);
  }
  OwnedShared(const OwnedShared&) = delete;
  OwnedShared& operator=(const OwnedShared&) = delete;

  const char* fault() const {
    HeapBytes work(shared_check_bytes(bytes.view().size));
    return SharedTree::validate(bytes.view(), work.span());
  }

  HeapBytes bytes;
  SharedBuild build;
  SharedTree tree;
};

void check_same_hits(const SharedTree& shared, const CompactTree& compact, std::uint64_t seed, int rays,
                     const std::vector<reference::Voxel>& targets = {}) {
  const int side = 1 << compact.level();
  RayCases cases(seed, {side, side, side}, targets);
  std::string first;
  for (int i = 0; i < rays; ++i) {
    const Ray ray = to_core(cases.next().ray);
    for (const Width width : {Width::k64, Width::k32}) {
      if (width == Width::k32 && !accepts_32(ray, compact.level())) {
        continue;
      }
      for (const std::uint32_t limit : {UINT32_MAX, std::uint32_t{3}}) {
        Hit a;
        Hit b;
        const TraceOptions options{limit, width};
        REQUIRE(closest_hit(shared, ray, &a, options) == Status::kOk);
        REQUIRE(closest_hit(compact, ray, &b, options) == Status::kOk);
        const bool same = same_hit(a, b) && a.visits == b.visits;
        HitKind kind = HitKind::kStepLimit;
        std::uint32_t visits = 0;
        REQUIRE(any_hit(shared, ray, &kind, &visits, options) == Status::kOk);
        if (first.empty() && (!same || kind != b.kind || visits != b.visits)) {
          first = "seed " + std::to_string(seed) + ", ray " + std::to_string(i) + ": " +
                  reference::describe(to_reference(ray)) + ": shared: " + describe(a) +
                  "; compact: " + describe(b);
        }
      }
    }
  }
  CHECK_MESSAGE(first.empty(), first);
}

// Solid blocks of several sizes, some materials, some of it coarsened.
struct BlockPool : OwnedPool {
  BlockPool(int level, std::mt19937_64& random, unsigned materials, bool coarsen) : OwnedPool(level) {
    const std::int64_t pieces = pick(random, 0, 120);
    for (std::int64_t i = 0; i < pieces; ++i) {
      const int block = pick_int(random, 0, std::min(level, 3));
      Vec3i corner;
      for (int axis = 0; axis < 3; ++axis) {
        corner[axis] = pick_int(random, 0, (1 << (level - block)) - 1) << block;
      }
      REQUIRE(octree.insert_block(corner, block, static_cast<std::uint8_t>(pick(random, 0, materials - 1))) ==
              Status::kOk);
    }
    if (coarsen && octree.nodes_used() > 1) {
      REQUIRE(octree.coarsen_to(std::max(1U, octree.nodes_used() * 2 / 3)) == Status::kOk);
    }
  }
};

}  // namespace

TEST_CASE(
    "shared tree: random worlds, rays and widths -> the hits of the compact tree and of the reference") {
  std::mt19937_64 random(601);
  for (int world = 0; world < 40 * kWorldScale; ++world) {
    const int level = pick_int(random, 1, world % 8 == 0 ? 12 : 6);
    const WorldKind kind = level > 6 ? WorldKind::kSparse
                                     : static_cast<WorldKind>(pick(random, 0, std::int64_t{kWorldKinds} - 1));
    const World voxels = make_world(kind, {1 << level, 1 << level, 1 << level}, random);
    const unsigned materials = world % 2 == 0 ? 1 : 3;
    CAPTURE(world);
    CAPTURE(voxels.name);
    const SceneUnderTest scene(voxels.size, voxels.voxels, materials, 5);
    const OwnedShared shared(scene.compact(), static_cast<std::size_t>(world % 4));
    CHECK(shared.fault() == nullptr);
    CHECK(shared.tree.level() == level);
    CHECK(shared.tree.empty() == voxels.voxels.empty());
    CHECK(shared.tree.voxel_count() == voxels.voxels.size());
    CHECK(shared.tree.bounds() == scene.compact().bounds());
    CHECK(shared.tree.many_materials() == scene.compact().many_materials());
    const CompactShape shape = compact_shape(scene.pool());
    CHECK(shared.tree.leaf_count() == shape.solid_blocks + shape.voxel_bits);
    CHECK(shared.build.bytes <= shared_tree_bytes(shape));
    std::vector<reference::Voxel> targets(
        voxels.voxels.begin(),
        voxels.voxels.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(voxels.voxels.size(), 40)));
    check_same_hits(shared.tree, scene.compact(), 1000 + static_cast<std::uint64_t>(world), 300, targets);
    RayCases cases(static_cast<std::uint64_t>(world), voxels.size, targets);
    for (int i = 0; i < 50; ++i) {
      const RayCase ray = cases.next();
      Hit hit;
      REQUIRE(closest_hit(shared.tree, to_core(ray.ray), &hit) == Status::kOk);
      const reference::Hit expected = reference::walk(scene.reference(), ray.ray);
      CHECK(same_answer(hit, expected));
      if (expected.hit) {
        CHECK(hit.material == material_at(expected.voxel, materials, 5));
      }
    }
    for (std::size_t i = 0; i < voxels.voxels.size(); i += 1 + voxels.voxels.size() / 50) {
      const reference::Voxel& at = voxels.voxels[i];
      CHECK(shared.tree.material({at[0], at[1], at[2]}) == material_at(at, materials, 5));
    }
  }
}

TEST_CASE("shared tree: solid blocks of several materials, coarsened ones -> the hits of the compact tree") {
  std::mt19937_64 random(77);
  int merged = 0;
  for (int world = 0; world < 40 * kWorldScale; ++world) {
    const int level = pick_int(random, 1, 7);
    CAPTURE(world);
    const BlockPool pool(level, random, world % 3 == 0 ? 1U : 200U, world % 2 == 0);
    const HeapBytes bytes = compact_of(pool.octree);
    const CompactTree compact = open_or_throw(bytes);
    const OwnedShared shared(compact);
    CHECK(shared.fault() == nullptr);
    CHECK(shared.tree.merged() == compact.merged());
    CHECK(shared.tree.solid_added() == compact.solid_added());
    merged += compact.merged() ? 1 : 0;
    check_same_hits(shared.tree, compact, static_cast<std::uint64_t>(world), 300);
  }
  CHECK(merged > 10);
}

TEST_CASE("shared tree: small worlds of one material -> as many nodes and bytes as counting by hand gives") {
  std::mt19937_64 random(3);
  for (int world = 0; world < 60; ++world) {
    const int level = pick_int(random, 1, 5);
    const auto kind = static_cast<WorldKind>(world % static_cast<int>(kWorldKinds));
    const World voxels = make_world(kind, {1 << level, 1 << level, 1 << level}, random);
    CAPTURE(voxels.name);
    CAPTURE(level);
    const SceneUnderTest scene(voxels.size, voxels.voxels);
    const OwnedShared shared(scene.compact());
    // A full world has no node at all, which the count says as well.
    const CountedTrees counted = count_trees(scene.reference(), level);
    CHECK(shared.tree.node_count() == counted.shared_nodes);
    CHECK(shared.build.bytes == counted.shared_bytes);
    CHECK(shared.tree.size_bytes() == shared.build.bytes);
  }
}

TEST_CASE("shared tree: every second voxel of a large world -> one node a level") {
  constexpr int kLevel = 9;
  OwnedPool octree_pool(kLevel, 1 << 20);
  Octree& octree = octree_pool.octree;
  // The corner of each 8 x 8 x 8 block.
  for (int z = 0; z < 512; z += 8) {
    for (int y = 0; y < 512; y += 8) {
      for (int x = 0; x < 512; x += 8) {
        REQUIRE(octree.insert({x, y, z}) == Status::kOk);
      }
    }
  }
  const HeapBytes compact = compact_of(octree);
  const OwnedShared shared(open_or_throw(compact));
  CHECK(shared.tree.node_count() == 8);
  // Two nodes of one child, six of eight; the whole is below 256 bytes, so a link is one.
  CHECK(shared.build.bytes == (64 + 4 * 8 + 2 * 2 + 6 * 9 + 3) / 4 * 4);
  CHECK(compact.view().size > 250000);
  check_same_hits(shared.tree, open_or_throw(compact), 9, 300 * kWorldScale);
}

TEST_CASE("shared tree: too small a workspace or result -> out of memory, and not a byte written") {
  std::mt19937_64 random(5);
  for (int world = 0; world < 6; ++world) {
    const BlockPool pool(5, random, world % 2 == 0 ? 1U : 4U, world % 3 == 0);
    const HeapBytes bytes = compact_of(pool.octree);
    const CompactTree compact = open_or_throw(bytes);
    const OwnedShared shared(compact);
    const std::size_t size = shared.build.bytes;
    const std::size_t least = shared.build.work_bytes;
    std::vector<std::uint32_t> words(least / 4 + 40);
    std::vector<std::uint8_t> out(size, 0xA5);
    const std::vector<std::uint8_t> untouched = out;
    for (std::size_t work = 0; work < least; work += 4 + least / 500 * 4) {
      CHECK(SharedTree::make(compact, Bytes(out.data(), size),
                             Bytes(reinterpret_cast<std::uint8_t*>(words.data()), work),
                             nullptr) == Status::kOutOfMemory);
    }
    const Bytes whole(reinterpret_cast<std::uint8_t*>(words.data()), least);
    CHECK(SharedTree::make(compact, Bytes(out.data(), size), whole.subspan(0, least - 4), nullptr) ==
          Status::kOutOfMemory);
    for (std::size_t fewer = 0; fewer < size; ++fewer) {
      SharedBuild build;
      REQUIRE(SharedTree::make(compact, Bytes(out.data(), fewer), whole, nullptr, &build) ==
              Status::kOutOfMemory);
      CHECK(build.bytes == size);
    }
    CHECK(out == untouched);
    // As much as it takes, and somewhat more: the same bytes.
    for (std::size_t more = 0; more <= 160; more += 4) {
      std::fill(out.begin(), out.end(), std::uint8_t{0xA5});
      SharedBuild build;
      REQUIRE(SharedTree::make(compact, Bytes(out.data(), size),
                               Bytes(reinterpret_cast<std::uint8_t*>(words.data()), least + more), nullptr,
                               &build) == Status::kOk);
      CHECK(build.work_bytes == least);
      CHECK(std::equal(out.begin(), out.end(), shared.bytes.view().begin()));
    }
  }
}
