// Lists of surfaces: which voxels they hold, and what they take.
#include <doctest/doctest.h>

#include "scene/host_memory.h"
#include "support/wide_cases.h"
#include "thimble/tree/compact_tree.h"
#include "wide/raster/surface.h"

namespace thimble::tests {
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
    CHECK(scene.lists().size() == 6 * side * side - 12 * side + 8);
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
  CHECK(dust.lists().size() == dust.tree.voxel_count());
}

}  // namespace thimble::tests
