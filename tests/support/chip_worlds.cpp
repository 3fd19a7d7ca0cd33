#include "support/chip_worlds.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "support/counts.h"
#include "support/random_up.h"
#include "support/ray_cases.h"

namespace thimble::tests {
namespace {

void fill(std::mt19937_64& random, ChipWorld world, int level, Octree* pool) {
  const int side = 1 << level;
  const bool is_deep = level > kMaxBrickMapLevel;
  const int materials = pick_int(random, 0, 2) == 0 ? 256 : is_deep && pick_int(random, 0, 1) == 0 ? 1 : 10;
  const auto material = [&] { return static_cast<std::uint8_t>(pick_int(random, 0, materials - 1)); };
  const auto insert = [&](const Vec3i& at) { REQUIRE(pool->insert(at, material()) == Status::kOk); };
  // Anywhere, or in a part of a large world, so that boxes are of every size.
  const int part = !is_deep || pick_int(random, 0, 2) == 0 ? side : pick_int(random, 8, side);
  Vec3i from;
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = pick_int(random, 0, 2) * (side - part) / 2;
  }
  const auto cell = [&] {
    return Vec3i{from.x + pick_int(random, 0, part - 1), from.y + pick_int(random, 0, part - 1),
                 from.z + pick_int(random, 0, part - 1)};
  };
  switch (world) {
    case ChipWorld::kHills: {
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
      for (int i = is_deep ? 50 : 0; i > 0; --i) {  // something far away
        insert({pick_int(random, 0, side - 1), pick_int(random, 0, side - 1), pick_int(random, 0, side - 1)});
      }
      return;
    }
    case ChipWorld::kBlocks:
    case ChipWorld::kMerged:
      for (int i = 0; i < 50; ++i) {
        const int block = pick_int(random, 0, level - 2);
        const Vec3i at = cell();
        const int mask = -(1 << block);
        REQUIRE(pool->insert_block({at.x & mask, at.y & mask, at.z & mask}, block, material()) ==
                Status::kOk);
      }
      for (int i = 0; i < 250; ++i) {
        insert(cell());
      }
      if (world == ChipWorld::kMerged) {
        REQUIRE(pool->coarsen_to(pool->nodes_used() / 2) == Status::kOk);
      }
      return;
    case ChipWorld::kDust:
      for (int i = pick_int(random, 1, is_deep ? 1500 : 300); i > 0; --i) {
        insert(cell());
      }
      return;
    case ChipWorld::kRoom:
    case ChipWorld::kTower: {  // walls all round, or a wall of single steps
      const int width = std::min(part, 64);
      for (int i = 0; i < width; ++i) {
        for (int k = 0; k < width; ++k) {
          const Vec3i walls[] = {{i, k, 0}, {i, 0, k}, {0, i, k}, {i, k, width - 1}, {width - 1, i, k}};
          for (int n = world == ChipWorld::kRoom ? 4 : 1; n >= 0; --n) {
            insert({from.x + walls[n].x, from.y + walls[n].y, from.z + walls[n].z});
          }
        }
        insert({from.x + i, from.y + i, from.z + i / 2});
      }
      return;
    }
    case ChipWorld::kCorners:
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

std::uint64_t pixels_to_draw(std::uint64_t longest, std::uint64_t slowly) {
  if (std::getenv("THIMBLE_LONG") != nullptr) {
    return longest;
  }
  return many_or_few<std::uint64_t>(1'000'000, slowly);
}

HeapBytes make_chip_tree(std::mt19937_64& random, ChipWorld world, int level) {
  OwnedPool pool(level, 150000);
  fill(random, world, level, &pool.octree);
  return compact_of(pool.octree, kMinRankShift);
}

MappedTree make_chip_scene(std::mt19937_64& random, ChipWorld world, int level) {
  return MappedTree(make_chip_tree(random, world, level));
}

MappedTree make_chip_scene(int level, const std::vector<Vec3i>& voxels) {
  OwnedPool pool(level, 100000);
  bool fits = true;  // one check for all: a check a voxel takes longer than what is tested with them
  for (const Vec3i& voxel : voxels) {
    fits = pool.octree.insert(voxel, 1) == Status::kOk && fits;
  }
  REQUIRE(fits);
  return MappedTree(compact_of(pool.octree, kMinRankShift));
}

int far_coordinate(std::mt19937_64& random, int level, int bits) {
  const int side_q8 = 256 << level;
  const int reach = (1 << (31 - bits)) - 32 * 256;
  const int kind = pick_int(random, 0, 4);
  const int at = kind == 0   ? side_q8 - reach
                 : kind == 1 ? reach
                 : kind == 2 ? side_q8 - pick_int(random, reach / 2, 2 * reach)
                 : kind == 3 ? pick_int(random, reach / 2, 2 * reach)
                             : pick_int(random, 0, side_q8);
  return std::clamp(at, kMinOriginWorlds * side_q8, kMaxOriginWorlds * side_q8);
}

bool takes_31_bits(const Camera& camera) {
  const int side_q8 = 256 << camera.level();
  int farthest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int eye = camera.eye()[axis].raw;
    farthest = std::max({farthest, eye, side_q8 - eye});
  }
  return (farthest >> (30 - camera.direction_bits())) == 1;
}

Camera hard_chip_camera(std::mt19937_64& random, int level) {
  const int side = 1 << level;
  const int side_q8 = 256 * side;
  for (;;) {
    const int place = pick_int(random, 0, 6);
    const int far_bits = pick_int(random, 13, 15);
    Vec3Q8 eye;
    for (int axis = 0; axis < 3; ++axis) {
      const int raw = place == 0   ? pick_int(random, -side_q8 / 2, side_q8 + side_q8 / 2)
                      : place == 1 ? 256 * pick_int(random, 0, side)
                      : place == 2 ? 256 * pick_int(random, 0, side) + pick_int(random, -1, 1)
                      : place == 3 ? 256 * pick_int(random, -side / 4, side + side / 4) + 128
                      : place == 6 ? far_coordinate(random, level, far_bits)
                                   : pick_int(random, 0, side_q8);
      eye[axis] = Q8::from_raw(raw);
    }
    Vec3i forward;
    const int look = pick_int(random, 0, 2);
    for (int axis = 0; axis < 3; ++axis) {
      forward[axis] = look == 0   ? pick_int(random, -1, 1)
                      : look == 1 ? pick_int(random, -1000, 1000)
                                  : pick_int(random, 0, side_q8) - eye[axis].raw;
    }
    const Vec3i up = random_up(random);
    const Q16 fov = Q16::from_raw(pick_int(random, 0, 2) == 0 ? pick_int(random, 65536, 8 * 65536)
                                                              : pick_int(random, 20 * 65536, 120 * 65536));
    const int width = pick_int(random, 0, 2) == 0 ? 320 : pick_int(random, 1, 250);
    const int height = width == 320 ? pick_int(random, 1, 80) : pick_int(random, 1, 120);
    const int bits = place == 6                    ? far_bits
                     : pick_int(random, 0, 3) == 0 ? pick_int(random, kMinDirectionBits, 15)
                                                   : 0;
    Camera camera;
    if (pick_int(random, 0, 15) == 0) {
      const OrthographicView view{eye,   forward, up, Q14::saturate(pick_int(random, 1, 2 * side)),
                                  width, height,  0};
      if (camera.set(view, level) == Status::kOk) {
        return camera;
      }
    } else if (camera.set(PerspectiveView{eye, forward, up, fov, width, height, bits}, level) ==
               Status::kOk) {
      return camera;
    }
  }
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
