#include "support/hard_frames.h"

#include <cmath>

#include "support/random_up.h"

namespace thimble::tests {
namespace {

std::int32_t number(std::mt19937_64& random, std::int64_t low, std::int64_t high) {
  return pick_int(random, low, high);
}

// Something solid within some forty voxels, around where cubes of entries meet if the world has several: boxes,
// balls and stairs, now and then with holes.
void fill_solidly(std::mt19937_64& random, int level, Octree* octree) {
  const std::int32_t side = std::int32_t{1} << level;
  const std::int32_t size = std::min(side, 40);
  Vec3i low{};
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] =
        side > 1024 ? 1024 * number(random, 1, (side >> 10) - 1) - size / 2 : number(random, 0, side - size);
  }
  const bool is_colored = pick(random, 0, 1) == 0;
  const std::int64_t holes = pick(random, 0, 1) == 0 ? 0 : pick(random, 1, 30);
  for (std::int64_t part = pick(random, 1, 3); part > 0; --part) {
    const std::int64_t kind = pick(random, 0, 3);
    const Vec3i middle = random_voxel(random, 0, size - 1);
    const std::int32_t radius = number(random, 1, size / 2);
    for (std::int32_t z = 0; z < size; ++z) {
      for (std::int32_t y = 0; y < size; ++y) {
        for (std::int32_t x = 0; x < size; ++x) {
          const Vec3i from{x - middle.x, y - middle.y, z - middle.z};
          const std::int32_t farthest = std::max({std::abs(from.x), std::abs(from.y), std::abs(from.z)});
          const bool is_solid = kind == 0 ? farthest <= radius
                                : kind == 1
                                    ? from.x * from.x + from.y * from.y + from.z * from.z < radius * radius
                                : kind == 2 ? x + y <= z + middle.x  // stairs
                                            : z <= middle.z / 2;
          if (is_solid && pick(random, 0, 999) >= holes) {
            const auto material =
                static_cast<std::uint8_t>(is_colored ? 1 + (x / 5 + 3 * (y / 7) + z) % 9 : 1);
            (void)octree->insert({low.x + x, low.y + y, low.z + z}, material);
          }
        }
      }
    }
  }
}

// A point on the lattice or off it, in what is solid or near.
Vec3Q8 hard_point(std::mt19937_64& random, const WideScene& scene) {
  const VoxelBox& bounds = scene.tree.bounds();
  Vec3Q8 point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t raw =
        pick(random, std::int64_t{256} * (bounds.low[axis] - 3), std::int64_t{256} * (bounds.high[axis] + 3));
    point[axis] = Q8::from_raw(static_cast<std::int32_t>(pick(random, 0, 2) == 0 ? raw : raw / 256 * 256));
  }
  return point;
}

// Along axes, and diagonals of faces and of cubes.
Vec3i hard_direction(std::mt19937_64& random) {
  Vec3i direction{};
  while (direction == Vec3i{}) {
    direction = random_voxel(random, -1, 1);
  }
  return direction;
}

}  // namespace

WideScene solid_scene(std::mt19937_64& random, int level, wide::ListKind kind) {
  return make_scene(
      level, [&](Octree* octree) { fill_solidly(random, level, octree); }, std::size_t{8} << 20, kind);
}

bool hard_camera(std::mt19937_64& random, const WideScene& scene, Camera* camera) {
  const Vec3i along = pick(random, 0, 3) == 0 ? random_voxel(random, -9, 9) : hard_direction(random);
  if (along == Vec3i{}) {
    return false;
  }
  Vec3Q8 eye = hard_point(random, scene);
  const std::int32_t width = number(random, 20, 90);
  if (pick(random, 0, 1) == 0) {
    OrthographicView view;
    if (pick(random, 0, 2) != 0) {  // outside
      for (int axis = 0; axis < 3; ++axis) {
        eye[axis] = Q8::from_raw(eye[axis].raw - along[axis] * 256 * 60);
      }
    }
    view.eye = eye;
    view.forward = along;
    view.up = random_up(random);
    // Pixels of a part of a voxel to some, lattice points among them.
    const std::int32_t parts = number(random, 1, 12);
    view.span = Q14::from_raw(width * Q14::kOne / parts);
    if (pick(random, 0, 2) == 0) {
      view.span = Q14::from_raw(static_cast<std::int32_t>(width * Q14::kOne / std::sqrt(2.0) / parts));
    }
    view.width_px = width;
    view.height_px = number(random, 10, 60);
    return camera->set(view, scene.level) == Status::kOk;
  }
  PerspectiveView view;
  view.eye = eye;
  view.forward = along;
  view.up = random_up(random);
  view.fov_degrees = Q16::from_raw(number(random, 5, 120) * 65536);
  view.width_px = width;
  view.height_px = number(random, 10, 60);
  if (pick(random, 0, 1) == 0) {
    view.direction_bits = number(random, 8, 12);  // few directions, so many ties
  }
  return camera->set(view, scene.level) == Status::kOk;
}

}  // namespace thimble::tests
