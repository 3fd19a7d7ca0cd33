// Triangles to voxels cell by cell: the same voxels as triangle by triangle, each once, and in time.
#include <doctest/doctest.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <vector>

#include "scene/random.h"
#include "scene/voxelise.h"
#include "scene/world_fit.h"
#include "support/counts.h"

namespace {

using namespace thimble::tools;

UnitTriangle any_triangle(SplitMix64& random, int level) {
  const std::int32_t top = (kUnitsPerVoxel << level) - 1;
  const std::int32_t reach = random.below(2) == 0 ? top : std::int32_t{kUnitsPerVoxel} * 6;
  UnitTriangle triangle{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t low = random.between(1, top);
    for (UnitPoint& corner : triangle) {
      corner[axis] = std::clamp(low + random.between(-reach, reach), 1, top);
      if (random.below(3) == 0) {
        corner[axis] = std::max(corner[axis] & ~255, 1);  // on a wall between voxels
      }
    }
    if (random.below(6) == 0) {
      triangle[1][axis] = triangle[2][axis] = triangle[0][axis];
    }
  }
  return triangle;
}

using Voxels = std::map<UnitPoint, std::uint8_t>;

Voxels by_triangle(const std::vector<CellTriangle>& triangles) {
  Voxels voxels;
  for (const CellTriangle& triangle : triangles) {
    voxelise_triangle(triangle.corners, triangle.material,
                      [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
                        voxels[{x, y, z}] = material;
                      });
  }
  return voxels;
}

Voxels by_cell(const std::vector<CellTriangle>& triangles, int level, int* blocks) {
  Voxels voxels;
  bool once = true;
  double last = 0;
  const BlockSink sink = [&](const UnitPoint& corner, int block_level, std::uint8_t material) {
    const std::int32_t side = std::int32_t{1} << block_level;
    *blocks += block_level > 0 ? 1 : 0;
    for (std::int32_t i = 0; i < side * side * side; ++i) {
      const UnitPoint voxel{corner[0] + i % side, corner[1] + i / side % side, corner[2] + i / side / side};
      once = once && voxels.emplace(voxel, material).second;
    }
  };
  voxelise_cells(triangles, level, sink, [&](double done) {
    CHECK(done >= last);
    CHECK(done <= 1);
    last = done;
  });
  CHECK(last == 1);
  CHECK(once);
  return voxels;
}

}  // namespace

TEST_CASE("voxelise_cells: random triangles -> what each of them meets, with the last one's material") {
  SplitMix64 random(20);
  int blocks = 0;
  for (int round = 0; round < 60; ++round) {
    const int level = random.between(1, 6);
    const bool many_materials = round % 2 == 0;
    std::vector<CellTriangle> triangles;
    const int count = round < 50 ? random.between(1, 30) : 1500;
    for (int i = 0; i < count; ++i) {
      triangles.push_back(
          {any_triangle(random, level), static_cast<std::uint8_t>(many_materials ? random.below(3) : 0)});
    }
    CAPTURE(round);
    CHECK((by_cell(triangles, level, &blocks) == by_triangle(triangles)));
  }
  CHECK(blocks > 100);
}
