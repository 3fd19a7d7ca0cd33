#include "support/deep_worlds.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "support/random_up.h"
#include "support/ray_cases.h"

namespace thimble::tests {
namespace {

void fill_deep(std::mt19937_64& random, DeepWorld world, int level, Octree* pool) {
  const int side = 1 << level;
  const int materials = pick_int(random, 0, 2) == 0 ? 256 : pick_int(random, 0, 1) == 0 ? 10 : 1;
  const auto material = [&] { return static_cast<std::uint8_t>(pick_int(random, 0, materials - 1)); };
  const auto insert = [&](const Vec3i& at) { REQUIRE(pool->insert(at, material()) == Status::kOk); };
  // Anywhere, or in a part of the world, so that boxes are of every size.
  const int part = pick_int(random, 0, 2) == 0 ? side : pick_int(random, 8, side);
  Vec3i from;
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = pick_int(random, 0, 2) * (side - part) / 2;
  }
  const auto cell = [&] {
    return Vec3i{from.x + pick_int(random, 0, part - 1), from.y + pick_int(random, 0, part - 1),
                 from.z + pick_int(random, 0, part - 1)};
  };
  switch (world) {
    case DeepWorld::kDust:
      for (int i = pick_int(random, 1, 1500); i > 0; --i) {
        insert(cell());
      }
      return;
    case DeepWorld::kBlocks:
    case DeepWorld::kMerged:
      insert_blocks(random, level, 60, 300, cell, material, pool);
      if (world == DeepWorld::kMerged) {
        REQUIRE(pool->coarsen_to(pool->nodes_used() / 2) == Status::kOk);
      }
      return;
    case DeepWorld::kTerrain: {
      const int width = std::min(part, 96);
      const int steep = pick_int(random, 1, 3);
      for (int x = 0; x < width; ++x) {
        for (int y = 0; y < width; ++y) {
          const int height = std::min(part - 1, (x * steep + y) / 4 + (x / 5 + y / 6) % 7);
          for (int z = std::max(0, height - 2); z <= height; ++z) {
            insert({from.x + x, from.y + y, from.z + z});
          }
        }
      }
      // Something far away.
      for (int i = 0; i < 50; ++i) {
        insert({pick_int(random, 0, side - 1), pick_int(random, 0, side - 1), pick_int(random, 0, side - 1)});
      }
      return;
    }
    case DeepWorld::kShell: {
      const int width = std::min(part, 64);
      for (int i = 0; i < width; ++i) {
        for (int k = 0; k < width; ++k) {
          const Vec3i walls[] = {{i, k, 0}, {i, 0, k}, {0, i, k}, {i, k, width - 1}, {width - 1, i, k}};
          for (const Vec3i& at : walls) {
            insert({from.x + at.x, from.y + at.y, from.z + at.z});
          }
        }
      }
      return;
    }
    case DeepWorld::kCorners:
      for (int corner = 0; corner < 8; ++corner) {
        insert({(corner & 1) * (side - 1), (corner >> 1 & 1) * (side - 1), (corner >> 2) * (side - 1)});
      }
      for (int i = 0; i < 40; ++i) {
        insert(cell());
      }
      return;
  }
}

// Often the least or the greatest from which frames go by the map; and beyond.
int far_deep_coordinate(std::mt19937_64& random, int side_q8) {
  const int reach = kMostDeepDistanceQ8 + pick_int(random, 0, 1);
  const int kind = pick_int(random, 0, 3);
  const int distance = kind < 2 ? reach : pick_int(random, reach / 2, 5 * reach / 2);
  const int at = kind % 2 == 0 ? distance : side_q8 - distance;
  return std::clamp(at, kMinOriginWorlds * side_q8, kMaxOriginWorlds * side_q8);
}

}  // namespace

HeapBytes make_deep_tree(std::mt19937_64& random, DeepWorld world, int level) {
  OwnedPool octree_pool(level, 150000);
  Octree& octree = octree_pool.octree;
  fill_deep(random, world, level, &octree);
  return compact_of(octree, kMinRankShift);
}

MappedTree make_deep_scene(std::mt19937_64& random, DeepWorld world, int level) {
  return MappedTree(make_deep_tree(random, world, level));
}

Camera hard_deep_camera(std::mt19937_64& random, const CompactTree& tree) {
  const int level = tree.level();
  const VoxelBox& box = tree.bounds();
  if (pick_int(random, 0, 3) == 0) {
    return hard_chip_camera(random, level);
  }
  const int side_q8 = 256 << level;
  for (;;) {
    Vec3Q8 eye;
    Vec3i forward;
    const int look = pick_int(random, 0, 5);
    const bool far = pick_int(random, 0, 3) == 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int kind = pick_int(random, 0, far ? 6 : 4);
      const int solid = pick_int(random, 256 * box.low[axis], 256 * box.high[axis]);
      eye[axis] = Q8::from_raw(kind == 0   ? 256 * pick_int(random, 0, 1 << level)
                               : kind == 1 ? pick_int(random, 0, 1) * side_q8 + pick_int(random, -256, 256)
                               : kind == 2 ? solid + pick_int(random, -40 * 256, 40 * 256)
                               : kind >= 5 ? far_deep_coordinate(random, side_q8)
                                           : pick_int(random, 0, side_q8));
      forward[axis] = look == 0 ? pick_int(random, -1, 1) : solid - eye[axis].raw;
    }
    const PerspectiveView view{eye,
                               forward,
                               random_up(random),
                               Q16::from_raw(pick_int(random, 65536, (look % 2 == 0 ? 15 : 120) * 65536)),
                               pick_int(random, 1, 120),
                               pick_int(random, 1, 60),
                               pick_int(random, 0, 1) == 0 ? 0 : pick_int(random, 11, 15)};
    Camera camera;
    if (camera.set(view, level) == Status::kOk) {
      return camera;
    }
  }
}

}  // namespace thimble::tests
