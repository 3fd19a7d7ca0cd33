#include "gpu/scene_words.h"

#include <algorithm>
#include <cstdlib>

#include "gpu/kernel/parameters.h"

namespace thimble::gpu {

using namespace kernel;

SceneWords make_scene_words(const CompactTree& tree) {
  SceneWords scene;
  scene.level = tree.level();
  set_tree(tree, &scene.parameters);
  // Bytes as words, the lowest byte first.
  scene.words.resize(kSceneTree + (tree.size_bytes() + 3) / 4);
  for (std::size_t i = 0; i < tree.size_bytes(); ++i) {
    scene.words[kSceneTree + i / 4] |= std::uint32_t{tree.bytes()[i]} << (8 * (i % 4));
  }
  return scene;
}

void set_palette(Span<const Rgb8> palette, std::uint32_t* words) {
  for (std::size_t i = 0; i < std::min<std::size_t>(palette.size, kSceneTree); ++i) {
    const Rgb8 color = palette[i];
    words[i] = std::uint32_t{color.r} | std::uint32_t{color.g} << 8 | std::uint32_t{color.b} << 16;
  }
}

void set_places(std::uint32_t count, std::uint32_t width, Parameters* parameters) {
  Parameters& to = *parameters;
  to[kPlaces] = count;
  to[kWidth] = width;
  to[kHeight] = (count + width - 1) / width;
}

void set_rays(std::uint32_t count, std::uint32_t width, Parameters* parameters) {
  Parameters& to = *parameters;
  to[kMode] = kModeRays;
  to[kRayCount] = count;
  to[kWidth] = width;
  to[kHeight] = (count + width - 1) / width;
}

void set_record(const Ray& ray, std::uint32_t* record) {
  for (int axis = 0; axis < 3; ++axis) {
    record[axis] = static_cast<std::uint32_t>(ray.origin[axis].raw);
    record[3 + axis] = static_cast<std::uint32_t>(ray.direction[axis]);
  }
}

Hit hit_of_record(const std::uint32_t* record) {
  Hit hit;
  hit.kind = static_cast<HitKind>(record[0] & 255U);
  hit.axis = static_cast<std::int8_t>(static_cast<int>(record[0] >> 8 & 255U) - 1);
  hit.material = static_cast<std::uint8_t>(record[0] >> 16);
  hit.block_level = static_cast<std::uint8_t>(record[0] >> 24);
  for (int axis = 0; axis < 3; ++axis) {
    hit.voxel[axis] = static_cast<std::int32_t>(record[1 + axis]);
  }
  hit.t_numerator = static_cast<std::int32_t>(record[4]);
  hit.t_denominator = static_cast<std::int32_t>(record[5]);
  hit.visits = record[6];
  return hit;
}

Vec3i largest_direction(Span<const Ray> rays) {
  Vec3i largest;
  for (std::size_t i = 0; i < rays.size; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      largest[axis] = std::max(largest[axis], std::abs(rays[i].direction[axis]));
    }
  }
  return largest;
}

}  // namespace thimble::gpu
