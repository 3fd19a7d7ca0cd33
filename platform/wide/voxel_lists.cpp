#include "wide/voxel_lists.h"

#include "thimble/tree/morton.h"

namespace thimble::wide {
namespace {

// Nodes of every level stand one after the other: where each level begins, and how many boxes there are.
struct Census {
  uint32_t level_begin[kMaxLevel + 2];  // of level l; level_begin[0] is the number of nodes
  uint64_t boxes = 0;
  bool has_blocks = false;
  bool splits = false;  // whether blocks are given as their voxels, which `boxes` counts then
};

// Lists of single voxels are drawn faster. Blocks are split when that adds at most a box for so many.
constexpr uint64_t kBoxesPerAdded = 8;

// Solid blocks larger than a cube of entries are given as cubes.
uint32_t pieces_of(int level) {
  return level > kCubeLevel ? uint32_t{1} << (3 * (level - kCubeLevel)) : 1;
}

bool count(const CompactTree& tree, Census* census) {
  uint64_t added = 0;  // by splitting
  uint32_t begin = 0;
  uint32_t end = tree.empty() ? 0 : 1;
  for (int level = tree.level(); level >= 1; --level) {
    census->level_begin[level] = begin;
    uint64_t children = 0;
    for (uint32_t node = begin; node < end; ++node) {
      const unsigned mask = tree.mask(node);
      children += static_cast<unsigned>(__builtin_popcount(mask));
      if (mask == 0) {
        census->boxes += pieces_of(level);
        census->has_blocks = true;
        // More than can be added, whatever the tree, says enough.
        added += level < kCubeLevel ? (uint64_t{1} << (3 * level)) - 1 : UINT32_MAX;
      }
    }
    if (level == 1) {
      census->boxes += children;
    } else if (children > tree.node_count() - end) {
      return false;
    }
    begin = end;
    end += level == 1 ? 0 : static_cast<uint32_t>(children);
  }
  census->level_begin[0] = begin;
  census->splits = census->has_blocks && !tree.merged() && added <= census->boxes / kBoxesPerAdded;
  if (census->splits) {
    census->boxes += added;
    census->has_blocks = false;
  }
  return begin == tree.node_count() && census->boxes <= UINT32_MAX;
}

// The lowest level whose nodes, with all above them, are at most a sixteenth of the boxes (or few).
// Nodes that cost little, whatever the boxes: a megabyte.
constexpr uint64_t kFreeNodes = 65536;

int choose_block_level(const CompactTree& tree, const Census& census) {
  // A mean over the tree: where it is crowded in a corner, that wants more nodes than a sixteenth of the
  // boxes.
  const uint64_t quarter = census.boxes / 4 < kFreeNodes ? census.boxes / 4 : kFreeNodes;
  const uint64_t most = census.boxes / 16 > quarter ? census.boxes / 16 : quarter > 4096 ? quarter : 4096;
  int level = tree.level() < kCubeLevel ? tree.level() : kCubeLevel;
  while (level > 1 && census.level_begin[level - 2] <= most) {
    --level;
  }
  return level;
}

uint32_t packed(const uint32_t (&corner)[3], int level) {
  const uint32_t within = (uint32_t{1} << kCubeLevel) - 1;
  const uint32_t x = corner[0] & within;
  const uint32_t y = corner[1] & within;
  const uint32_t z = corner[2] & within;
  const uint32_t side = level < 3 ? static_cast<uint32_t>(level) : 3;
  const uint32_t more = level < 3 ? 0 : static_cast<uint32_t>(level - 3);
  return x | more | y << 10 | z << 20 | side << 30;
}

template <class T>
T* array(Arena* arena, uint64_t count) {
  return reinterpret_cast<T*>(arena->take(static_cast<size_t>(count) * sizeof(T), 64).data);
}

}  // namespace

size_t VoxelLists::bytes(const CompactTree& tree) {
  Census census;
  if (!count(tree, &census)) {
    return 0;
  }
  const int level = choose_block_level(tree, census);
  const size_t nodes = tree.empty() ? 0 : census.level_begin[level - 1];
  return census.boxes * (sizeof(uint32_t) + (tree.many_materials() ? 1 : 0) + (tree.merged() ? 1 : 0)) +
         kEntriesAhead * sizeof(uint32_t) + nodes * sizeof(BlockNode) + 4 * 64;
}

Status VoxelLists::make(const CompactTree& tree, Arena* arena, VoxelLists* lists) {
  Census census;
  if (!count(tree, &census)) {
    return Status::kDamaged;
  }
  VoxelLists made;
  made.tree_ = tree;
  made.has_blocks_ = census.has_blocks;
  made.block_level_ = choose_block_level(tree, census);
  const size_t node_count = tree.empty() ? 0 : census.level_begin[made.block_level_ - 1];
  Arena taken = *arena;
  uint32_t* entries = array<uint32_t>(&taken, census.boxes + kEntriesAhead);
  BlockNode* nodes = array<BlockNode>(&taken, node_count);
  uint8_t* materials = tree.many_materials() ? array<uint8_t>(&taken, census.boxes) : nullptr;
  uint8_t* merged = tree.merged() ? array<uint8_t>(&taken, census.boxes) : nullptr;
  if (entries == nullptr || (nodes == nullptr && node_count != 0) ||
      (materials == nullptr && tree.many_materials() && census.boxes != 0) ||
      (merged == nullptr && tree.merged() && census.boxes != 0)) {
    return Status::kOutOfMemory;
  }

  // Down and across in Morton order. Nodes of one level come in just the order in which they stand, so a
  // running number a level finds them without counting bits.
  uint32_t next_node[kMaxLevel + 1];
  for (int level = 1; level <= tree.level(); ++level) {
    next_node[level] = census.level_begin[level];
  }
  struct Step {
    uint32_t node;
    uint32_t mask;  // children not yet visited
  };
  Step steps[kMaxLevel + 1];
  uint32_t corner[3] = {0, 0, 0};
  uint32_t written = 0;
  uint32_t voxel = tree.node_count();
  int level = tree.level();
  bool entering = true;
  while (!tree.empty()) {
    Step& step = steps[level];
    if (entering) {
      step.node = next_node[level]++;
      step.mask = tree.mask(step.node);
      const bool solid = step.mask == 0;
      if (level >= made.block_level_) {
        nodes[step.node] = {written, 0, level > 1 && !solid ? next_node[level - 1] : 0,
                            static_cast<uint32_t>(made.face_area_)};
      }
      const auto add = [&](const uint32_t(&at)[3], int box_level, uint8_t material) {
        if (materials != nullptr) {
          materials[written] = material;
        }
        if (merged != nullptr) {
          merged[written] = tree.is_merged(step.node) ? 1 : 0;
        }
        made.face_area_ += uint64_t{1} << (2 * box_level);
        entries[written++] = packed(at, box_level);
      };
      if (solid && census.splits) {
        const uint8_t material = materials == nullptr ? 0 : tree.block_material(step.node);
        for (uint32_t code = 0; code >> (3 * level) == 0; ++code) {
          const Vec3i place = morton_voxel(code);
          const uint32_t at[3] = {corner[0] + static_cast<uint32_t>(place.x),
                                  corner[1] + static_cast<uint32_t>(place.y),
                                  corner[2] + static_cast<uint32_t>(place.z)};
          add(at, 0, material);
        }
      } else if (solid) {
        const uint8_t material = materials == nullptr ? 0 : tree.block_material(step.node);
        for (uint32_t piece = 0; piece < pieces_of(level); ++piece) {
          add(corner, level < kCubeLevel ? level : kCubeLevel, material);
        }
      } else if (level == 1) {
        for (; step.mask != 0; step.mask &= step.mask - 1) {
          const unsigned octant = static_cast<unsigned>(__builtin_ctz(step.mask));
          const uint32_t at[3] = {corner[0] + (octant & 1U), corner[1] + (octant >> 1 & 1U),
                                  corner[2] + (octant >> 2)};
          add(at, 0, materials == nullptr ? 0 : tree.voxel_material(voxel));
          ++voxel;
        }
      }
    }
    entering = step.mask != 0;
    if (entering) {
      const unsigned octant = static_cast<unsigned>(__builtin_ctz(step.mask));
      step.mask &= step.mask - 1;
      --level;
      const uint32_t side = uint32_t{1} << level;
      for (unsigned axis = 0; axis < 3; ++axis) {
        corner[axis] = (corner[axis] & ~(2 * side - 1)) | ((octant >> axis & 1U) != 0 ? side : 0);
      }
      continue;
    }
    if (level >= made.block_level_) {
      nodes[step.node].entries = written - nodes[step.node].first_entry;
      nodes[step.node].face_area = static_cast<uint32_t>(made.face_area_) - nodes[step.node].face_area;
    }
    if (level == tree.level()) {
      break;
    }
    ++level;
  }
  for (uint32_t i = 0; i < kEntriesAhead; ++i) {
    entries[written + i] = 0;
  }
  made.entries_ = Span<const uint32_t>(entries, written);
  made.nodes_ = Span<const BlockNode>(nodes, node_count);
  made.merged_ = Span<const uint8_t>(merged, merged == nullptr ? 0 : written);
  made.materials_ = Span<const uint8_t>(materials, materials == nullptr ? 0 : written);
  *arena = taken;
  *lists = made;
  return Status::kOk;
}

}  // namespace thimble::wide
