// The bytes of a compact tree: opening, checking, counting children. src/FORMAT.md is the specification; the
// header offsets below are its constants.
#include "thimble/tree/compact_tree.h"

#include "../base/bits.h"
#include "../base/fault.h"
#include "../base/hot.h"
#include "compact_header.h"
#include "thimble/base/memory.h"

namespace thimble {
namespace {

// The header's fields as a shape, or a phrase saying which field is wrong.
const char* read_compact_header(ConstBytes bytes, CompactShape* shape, uint32_t* place) {
  using namespace compact_header;
  if (bytes.size < kCompactHeaderBytes) {
    return fault(place, 0, "shorter than a header");
  }
  const uint8_t* base = bytes.data;
  if (const uint32_t differ = bits::load32(base) ^ kMagic) {
    return fault(place, 0, (differ & kMagicMask) == 0 ? kAnotherVersion : "not a compact tree");
  }
  shape->level = base[kLevelOffset];
  shape->rank_shift = base[kRankShiftOffset];
  const unsigned flags = base[kFlagsOffset];
  if (shape->level < kMinLevel || shape->level > kMaxLevel) {
    return fault(place, kLevelOffset, "level out of range");
  }
  if (shape->rank_shift < kMinRankShift || shape->rank_shift > kMaxRankShift) {
    return fault(place, kRankShiftOffset, "directory block size out of range");
  }
  if ((flags & ~kKnownFlags) != 0) {
    return fault(place, kFlagsOffset, "unknown flag");
  }
  shape->many_materials = (flags & kManyMaterialsFlag) != 0;
  shape->merged = (flags & kMergedFlag) != 0;
  shape->nodes = bits::load32(base + kNodesOffset);
  shape->solid_blocks = bits::load32(base + kSolidBlocksOffset);
  shape->voxel_bits = bits::load32(base + kVoxelBitsOffset);
  const size_t size = bits::load32(base + kSizeOffset);
  // compact_bytes is 0 for counts beyond all bytes, which a size of 0 must not agree with.
  if (size == 0 || size != compact_bytes(*shape)) {
    return fault(place, kSizeOffset, "size does not match the counts");
  }
  if (size > bytes.size) {
    return fault(place, kSizeOffset, "truncated");
  }
  if (!has_sound_bounds(base, shape->nodes == 0, shape->level)) {
    return fault(place, static_cast<uint32_t>(kBoundsMinOffset), "bounds outside the world");
  }
  return nullptr;
}

}  // namespace

// The solid voxels of a tree whose masks are sound, depth first; `bounds` gets the least box that holds them.
uint64_t solid_volume(const CompactTree& tree, VoxelBox* bounds) {
  if (tree.empty()) {
    return 0;
  }
  uint64_t volume = 0;
  walk_leaves(tree, 1, [&](uint32_t node, const Vec3i& corner, int level) {
    const uint8_t mask = tree.mask(node);
    volume += mask == 0 ? uint64_t{1} << (3 * level) : bits::popcount8(mask);
    grow_box(bounds, corner, level, mask);
    return true;
  });
  return volume;
}

Status CompactTree::open(ConstBytes bytes, CompactTree* tree) {
  using namespace compact_header;
  CompactShape shape;
  if (read_compact_header(bytes, &shape, nullptr) != nullptr) {
    return Status::kDamaged;
  }
  const uint8_t* base = bytes.data;
  CompactTree result;
  result.base_ = base;
  result.size_bytes_ = bits::load32(base + kSizeOffset);
  result.level_ = static_cast<uint8_t>(shape.level);
  result.rank_shift_ = static_cast<uint8_t>(shape.rank_shift);
  result.uniform_material_ = base[kMaterialOffset];
  result.node_count_ = shape.nodes;
  result.solid_blocks_ = shape.solid_blocks;
  result.voxel_bits_ = shape.voxel_bits;
  load_bounds(base, &result.bounds_);
  const CompactSections sections = sections_of(shape);
  result.masks_ = base + sections.masks;
  result.ranks_ = base + sections.ranks;
  if (shape.merged) {
    result.merged_bits_ = base + sections.merged;
  }
  if (shape.many_materials) {
    if (shape.solid_blocks != 0) {
      result.block_ranks_ = base + sections.block_ranks;
    }
    result.materials_ = base + sections.materials;
  }
  *tree = result;
  return Status::kOk;
}

uint64_t CompactTree::voxel_count() const {
  using namespace compact_header;
  return base_ == nullptr ? 0 : bits::load64(base_ + kVoxelCountOffset);
}
uint64_t CompactTree::solid_added() const {
  using namespace compact_header;
  return base_ == nullptr ? 0 : bits::load64(base_ + kSolidAddedOffset);
}

uint32_t CompactTree::first_child(uint32_t index) const {
  const uint32_t block = index >> rank_shift_;
  uint32_t at = block << rank_shift_;
  uint32_t count = 1 + bits::load32(ranks_ + 4 * size_t{block});
  // Whole words first, then the part of a word before `index`. Reading past the last mask stays within the
  // directory, which follows the masks.
#if defined(__POPCNT__)
  for (; at + 8 <= index; at += 8) {
    count += static_cast<uint32_t>(__builtin_popcountll(bits::load64(masks_ + at)));
  }
  const uint64_t before = (uint64_t{1} << (8 * (index - at))) - 1;
  return count + static_cast<uint32_t>(__builtin_popcountll(bits::load64(masks_ + at) & before));
#else
  for (; at + 4 <= index; at += 4) {
    count += bits::popcount32(bits::load32(masks_ + at));
  }
  const uint32_t before = (uint32_t{1} << (8 * (index - at))) - 1;
  return count + bits::popcount32(bits::load32(masks_ + at) & before);
#endif
}

uint32_t CompactTree::blocks_before(uint32_t index) const {
  if (block_ranks_ == nullptr) {
    return 0;
  }
  const uint32_t block = index >> rank_shift_;
  uint32_t number = bits::load32(block_ranks_ + 4 * size_t{block});
  for (uint32_t at = block << rank_shift_; at < index; ++at) {
    number += masks_[at] == 0 ? 1U : 0U;
  }
  return number;
}

uint8_t CompactTree::block_material(uint32_t index) const {
  if (materials_ == nullptr || block_ranks_ == nullptr) {
    return uniform_material_;
  }
  return material_of_block(blocks_before(index));
}

[[THIMBLE_HOT]] uint8_t CompactTree::voxel_material(uint32_t number) const {
  if (materials_ == nullptr) {
    return uniform_material_;
  }
  const uint32_t voxel = number - node_count_;
  return voxel < voxel_bits_ ? materials_[solid_blocks_ + voxel] : 0;
}

const char* CompactTree::validate(ConstBytes bytes, uint32_t* place) {
  using namespace compact_header;
  CompactShape shape;
  if (const char* text = read_compact_header(bytes, &shape, place)) {
    return text;
  }
  const uint8_t* base = bytes.data;
  const uint32_t size = bits::load32(base + kSizeOffset);
  if (checksum_around(base, size, kChecksumOffset) != bits::load32(base + kChecksumOffset)) {
    return fault(place, kChecksumOffset, "checksum does not match");
  }
  CompactTree tree;
  if (open(bytes, &tree) != Status::kOk) {
    return fault(place, 0, "not a compact tree");
  }

  // Level by level: each set bit is a node of the next level, and the directory counts them.
  uint32_t index = 0;
  uint64_t children = 0;
  uint32_t solid_blocks = 0;
  uint64_t level_nodes = shape.nodes == 0 ? 0 : 1;
  for (int level = shape.level; level >= 1; --level) {
    uint64_t next_level_nodes = 0;
    for (uint64_t i = 0; i < level_nodes; ++i, ++index) {
      if (index >= shape.nodes) {
        return fault(place, index, "fewer nodes than the masks call for");
      }
      if ((index & ((1U << shape.rank_shift) - 1)) == 0) {
        const size_t block = index >> shape.rank_shift;
        if (bits::load32(tree.ranks_ + 4 * block) != children) {
          return fault(place, index, "wrong child count in the directory");
        }
        if (tree.block_ranks_ != nullptr && bits::load32(tree.block_ranks_ + 4 * block) != solid_blocks) {
          return fault(place, index, "wrong block count in the directory");
        }
      }
      const uint8_t mask = tree.masks_[index];
      if (mask != 0 && tree.is_merged(index)) {
        return fault(place, index, "a node with children is marked as merged");
      }
      solid_blocks += mask == 0 ? 1U : 0U;
      const unsigned bits_set = bits::popcount8(mask);
      children += bits_set;
      next_level_nodes += bits_set;
    }
    level_nodes = next_level_nodes;
  }
  if (index != shape.nodes) {
    return fault(place, index, "more nodes than the masks call for");
  }
  if (level_nodes != shape.voxel_bits) {
    return fault(place, kVoxelBitsOffset, "wrong number of voxel bits");
  }
  if (solid_blocks != shape.solid_blocks) {
    return fault(place, kSolidBlocksOffset, "wrong number of solid blocks");
  }

  VoxelBox bounds;
  if (solid_volume(tree, &bounds) != tree.voxel_count()) {
    return fault(place, kVoxelCountOffset, "wrong voxel count");
  }
  if (!(bounds == tree.bounds())) {
    return fault(place, kBoundsMinOffset, "wrong bounds");
  }
  return nullptr;
}

}  // namespace thimble
