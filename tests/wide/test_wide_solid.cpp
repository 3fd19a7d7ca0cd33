// Lists of surfaces: which voxels they hold, and what they take.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "scene/host_memory.h"
#include "support/hard_frames.h"
#include "support/wide_cases.h"
#include "thimble/tree/compact_tree.h"
#include "wide/raster/exact.h"
#include "wide/raster/surface.h"

namespace thimble::tests {
namespace {

bool is_solid(const CompactTree& tree, const Vec3i& at) {
  int level = 0;
  return wide::solid_at(tree, {at.x, at.y, at.z}, &level);
}

}  // namespace

TEST_CASE(
    "wide surface: random solid worlds -> the voxels with a neighbour that is not solid, and their nodes") {
  const int kScenes = many_or_few(60, 12);
  int surfaces = 0;
  for (int i = 0; i < kScenes; ++i) {
    const std::uint64_t seed = 400 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    const int level = 2 + i % 11;
    CAPTURE(seed);
    CAPTURE(level);
    const WideScene scene = solid_scene(random, level);
    if (!scene.lists().is_surface()) {
      continue;
    }
    ++surfaces;
    const CompactTree& tree = scene.tree;
    const VoxelBox& bounds = tree.bounds();
    // Of each listed voxel the code, with its material; entries stand cube by cube in the order of codes.
    std::vector<std::pair<std::uint64_t, std::uint8_t>> expected;
    for (std::int32_t z = bounds.low.z; z < bounds.high.z; ++z) {
      for (std::int32_t y = bounds.low.y; y < bounds.high.y; ++y) {
        for (std::int32_t x = bounds.low.x; x < bounds.high.x; ++x) {
          const bool is_hidden = is_solid(tree, {x - 1, y, z}) && is_solid(tree, {x + 1, y, z}) &&
                                 is_solid(tree, {x, y - 1, z}) && is_solid(tree, {x, y + 1, z}) &&
                                 is_solid(tree, {x, y, z - 1}) && is_solid(tree, {x, y, z + 1});
          if (is_solid(tree, {x, y, z}) && !is_hidden) {
            Ray ray;
            ray.origin = {Q8::from_raw(256 * x + 128), Q8::from_raw(256 * y + 128),
                          Q8::from_raw(256 * z + 128)};
            ray.direction = {1, 0, 0};
            Hit hit;
            REQUIRE(closest_hit(tree, ray, &hit) == Status::kOk);
            expected.emplace_back(morton_code(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                                              static_cast<std::uint32_t>(z)),
                                  hit.material);
          }
        }
      }
    }
    std::sort(expected.begin(), expected.end());
    const wide::VoxelLists& lists = scene.lists();
    REQUIRE(lists.entries().size == expected.size());
    CHECK(lists.face_area() == expected.size());
    int wrong = 0;
    for (std::size_t n = 0; n < expected.size(); ++n) {
      const Vec3i at = morton_voxel(expected[n].first);
      const auto entry =
          static_cast<std::uint32_t>((at.x & 1023) | (at.y & 1023) << 10 | (at.z & 1023) << 20);
      wrong += lists.entries()[n] != entry ? 1 : 0;
      wrong += !lists.materials().empty() && lists.materials()[n] != expected[n].second ? 1 : 0;
    }
    CHECK(wrong == 0);
    // Every node holds the entries of its cube of the world, and its children's in their order.
    struct Visit {
      std::uint32_t node;
      int level;
      std::uint64_t code;
    };
    std::vector<Visit> open{{0, tree.level(), 0}};
    std::size_t visited = 0;
    while (!open.empty()) {
      const Visit visit = open.back();
      open.pop_back();
      ++visited;
      const wide::BlockNode& node = lists.nodes()[visit.node];
      const auto first = std::lower_bound(expected.begin(), expected.end(),
                                          std::pair<std::uint64_t, std::uint8_t>{visit.code, 0});
      const auto end = std::lower_bound(
          expected.begin(), expected.end(),
          std::pair<std::uint64_t, std::uint8_t>{visit.code + (std::uint64_t{1} << (3 * visit.level)), 0});
      wrong += node.first_entry != static_cast<std::uint32_t>(first - expected.begin()) ? 1 : 0;
      wrong += node.entries != static_cast<std::uint32_t>(end - first) || node.entries == 0 ? 1 : 0;
      unsigned mask = 0;
      for (auto at = first; at != end; ++at) {
        mask |= 1U << ((at->first - visit.code) >> (3 * (visit.level - 1)));
      }
      wrong += lists.children(visit.node) != mask ? 1 : 0;
      std::uint32_t child = node.first_child;
      for (unsigned octant = 0; octant < 8 && visit.level > lists.block_level(); ++octant) {
        if ((mask >> octant & 1U) != 0) {
          open.push_back(
              {child++, visit.level - 1, visit.code + (std::uint64_t{octant} << (3 * (visit.level - 1)))});
        }
      }
    }
    CHECK(wrong == 0);
    CHECK(visited == lists.nodes().size);
  }
  CHECK(surfaces > kScenes / 2);
}

TEST_CASE("wide surface: bytes go by the surface; what does not fit takes nothing, and boxes alone may fit") {
  const auto full = [](int level) {
    return make_scene(level, [&](Octree* octree) {
      REQUIRE(octree->insert_block({0, 0, 0}, level, 7) == Status::kOk);
    });
  };
  std::size_t before = 0;
  for (const int level : {5, 6, 7, 8, 9}) {
    CAPTURE(level);
    const WideScene scene = full(level);
    const std::size_t side = std::size_t{1} << level;
    REQUIRE(scene.lists().is_surface());
    REQUIRE(scene.lists().has_boxes_beside());
    CHECK(scene.lists().boxes_beside().entries().size == 1);
    CHECK(scene.lists().entries().size == 6 * side * side - 12 * side + 8);
    const std::size_t bytes = wide::VoxelLists::bytes(scene.tree);
    CHECK(bytes < 4400 + (before == 0 ? bytes : 45 * before / 10));
    before = bytes;
    const std::size_t few = wide::VoxelLists::bytes(scene.tree, wide::ListKind::kBoxes);
    CHECK(few < 2000);
    const HeapBytes memory(bytes - 4 * 128 - 1);
    Arena arena(memory.span());
    wide::VoxelLists lists;
    Arena small(memory.span().subspan(0, few));
    CHECK(wide::VoxelLists::make(scene.tree, &small, &lists) == Status::kOutOfMemory);
    CHECK(small.used_bytes() == 0);
    CHECK(wide::VoxelLists::make(scene.tree, &small, &lists, wide::ListKind::kBoxes) == Status::kOk);
    CHECK_FALSE(lists.is_surface());
  }
  // Dust is listed as it is.
  std::mt19937_64 random(8);
  const WideScene dust = make_scene(9, [&](Octree* octree) {
    for (int n = 0; n < 20000; ++n) {
      REQUIRE(octree->insert(random_voxel(random, 0, 511), 1) == Status::kOk);
    }
  });
  CHECK_FALSE(dust.lists().is_surface());
  CHECK(dust.lists().entries().size == dust.tree.voxel_count());
}

}  // namespace thimble::tests
