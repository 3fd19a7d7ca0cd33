#include "wide/voxel_lists.h"

#include "thimble/tree/morton.h"

namespace thimble::wide {
namespace {

// Where each level of the tree begins, whose nodes stand one after the other, and how many boxes there are.
struct Census {
  uint32_t level_begin[kMaxLevel + 2];  // by level; [0] is the number of nodes
  uint64_t boxes = 0;
  bool has_blocks = false;
  bool splits = false;  // whether blocks are given as their voxels; then `boxes` counts these
};

// Lists of single voxels are drawn faster. Blocks are split into voxels when that adds at most a box for so
// many.
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
        // Where a block is too large to be split, any number that is too many will do.
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

// So many nodes cost little, whatever the boxes: a megabyte.
constexpr uint64_t kFreeNodes = 65536;

// Chooses the lowest level whose nodes, with all above them, are at most a sixteenth of the boxes, or few.
int choose_block_level(const CompactTree& tree, const Census& census) {
  // A sixteenth suits the mean of a tree; one that is crowded in a corner wants more nodes.
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

// Walks the tree down and across, in Morton order, and writes entries and block nodes.
class ListWriter {
 public:
  // Where the lists are written. `materials` and `merged` are null where the tree has none.
  struct Lists {
    uint32_t* entries;
    BlockNode* nodes;
    uint8_t* materials;
    uint8_t* merged;
  };

  ListWriter(const CompactTree& tree, const Census& census, int block_level, const Lists& to)
      : tree_(tree), census_(census), block_level_(block_level), to_(to), voxel_(tree.node_count()) {
    for (int level = 1; level <= tree.level(); ++level) {
      next_node_[level] = census.level_begin[level];
    }
  }

  // Writes the lists of a tree that is not empty.
  void write() {
    int level = tree_.level();
    enter(level);
    for (;;) {
      Visit& visit = visits_[level];
      if (visit.mask != 0 && level > 0) {  // at level 0 there is none: nothing enters it with children
        const unsigned octant = static_cast<unsigned>(__builtin_ctz(visit.mask));
        visit.mask &= visit.mask - 1;
        --level;
        const uint32_t side = uint32_t{1} << level;
        for (unsigned axis = 0; axis < 3; ++axis) {
          corner_[axis] = (corner_[axis] & ~(2 * side - 1)) | ((octant >> axis & 1U) != 0 ? side : 0);
        }
        enter(level);
        continue;
      }
      if (level >= block_level_) {
        BlockNode& node = to_.nodes[visit.node];
        node.entries = written_ - node.first_entry;
        node.face_area = static_cast<uint32_t>(face_area_) - node.face_area;
      }
      if (level == tree_.level()) {
        return;
      }
      ++level;
    }
  }

  uint32_t written() const { return written_; }
  uint64_t face_area() const { return face_area_; }

 private:
  struct Visit {
    uint32_t node;
    uint32_t mask;  // of the children that are not yet visited
  };

  // Begins the visit of the next node of this level, and writes the entries that are its own.
  void enter(int level) {
    Visit& visit = visits_[level];
    // Nodes of one level come in the order in which they stand, so a number that counts up finds them.
    visit.node = next_node_[level]++;
    visit.mask = tree_.mask(visit.node);
    const bool solid = visit.mask == 0;
    if (level >= block_level_) {
      to_.nodes[visit.node] = {written_, 0, level > 1 && !solid ? next_node_[level - 1] : 0,
                               static_cast<uint32_t>(face_area_)};
    }
    if (solid) {
      add_block(level, visit.node);
    } else if (level == 1) {
      for (; visit.mask != 0; visit.mask &= visit.mask - 1) {
        const unsigned octant = static_cast<unsigned>(__builtin_ctz(visit.mask));
        const uint32_t at[3] = {corner_[0] + (octant & 1U), corner_[1] + (octant >> 1 & 1U),
                                corner_[2] + (octant >> 2)};
        add(at, 0, to_.materials == nullptr ? 0 : tree_.voxel_material(voxel_), visit.node);
        ++voxel_;
      }
    }
  }

  void add_block(int level, uint32_t node) {
    const uint8_t material = to_.materials == nullptr ? 0 : tree_.block_material(node);
    if (!census_.splits) {
      for (uint32_t piece = 0; piece < pieces_of(level); ++piece) {
        add(corner_, level < kCubeLevel ? level : kCubeLevel, material, node);
      }
      return;
    }
    for (uint32_t code = 0; code >> (3 * level) == 0; ++code) {
      const Vec3i place = morton_voxel(code);
      const uint32_t at[3] = {corner_[0] + static_cast<uint32_t>(place.x),
                              corner_[1] + static_cast<uint32_t>(place.y),
                              corner_[2] + static_cast<uint32_t>(place.z)};
      add(at, 0, material, node);
    }
  }

  void add(const uint32_t (&at)[3], int box_level, uint8_t material, uint32_t node) {
    if (to_.materials != nullptr) {
      to_.materials[written_] = material;
    }
    if (to_.merged != nullptr) {
      to_.merged[written_] = tree_.is_merged(node) ? 1 : 0;
    }
    face_area_ += uint64_t{1} << (2 * box_level);
    to_.entries[written_++] = packed(at, box_level);
  }

  const CompactTree& tree_;
  const Census& census_;
  int block_level_;
  Lists to_;
  uint32_t next_node_[kMaxLevel + 1];
  Visit visits_[kMaxLevel + 1];
  uint32_t corner_[3] = {0, 0, 0};
  uint32_t written_ = 0;
  uint32_t voxel_;  // the number of the next single voxel
  uint64_t face_area_ = 0;
};

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
  ListWriter::Lists to{};
  to.entries = array<uint32_t>(&taken, census.boxes + kEntriesAhead);
  to.nodes = array<BlockNode>(&taken, node_count);
  to.materials = tree.many_materials() ? array<uint8_t>(&taken, census.boxes) : nullptr;
  to.merged = tree.merged() ? array<uint8_t>(&taken, census.boxes) : nullptr;
  if (to.entries == nullptr || (to.nodes == nullptr && node_count != 0) ||
      (to.materials == nullptr && tree.many_materials() && census.boxes != 0) ||
      (to.merged == nullptr && tree.merged() && census.boxes != 0)) {
    return Status::kOutOfMemory;
  }
  ListWriter writer(tree, census, made.block_level_, to);
  if (!tree.empty()) {
    writer.write();
  }
  const uint32_t written = writer.written();
  for (uint32_t i = 0; i < kEntriesAhead; ++i) {
    to.entries[written + i] = 0;
  }
  made.face_area_ = writer.face_area();
  made.entries_ = Span<const uint32_t>(to.entries, written);
  made.nodes_ = Span<const BlockNode>(to.nodes, node_count);
  made.merged_ = Span<const uint8_t>(to.merged, to.merged == nullptr ? 0 : written);
  made.materials_ = Span<const uint8_t>(to.materials, to.materials == nullptr ? 0 : written);
  *arena = taken;
  *lists = made;
  return Status::kOk;
}

}  // namespace thimble::wide
