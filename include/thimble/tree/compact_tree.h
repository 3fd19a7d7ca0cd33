/// @file compact_tree.h
/// The read-only octree that is traced: one byte a node, no pointers, ready for flash.
///
/// Nodes are child masks in breadth-first order; the k-th set bit of all masks, counted from the first node
/// on, is the (k+1)-th node, so a child's place follows from counting bits. A directory of running counts
/// (one 32-bit word each 2^rank_shift nodes) keeps that count short. A mask of 0 is a block that is solid
/// through. The masks of level 1, the last ones, are 2 x 2 x 2 voxels. src/FORMAT.md gives every byte.
///
/// The bytes are position-independent and little-endian. They are made from an `Octree` (octree.h) or from
/// sorted Morton keys; both ways give the same bytes for the same voxels.
#ifndef THIMBLE_TREE_COMPACT_TREE_H
#define THIMBLE_TREE_COMPACT_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"

namespace thimble {

class Octree;

/// How many nodes share one count of the directory, as a power of two: 2^6 costs 1/16 byte a node; a smaller
/// block costs more bytes and fewer instructions a step down.
inline constexpr int kMinRankShift = 3;
inline constexpr int kMaxRankShift = 10;
inline constexpr int kDefaultRankShift = 6;
/// Bytes before the first mask.
inline constexpr size_t kCompactHeaderBytes = 56;

/// What a compact tree will hold: everything that decides its size.
struct CompactShape {
  int level = kMinLevel;  ///< world of 2^level voxels a side
  int rank_shift = kDefaultRankShift;
  uint32_t nodes = 0;           ///< masks; 0 for an empty world
  uint32_t solid_blocks = 0;    ///< masks that are 0
  uint32_t voxel_bits = 0;      ///< set bits in the masks of level 1
  bool many_materials = false;  ///< more than one material: one byte for each solid block and voxel bit
  bool merged = false;          ///< made by coarsening: one bit a node
};

/// Exact size in bytes of a compact tree of that shape; 0 when it would exceed 2^32 - 1 bytes.
constexpr size_t compact_bytes(const CompactShape& shape) {
  const uint64_t nodes = shape.nodes;
  const uint64_t blocks = (nodes + (uint64_t{1} << shape.rank_shift) - 1) >> shape.rank_shift;
  uint64_t bytes = kCompactHeaderBytes + ((nodes + 3) & ~uint64_t{3}) + 4 * blocks;
  if (shape.merged) {
    bytes += ((nodes + 31) >> 5) * 4;
  }
  if (shape.many_materials) {
    if (shape.solid_blocks != 0) {
      bytes += 4 * blocks;
    }
    bytes += (uint64_t{shape.solid_blocks} + shape.voxel_bits + 3) & ~uint64_t{3};
  }
  return bytes <= UINT32_MAX && bytes <= SIZE_MAX ? static_cast<size_t>(bytes) : 0;
}

/// A view of a compact tree's bytes, which outlive it. Copy it freely.
///
/// `open` checks the header and that all sections lie within the bytes: from then on tracing reads nothing
/// outside them and ends, whatever they hold (src/LAWS.md, law 4). `validate` says if all is right.
class CompactTree {
 public:
  CompactTree() = default;

  /// Writes `octree` as a compact tree to the front of `out` and opens it as `tree` (null: only the bytes are
  /// wanted). `size` (may be null) gets the tree's bytes, also when `out` is too small. No memory besides;
  /// `level + 1` passes over the nodes. Errors, with nothing written: `kOutOfMemory`, `kOutOfRange`
  /// (rank_shift).
  static Status make(const Octree& octree, Bytes out, CompactTree* tree, size_t* size = nullptr,
                     int rank_shift = kDefaultRankShift);
  /// The same in an arena, which gives just the bytes that the tree takes; after an error it is as it was.
  static Status make(const Octree& octree, Arena& arena, CompactTree* tree,
                     int rank_shift = kDefaultRankShift);

  /// Joins the parts of a larger world: `parts` are 8^n trees of one level (n at least 0), which fill a world
  /// of n levels more in Morton order (the first the octant at the lowest corner); an empty tree is an empty
  /// part. The result is what the whole world's octree would have given. `out` must not overlap the parts;
  /// `out`, `tree` and `size` are as above. Level passes over the parts. Also `kBadArgument` for another
  /// number of parts or unequal levels, `kOutOfRange` beyond kMaxLevel.
  static Status make(Span<const CompactTree> parts, Bytes out, CompactTree* tree, size_t* size = nullptr,
                     int rank_shift = kDefaultRankShift);

  /// Writes voxels given by sorted, unique Morton keys (`sort_keys`, `unique_keys`). 32-bit keys
  /// are bare Morton codes (levels to 10; all voxels get `material`); 64-bit keys hold the code in bits 8 up
  /// and the material in bits 0..7. `out`, `tree` and `size` are as above. Two passes over the keys, no
  /// memory besides.
  static Status make(Span<const uint32_t> keys, int level, uint8_t material, Bytes out, CompactTree* tree,
                     size_t* size = nullptr, int rank_shift = kDefaultRankShift);
  static Status make(Span<const uint64_t> keys, int level, Bytes out, CompactTree* tree,
                     size_t* size = nullptr, int rank_shift = kDefaultRankShift);

  /// Looks at `bytes` (at least the tree; more may follow). Constant time. On anything but `kOk`
  /// (`kDamaged`), `tree` is as it was.
  static Status open(ConstBytes bytes, CompactTree* tree);

  /// Reads every byte once: checksum, directory, node count by level, bounds, voxel count. Returns nullptr
  /// for a sound tree, otherwise a short English phrase saying what is wrong. `place` (may be null) gets the
  /// number of the node concerned, or the byte offset for faults of the header.
  static const char* validate(ConstBytes bytes, uint32_t* place = nullptr);

  int level() const { return level_; }
  int rank_shift() const { return rank_shift_; }
  /// Whether nodes stand breadth first without gaps, as in all bytes that `open` takes: not in an edited world of level 9 and
  /// 10 (edited_world.h), in which each node counts for itself. Tracing reads either.
  bool nodes_in_order() const { return rank_shift_ >= kMinRankShift; }
  bool empty() const { return node_count_ == 0; }
  uint32_t node_count() const { return node_count_; }
  /// Solid volume in voxels, merged blocks included.
  uint64_t voxel_count() const;
  /// Voxels that coarsening added (src/LAWS.md, law 1), 0 for an exact tree.
  uint64_t solid_added() const;
  bool many_materials() const { return materials_ != nullptr; }
  bool merged() const { return merged_bits_ != nullptr; }
  uint8_t uniform_material() const { return uniform_material_; }
  /// The least box of voxels that holds everything solid.
  const VoxelBox& bounds() const { return bounds_; }
  size_t size_bytes() const { return size_bytes_; }
  const uint8_t* bytes() const { return base_; }

  // What the tracer and other readers of the nodes need. Indices are checked by the caller: index <
  // node_count().

  /// The child mask of node `index`; 0 is a solid block.
  uint8_t mask(uint32_t index) const { return masks_[index]; }
  /// The number of the first child of node `index`. At level 1 the "children" are voxels, numbered on from
  /// node_count(). May be anything in a damaged tree.
  uint32_t first_child(uint32_t index) const;
  /// Whether the solid block `index` was made by coarsening.
  bool is_merged(uint32_t index) const {
    return merged_bits_ != nullptr && ((uint32_t{merged_bits_[index >> 3]} >> (index & 7U)) & 1U) != 0;
  }
  /// Material of the solid block `index`.
  uint8_t block_material(uint32_t index) const;
  /// Solid blocks before node `index`, in node order; 0 in a tree of one material.
  uint32_t blocks_before(uint32_t index) const;
  /// Material of the solid block that has so many before it.
  uint8_t material_of_block(uint32_t number) const {
    return materials_ == nullptr    ? uniform_material_
           : number < solid_blocks_ ? materials_[number]
                                    : uint8_t{0};
  }
  /// The masks, one a node. Three bytes behind the last one may be read.
  const uint8_t* masks() const { return masks_; }
  /// Materials of the solid blocks, then of the voxels; empty in a tree of one.
  ConstBytes materials() const {
    return {materials_, materials_ == nullptr ? size_t{0} : size_t{solid_blocks_} + voxel_bits_};
  }
  /// Material of the voxel numbered `number` (`first_child` of a level-1 node and on).
  uint8_t voxel_material(uint32_t number) const;

 private:
  friend class EditedWorld;
  friend struct DeepWorld;

  const uint8_t* base_ = nullptr;
  const uint8_t* masks_ = nullptr;
  const uint8_t* ranks_ = nullptr;
  const uint8_t* merged_bits_ = nullptr;
  const uint8_t* block_ranks_ = nullptr;
  const uint8_t* materials_ = nullptr;
  uint32_t node_count_ = 0;
  uint32_t solid_blocks_ = 0;
  uint32_t voxel_bits_ = 0;
  size_t size_bytes_ = 0;
  VoxelBox bounds_;
  uint8_t level_ = kMinLevel;
  uint8_t rank_shift_ = kDefaultRankShift;
  uint8_t uniform_material_ = 0;
};

/// The shape of the compact tree that `CompactTree::make` would write: one pass over the nodes.
CompactShape compact_shape(const Octree& octree, int rank_shift = kDefaultRankShift);

// Morton codes: a voxel's three indices interleaved (x in the lowest bit of each group of three), so that
// sorted codes are the voxels in the order of the octree's leaves; and a sort for them in place.

/// Code of the voxel (x, y, z), each 0 .. 2^21 - 1; 3 * level bits for a voxel of a world of that level.
constexpr uint64_t morton_code(uint32_t x, uint32_t y, uint32_t z) {
  uint64_t code = 0;
  const uint32_t part[3] = {x, y, z};
  for (int axis = 0; axis < 3; ++axis) {
    uint64_t spread = part[axis] & 0x1FFFFFU;
    spread = (spread | spread << 32) & 0x001F00000000FFFFULL;
    spread = (spread | spread << 16) & 0x001F0000FF0000FFULL;
    spread = (spread | spread << 8) & 0x100F00F00F00F00FULL;
    spread = (spread | spread << 4) & 0x10C30C30C30C30C3ULL;
    spread = (spread | spread << 2) & 0x1249249249249249ULL;
    code |= spread << axis;
  }
  return code;
}

/// The voxel of a code.
constexpr Vec3i morton_voxel(uint64_t code) {
  Vec3i voxel;
  for (int axis = 0; axis < 3; ++axis) {
    uint64_t packed = (code >> axis) & 0x1249249249249249ULL;
    packed = (packed | packed >> 2) & 0x10C30C30C30C30C3ULL;
    packed = (packed | packed >> 4) & 0x100F00F00F00F00FULL;
    packed = (packed | packed >> 8) & 0x001F0000FF0000FFULL;
    packed = (packed | packed >> 16) & 0x001F00000000FFFFULL;
    packed = (packed | packed >> 32) & 0x1FFFFFU;
    voxel[axis] = static_cast<int32_t>(packed);
  }
  return voxel;
}

/// Sorts `keys` (fewer than 2^32) in place, ascending, by their lowest `key_bits` bits (the others are
/// equal). American flag sort, the most significant 6 bits first, 512 bytes of stack, no recursion: the runs
/// of one pass are found again by their common prefix in the next. Cost: at most key_bits / 6 + 1 passes,
/// linear. Source: McIlroy, Bostic, McIlroy, "Engineering Radix Sort", Computing Systems 6(1), 1993.
void sort_keys(Span<uint32_t> keys, int key_bits);
void sort_keys(Span<uint64_t> keys, int key_bits);

/// Drops repeats from sorted keys and returns how many are left, at the front. Of 64-bit keys with a material
/// in bits 0..7 one a voxel is kept, that with the greatest material index.
size_t unique_keys(Span<uint32_t> keys);
size_t unique_keys(Span<uint64_t> keys);

}  // namespace thimble

#endif
