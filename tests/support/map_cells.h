/// Brick maps read by src/FORMAT.md alone.
#pragma once

#include <cstdint>

#include "thimble/tree/brick_map.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tests {

inline std::uint32_t word_at(const std::uint8_t* bytes) {
  return bytes[0] | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
         std::uint32_t{bytes[3]} << 24;
}

/// The number of the brick at a place of the map's box; of maps of level 9 and 10 the place is in pages.
inline std::uint32_t brick_at(const BrickMap& map, const Vec3i& place) {
  if (map.level() <= kMaxBrickMapLevel) {
    const VoxelBox& box = map.box();
    const Vec3i side{box.high.x - box.low.x, box.high.y - box.low.y, 0};
    const std::uint8_t* const entry = map.directory() + 2 * ((place.z * side.y + place.y) * side.x + place.x);
    return entry[0] | std::uint32_t{entry[1]} << 8;
  }
  const int page = place.x / 4 + place.y / 4 * 64 + place.z / 4 * 4096;
  const std::uint8_t* const at = map.directory() + word_at(map.directory() + 4 * page);
  const std::uint32_t own = at[4 + place.x % 4 + 4 * (place.y % 4) + 16 * (place.z % 4)];
  return own == 0 ? 0 : word_at(at) + own;
}

struct MapCell {
  std::uint32_t brick;
  unsigned bit;
  bool is_solid;
};
inline MapCell cell_of(const BrickMap& map, const Vec3i& voxel) {
  Vec3i place;
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] = (voxel[axis] >> 2) - map.box().low[axis];
    if (place[axis] < 0 || (voxel[axis] >> 2) >= map.box().high[axis]) {
      return {0, 0, false};
    }
  }
  const std::uint32_t brick = brick_at(map, place);
  const auto bit = static_cast<unsigned>((voxel.x & 3) | (voxel.y & 3) << 2 | (voxel.z & 3) << 4);
  return {brick, bit, (map.bricks()[8 * std::size_t{brick} + bit / 8] >> (bit % 8) & 1) != 0};
}

/// How many voxels of the world stand otherwise in its map than `material_of` says, which gives -1 where nothing is:
/// whether they are solid, and their material where a neighbour is empty, or anywhere.
template <class Material>
int wrong_cells(const BrickMap& map, const CompactTree& tree, const Material& material_of,
                bool hidden_too = false) {
  const std::int32_t side = std::int32_t{1} << tree.level();
  int wrong = map.belongs_to(tree) ? 0 : 1;
  for (std::int32_t i = 0; i < side * side * side; ++i) {
    const Vec3i at{i % side, i / side % side, i / side / side};
    const MapCell cell = cell_of(map, at);
    const int material = material_of(at);
    bool is_seen = hidden_too;
    for (int face = 0; face < 6; ++face) {
      Vec3i next = at;
      next[face / 2] += face % 2 != 0 ? 1 : -1;
      is_seen = is_seen || next[face / 2] < 0 || next[face / 2] >= side || material_of(next) < 0;
    }
    wrong += cell.is_solid != (material >= 0) ||
                     (material >= 0 && is_seen && map.material(tree, cell.brick, cell.bit) != material)
                 ? 1
                 : 0;
  }
  return wrong;
}

}  // namespace thimble::tests
