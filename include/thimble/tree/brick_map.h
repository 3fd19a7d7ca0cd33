/// @file brick_map.h
/// A table beside a compact tree that says at once what is solid around a point, for frames on small chips.
///
/// The tree is cut into bricks of 4 x 4 x 4 voxels. A directory over the bricks of the occupied box names the 64 bits
/// of each, or brick 0, which is empty. So a ray goes from voxel to voxel and never down the
/// tree; the tree is read only for the material of a hit, and only in bricks that show more than one material.
///
/// Like the tree, a map is bytes: position-independent, little-endian, baked into flash or built at start in
/// RAM. It belongs to one tree, whose checksum it carries. src/FORMAT.md has the layout,
/// src/picture/BRICKS.md, "Frames on a chip", the reasons.
///
/// A map does not change with its tree (build it anew). Worlds of level 9 and 10 have maps where the core is compiled
/// with THIMBLE_DEEP_WORLDS (hosts, and boards that can hold one); their directory has two levels.
#ifndef THIMBLE_TREE_BRICK_MAP_H
#define THIMBLE_TREE_BRICK_MAP_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "compact_tree.h"

namespace thimble {

/// Worlds of 4 to 256 voxels a side.
inline constexpr int kMinBrickMapLevel = 2;
inline constexpr int kMaxBrickMapLevel = 8;
/// Bricks are numbered in 16 bits.
inline constexpr uint32_t kMaxBricks = 65535;
/// Worlds of up to 1,024 voxels a side, with THIMBLE_DEEP_WORLDS.
inline constexpr int kMaxDeepMapLevel = 10;
/// The ink of a face is kept under its brick's number and 9 bits, in a word.
inline constexpr uint32_t kMaxDeepBricks = (uint32_t{1} << 23) - 1;
inline constexpr size_t kBrickMapHeaderBytes = 32;

/// Bytes of a map over a box of `cells` bricks (at most 64^3) that holds `bricks` different ones, the empty
/// one included, of which `mixed` show more than one material.
constexpr size_t brick_map_bytes(uint32_t cells, uint32_t bricks, uint32_t mixed) {
  return kBrickMapHeaderBytes + ((2 * size_t{cells} + 7) & ~size_t{7}) + 8 * size_t{bricks} +
         12 * size_t{mixed} + ((size_t{bricks} - 1 - mixed + 3) & ~size_t{3});
}

/// Bytes in which the map of any world of 2^level can be built, whatever is in it. A world of 64 with a model
/// in it seldom needs a fifth of them. 0 for a level beyond kMinBrickMapLevel .. kMaxBrickMapLevel.
constexpr size_t most_brick_map_bytes(int level) {
  if (level < kMinBrickMapLevel || level > kMaxBrickMapLevel) {
    return 0;
  }
  const uint32_t cells = uint32_t{1} << (3 * (level - 2));
  const uint32_t bricks = cells < kMaxBricks ? cells + 1 : kMaxBricks;
  return brick_map_bytes(cells, bricks, bricks - 1) + 2 * size_t{bricks};
}

/// Bytes in which the map of this tree can be built: for worlds of level 9 and 10 so many as its surface takes, counted
/// in one pass over it; for smaller ones those of any world. 0 where the core makes none.
size_t most_brick_map_bytes(const CompactTree& tree);

/// A view of a map's bytes, which outlive it. Copy it freely.
class BrickMap {
 public:
  BrickMap() = default;

  /// Looks at `bytes` (at least the map; more may follow), which start at a multiple of 8. Reads the header
  /// and the directory, about ten instructions a cell: from then on nothing outside the bytes is read,
  /// whatever the rest of them holds (src/LAWS.md, law 4). `kDamaged` for bytes that are no map,
  /// `kBadArgument` for an odd address; `map` is then as it was.
  static Status open(ConstBytes bytes, BrickMap* map);

  /// Reads every byte once. Returns nullptr for a sound map, otherwise a short English phrase.
  static const char* validate(ConstBytes bytes);

  /// Makes the map of `tree` at the front of `out` (at a multiple of 8) and opens it as `map` (null: only the
  /// bytes are wanted); `size` (may be null) gets its bytes. While it is being made it takes 2 bytes a brick
  /// more, and 8 for each that turns out to be solid through and of one material. Errors: `kOutOfRange`
  /// (level, more than kMaxBricks - 1 bricks or 65,280 nodes of level 2, 2^24 nodes), `kOutOfMemory`,
  /// `kBadArgument` (odd address). What `out` then holds is not a map. One pass over the tree, some 2,000
  /// instructions a brick on its surface, and cells times bricks that are shared or renumbered; stack below
  /// 1 KiB. Of level 9 and 10: nothing more than the map while it is being made, up to kMaxDeepBricks, three passes,
  /// nothing renumbered; stack below 3 KiB.
  static Status make(const CompactTree& tree, Bytes out, BrickMap* map, size_t* size = nullptr);

  /// Whether the map was made from that tree, as its checksum says.
  bool belongs_to(const CompactTree& tree) const;

  /// The checksum of its tree. That of a world which is edited counts the edits.
  uint32_t stamp() const { return tree_checksum_; }

  int level() const { return level_; }
  bool empty() const { return cells_ == 0; }
  size_t size_bytes() const { return size_bytes_; }
  /// Different bricks, the empty one included.
  uint32_t brick_count() const { return brick_count_; }
  /// The box that the directory covers, in bricks: all that is solid lies in it.
  const VoxelBox& box() const { return box_; }

  // What the renderer reads. Indices are checked by the caller or come from the directory.

  /// Entry x + y * side(x) + z * side(x) * side(y), relative to the box: the number of a brick. Of level 9 and 10: the
  /// table of pages (src/FORMAT.md).
  const uint8_t* directory() const { return directory_; }
  /// 8 bytes a brick: bit x + 4 y + 16 z is a solid voxel.
  const uint8_t* bricks() const { return bricks_; }
  /// Bricks 1 .. mixed_count() show more than one material; of level 9 and 10 they may.
  uint32_t mixed_count() const { return mixed_count_; }
  /// The material of voxel `bit` of brick `number` (1 .. brick_count() - 1), which is solid and on the
  /// surface.
  uint8_t material(const CompactTree& tree, uint32_t number, unsigned bit) const {
    return number > mixed_count_ ? materials_[number - mixed_count_ - 1] : mixed_material(tree, number, bit);
  }

 private:
  friend class EditedWorld;
  friend struct DeepWorld;
  friend struct DeepMap;

  uint8_t mixed_material(const CompactTree& tree, uint32_t number, unsigned bit) const;

  const uint8_t* directory_ = nullptr;
  const uint8_t* bricks_ = nullptr;
  const uint8_t* origins_ = nullptr;
  const uint8_t* materials_ = nullptr;
  VoxelBox box_;
  size_t size_bytes_ = 0;
  uint32_t cells_ = 0;
  uint32_t brick_count_ = 0;
  uint32_t mixed_count_ = 0;  // of level 9 and 10 that of all bricks: `mixed_material` tells them apart
  uint32_t tree_checksum_ = 0;
  uint8_t level_ = 0;
};

}  // namespace thimble

#endif
