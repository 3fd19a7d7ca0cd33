// The rays worked out by hand (portable/rays.h) before the judges, in every structure and width; merged blocks, and
// materials.
#include <doctest/doctest.h>

#include <algorithm>

#include "portable/rays.h"
#include "reference/reference.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/trace/ray.h"

namespace {

using namespace thimble;
using namespace thimble::tests;
using Voxels = std::vector<reference::Voxel>;

const int kScale = thimble::tests::many_or_few(10, 1);

reference::Hit hit_at(const reference::Voxel& voxel, std::int64_t numerator, std::int64_t denominator,
                      int axis) {
  return {true, voxel, numerator, denominator, axis};
}

// A cube of 2^level voxels a side.
class Cube {
 public:
  Cube(int level, const Voxels& voxels)
      : scene_({1 << level, 1 << level, 1 << level}, voxels), voxels_(voxels) {}

  // Every structure and width, and both judges, give the answer worked out by hand.
  void expect(const Ray& ray, const reference::Hit& expected) const {
    SceneUnderTest::Tally tally;
    scene_.compare(ray, expected, tally);
    CHECK_MESSAGE(tally.mismatches == 0, tally.first);
    CHECK(tally.traced >= 2);
    CHECK(reference::same_answer(reference::brute_force(voxels_, to_reference(ray)), expected));
    CHECK(reference::same_answer(reference::walk(scene_.reference(), to_reference(ray)), expected));
  }
  void expect_miss(const Ray& ray) const { expect(ray, reference::Hit{}); }

 private:
  SceneUnderTest scene_;
  Voxels voxels_;
};

Voxels all_voxels(int side) {
  Voxels voxels;
  add_box({0, 0, 0}, {side, side, side}, &voxels);
  return voxels;
}

Voxels random_voxels(std::mt19937_64& random, int level, int count) {
  Voxels voxels;
  for (int i = 0; i < count; ++i) {
    reference::Voxel voxel{};
    for (int& component : voxel) {
      component = pick_int(random, 0, (1 << level) - 1);
    }
    voxels.push_back(voxel);
  }
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

}  // namespace

TEST_CASE("trace: the rays worked out by hand -> so say the judges, and every structure and width") {
  for (const portable::RayCase& row : portable::ray_cases()) {
    CAPTURE(row.name);
    Voxels voxels;
    for (int i = 0; i < row.scene->box_count; ++i) {
      const portable::RayScene::Box& box = row.scene->boxes[i];
      add_box({box.low[0], box.low[1], box.low[2]}, {box.high[0], box.high[1], box.high[2]}, &voxels);
    }
    const Cube cube(row.scene->level, voxels);
    if (row.axis == portable::kMiss) {
      cube.expect_miss(row.ray());
    } else {
      cube.expect(row.ray(), hit_at({row.voxel[0], row.voxel[1], row.voxel[2]}, row.numerator,
                                    row.denominator, row.axis));
    }
  }
}

namespace {

// The leaves of a pool: merged blocks as blocks, everything else as single voxels.
void leaves_of(const Octree& pool, uint32_t index, const Vec3i& corner, int level,
               std::vector<reference::Block>& blocks) {
  const Octree::NodeView node = pool.node(index);
  if (node.solid() && node.merged) {
    blocks.push_back({{corner.x, corner.y, corner.z}, level});
    return;
  }
  if (node.solid()) {
    for (const reference::Voxel& voxel : all_voxels(1 << level)) {
      blocks.push_back({{corner.x + voxel[0], corner.y + voxel[1], corner.z + voxel[2]}, 0});
    }
    return;
  }
  const int half = 1 << (level - 1);
  for (int octant = 0; octant < 8; ++octant) {
    if (((node.mask >> octant) & 1) == 0) {
      continue;
    }
    const Vec3i child{corner.x + ((octant & 1) != 0 ? half : 0), corner.y + ((octant & 2) != 0 ? half : 0),
                      corner.z + ((octant & 4) != 0 ? half : 0)};
    if (level == 1) {
      blocks.push_back({{child.x, child.y, child.z}, 0});
    } else {
      leaves_of(pool, pool.child(node, octant), child, level - 1, blocks);
    }
  }
}

// Pool and compact tree, each in the widths that take the ray, against the judge of blocks.
void check_blocks(const Octree& pool, const CompactTree& tree, const std::vector<reference::Block>& blocks,
                  const Ray& ray, int* merged_hits) {
  const reference::Hit expected = reference::judge_blocks(blocks, to_reference(ray));
  int block_level = 0;
  for (const reference::Block& block : blocks) {
    if (expected.hit && block.lowest == expected.voxel) {
      block_level = block.log2_side;
    }
  }
  const auto check = [&](const Hit& hit) {
    CHECK_MESSAGE(tests::same_answer(hit, expected), reference::describe(to_reference(ray))
                                                         << ": " << describe(hit) << ", expected "
                                                         << reference::describe(expected));
    if (expected.hit && hit.kind == HitKind::kHit) {
      CHECK(hit.block_level == block_level);
      CHECK(hit.material == pool.material(hit.voxel));
      *merged_hits += hit.block_level > 0 ? 1 : 0;
    }
  };
  for (const Width width : {Width::k64, Width::k32}) {
    if (width == Width::k32 && !accepts_32(ray, pool.level())) {
      continue;
    }
    Hit hit;
    REQUIRE(closest_hit(pool, ray, &hit, {UINT32_MAX, width}) == Status::kOk);
    check(hit);
    REQUIRE(closest_hit(tree, ray, &hit, {UINT32_MAX, width}) == Status::kOk);
    check(hit);
    HitKind kind = HitKind::kStepLimit;
    REQUIRE(any_hit(tree, ray, &kind, nullptr, {UINT32_MAX, width}) == Status::kOk);
    CHECK(kind == hit.kind);
  }
}

}  // namespace

TEST_CASE("trace: merged blocks of a coarsened tree -> lowest corner, exact t, the block's material") {
  std::mt19937_64 random(61);
  int merged_hits = 0;
  for (int world = 0; world < 30; ++world) {
    const int level = pick_int(random, 2, 5);
    const int side = 1 << level;
    const unsigned materials = world % 2 == 0 ? 1 : 3;
    OwnedPool owned(level, 40000);
    Octree& pool = owned.octree;
    for (const reference::Voxel& voxel :
         random_voxels(random, level, pick_int(random, 4, side * side * side / 4))) {
      REQUIRE(pool.insert({voxel[0], voxel[1], voxel[2]}, material_at(voxel, materials, 61)) == Status::kOk);
    }
    // One block that is truly full among the merged ones.
    REQUIRE(pool.insert_block({0, 0, 0}, level - 1, 2) == Status::kOk);
    REQUIRE(pool.coarsen_to(std::max<std::size_t>(
                1, pool.nodes_used() * static_cast<std::size_t>(1 + world % 3) / 4)) == Status::kOk);
    std::vector<reference::Block> blocks;
    leaves_of(pool, pool.root(), {}, level, blocks);
    const HeapBytes compact = compact_of(pool, kMinRankShift + world % 8);
    CHECK(CompactTree::validate(compact.view()) == nullptr);
    const CompactTree tree = open_or_throw(compact);
    CHECK(tree.solid_added() == pool.solid_added());
    RayCases cases(62 + static_cast<std::uint64_t>(world), {side, side, side});
    for (int i = 0; i < 100 * kScale / 2; ++i) {
      check_blocks(pool, tree, blocks, to_core(cases.next().ray), &merged_hits);
    }
  }
  CHECK(merged_hits > 100);
}
