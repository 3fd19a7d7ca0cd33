#include "support/chip_worlds.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

#include "support/counts.h"
#include "support/random_up.h"
#include "support/ray_cases.h"

namespace thimble::tests {
namespace {

void fill_hills(std::mt19937_64& random, int side, Octree* pool) {
  const int steep = pick_int(random, 1, 3);
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      const int height = side / 4 + (x * steep + y * 2) % 7 + (x / 5 + y / 6) % 5;
      for (int z = std::max(0, height - 4); z < std::min(side, height); ++z) {
        REQUIRE(pool->insert({x, y, z}, static_cast<std::uint8_t>((x + y + z) % 5)) == Status::kOk);
      }
    }
  }
}

void fill(std::mt19937_64& random, ChipWorld world, int level, Octree* pool) {
  const int side = 1 << level;
  const auto cell = [&] {
    return Vec3i{pick_int(random, 0, side - 1), pick_int(random, 0, side - 1), pick_int(random, 0, side - 1)};
  };
  const int materials = pick_int(random, 0, 2) == 0 ? 256 : 10;
  const auto material = [&] { return static_cast<std::uint8_t>(pick_int(random, 0, materials - 1)); };
  switch (world) {
    case ChipWorld::kHills:
      fill_hills(random, side, pool);
      return;
    case ChipWorld::kBlocks:
    case ChipWorld::kMerged:
      insert_blocks(random, level, 40, 200, cell, material, pool);
      if (world == ChipWorld::kMerged) {
        REQUIRE(pool->coarsen_to(pool->nodes_used() / 2) == Status::kOk);
      }
      return;
    case ChipWorld::kDust:
      for (int i = 0; i < 300; ++i) {
        REQUIRE(pool->insert(cell(), material()) == Status::kOk);
      }
      return;
    case ChipWorld::kRoom:
    case ChipWorld::kTower:  // walls all round, or a wall of single steps
      for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
          const Vec3i voxels[] = {{i, j, 0}, {i, 0, j}, {0, i, j}, {i, j, side - 1}, {side - 1, i, j}};
          const int count = world == ChipWorld::kRoom ? 5 : 2;
          for (int n = 0; n < count; ++n) {
            REQUIRE(pool->insert(voxels[n], material()) == Status::kOk);
          }
        }
        REQUIRE(pool->insert({i, i, i / 2}, material()) == Status::kOk);
      }
      return;
  }
}

template <class Fill>
MappedTree filled_scene(int level, const Fill& fill_pool) {
  OwnedPool owned(level, 100000);
  Octree& pool = owned.octree;
  fill_pool(&pool);
  return MappedTree(compact_of(pool, kMinRankShift));
}

}  // namespace

std::uint64_t pixels_to_draw(std::uint64_t longest, std::uint64_t slowly) {
  if (std::getenv("THIMBLE_LONG") != nullptr) {
    return longest;
  }
  return many_or_few<std::uint64_t>(1'000'000, slowly);
}

void insert_blocks(std::mt19937_64& random, int level, int blocks, int voxels,
                   const std::function<Vec3i()>& cell, const std::function<std::uint8_t()>& material,
                   Octree* pool) {
  for (int i = 0; i < blocks; ++i) {
    const int block = pick_int(random, 0, level - 2);
    const Vec3i at = cell();
    const int mask = ~((1 << block) - 1);
    REQUIRE(pool->insert_block({at.x & mask, at.y & mask, at.z & mask}, block, material()) == Status::kOk);
  }
  for (int i = 0; i < voxels; ++i) {
    REQUIRE(pool->insert(cell(), material()) == Status::kOk);
  }
}

MappedTree make_chip_scene(std::mt19937_64& random, ChipWorld world, int level) {
  return filled_scene(level, [&](Octree* pool) { fill(random, world, level, pool); });
}

MappedTree make_chip_scene(int level, const std::vector<Vec3i>& voxels) {
  return filled_scene(level, [&](Octree* pool) {
    bool fits = true;  // one check for all: a check a voxel takes longer than what is tested with them
    for (const Vec3i& voxel : voxels) {
      fits = pool->insert(voxel, 1) == Status::kOk && fits;
    }
    REQUIRE(fits);
  });
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

}  // namespace thimble::tests
