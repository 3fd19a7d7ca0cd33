// The brick map of worlds of every kind: each voxel and what is seen of its material, and the bytes that were written
// down.
#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "support/map_cells.h"
#include "support/scene_under_test.h"
#include "thimble/base/memory.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

constexpr int kNothing = -1;
constexpr std::int32_t kMapSide = 32;

int ball(Vec3i v) {
  const std::int32_t x = v.x - 15, y = v.y - 17, z = v.z - 14;
  return x * x + y * y + z * z < 121 ? 6 : kNothing;
}
int halves(Vec3i v) {
  for (int axis = 0; axis < 3; ++axis) {
    if (v[axis] < 3 || v[axis] >= 29) {
      return kNothing;
    }
  }
  return v.x < 16 ? 1 : 2;
}
// What is seen is of one material, what is not of another.
int kernel(Vec3i v) {
  for (int axis = 0; axis < 3; ++axis) {
    if (v[axis] < 1 || v[axis] >= 31) {
      return 9;
    }
  }
  return 3 + (v.x + v.y) % 2;
}
int dust(Vec3i v) {
  const std::uint32_t hash = static_cast<std::uint32_t>(v.x) * 73856093U ^
                             static_cast<std::uint32_t>(v.y) * 19349663U ^
                             static_cast<std::uint32_t>(v.z) * 83492791U;
  return hash % 19 == 0 ? static_cast<int>(hash / 19 % 3) : kNothing;
}
int stripes(Vec3i v) {
  return v.z < 5 || (v.x + 2 * v.y < 20 && v.z < 25) ? v.y / 3 % 4 : kNothing;
}
int full(Vec3i) {
  return 0;
}
int corner(Vec3i v) {
  return v == Vec3i{31, 0, 31} || v == Vec3i{0, 31, 30} ? 255 : kNothing;
}

struct MapWorld {
  int (*material)(Vec3i voxel);
  std::size_t size_bytes;
  std::uint32_t bricks;
  std::uint32_t mixed;
  std::uint32_t crc32;
};

}  // namespace

TEST_CASE(
    "brick map: worlds of every kind -> each voxel, its material where it is seen, the bytes written down") {
  const MapWorld worlds[] = {
      {ball, 1408, 105, 0, 3312454369},      {halves, 3748, 299, 0, 652889730},
      {kernel, 1084, 3, 0, 3209844912},      {dust, 9748, 499, 382, 3272763194},
      {stripes, 4196, 170, 158, 1383516124}, {full, 1076, 2, 0, 727346649},
      {corner, 188, 3, 0, 1604114209},
  };
  for (const MapWorld& world : worlds) {
    OwnedPool octree_pool(5, 40000);
    Octree& octree = octree_pool.octree;
    for (std::int32_t i = 0; i < kMapSide * kMapSide * kMapSide; ++i) {
      const Vec3i at{i % kMapSide, i / kMapSide % kMapSide, i / kMapSide / kMapSide};
      if (world.material(at) != kNothing) {
        REQUIRE(octree.insert(at, static_cast<std::uint8_t>(world.material(at))) == Status::kOk);
      }
    }
    const MappedTree scene(compact_of(octree));
    const BrickMap& map = scene.map;
    const ConstBytes map_bytes(scene.map_room.view().data, map.size_bytes());
    CHECK(BrickMap::validate(map_bytes) == nullptr);
    CHECK(wrong_cells(map, scene.tree, world.material) == 0);
    CAPTURE(&world - worlds);
    CHECK(map_bytes.size == world.size_bytes);
    CHECK(map.brick_count() == world.bricks);
    CHECK(map.mixed_count() == world.mixed);
    CHECK(crc32(map_bytes) == world.crc32);
  }
}
