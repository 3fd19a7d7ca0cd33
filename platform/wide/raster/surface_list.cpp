#include "wide/raster/surface_list.h"

#include "wide/raster/surface.h"

namespace thimble::wide {
namespace {

// Finds the highest level at which a word lies in another node than the word before; for the first word 1 more than the
// world's level.
class NewNodes {
 public:
  explicit NewNodes(int world_level) : world_level_(world_level) {}

  int highest(const uint32_t (&corner)[3]) {
    uint32_t apart = 0;
    for (int axis = 0; axis < 3; ++axis) {
      apart |= before_[axis] ^ corner[axis];
      before_[axis] = corner[axis];
    }
    if (is_first_) {
      is_first_ = false;
      return world_level_;
    }
    return 31 - __builtin_clz(apart);
  }

 private:
  int world_level_;
  bool is_first_ = true;
  uint32_t before_[3] = {0, 0, 0};
};

class Counter {
 public:
  explicit Counter(int world_level) : new_nodes_(world_level) {}

  void add(const SurfaceWord& word) {
    entries_ += static_cast<uint64_t>(__builtin_popcountll(word.listed));
    ++words_[new_nodes_.highest(word.corner)];
  }

  SurfaceCount count(int world_level) const {
    SurfaceCount count;
    count.entries = entries_;
    uint32_t nodes = 0;  // nodes of a level: words that begin one at that level or above
    uint32_t begin = 0;
    for (int level = world_level; level >= 2; --level) {
      count.level_begin[level] = begin;
      nodes += words_[level];
      begin += nodes;
    }
    count.level_begin[1] = begin;
    count.level_begin[0] = begin;
    return count;
  }

 private:
  NewNodes new_nodes_;
  uint64_t entries_ = 0;
  uint32_t words_[kMaxLevel + 1] = {};
};

// The coordinates of a word's voxels, packed as in entries.
struct Places {
  uint32_t of[64] = {};
  constexpr Places() {
    for (uint32_t bit = 0; bit < 64; ++bit) {
      for (uint32_t axis = 0; axis < 3; ++axis) {
        of[bit] |= ((bit >> axis & 1U) | (bit >> (3 + axis) & 1U) << 1) << (10 * axis);
      }
    }
  }
};
constexpr Places kPlaces;

class Writer {
 public:
  Writer(const CompactTree& tree, const SurfaceCount& count, int block_level, const ListTo& to)
      : tree_(tree), block_level_(block_level), to_(to), new_nodes_(tree.level()) {
    for (int level = 0; level <= tree.level(); ++level) {
      next_node_[level] = count.level_begin[level];
    }
  }

  void add(const SurfaceWord& word) {
    begin_nodes(word);
    const uint32_t corner = packed(word.corner, 0);
    const uint32_t first = written_;
    for (uint64_t left = word.listed; left != 0; left &= left - 1) {
      to_.entries[written_++] = corner + kPlaces.of[__builtin_ctzll(left)];
    }
    if (to_.materials != nullptr) {
      add_materials(word, to_.materials + first);
    }
  }

  // Sets how many entries each node has: those before the first entry of the next node of its level.
  void finish(const SurfaceCount& count) const {
    for (int level = tree_.level(); level >= block_level_; --level) {
      uint32_t end = written_;
      for (uint32_t node = count.level_begin[level - 1]; node-- > count.level_begin[level];) {
        to_.nodes[node].entries = end - to_.nodes[node].first_entry;
        end = to_.nodes[node].first_entry;
      }
    }
  }

 private:
  void begin_nodes(const SurfaceWord& word) {
    for (int level = new_nodes_.highest(word.corner); level >= 2 && level >= block_level_ - 1; --level) {
      if (level < tree_.level()) {
        const unsigned octant = (word.corner[0] >> level & 1U) | (word.corner[1] >> level & 1U) << 1 |
                                (word.corner[2] >> level & 1U) << 2;
        to_.nodes[next_node_[level + 1] - 1].area_or_mask |= 1U << octant;
      }
      if (level >= block_level_) {
        to_.nodes[next_node_[level]++] = {written_, 0, level > block_level_ ? next_node_[level - 1] : 0, 0};
      }
    }
    for (int level = tree_.level(); level >= block_level_; --level) {
      uint32_t& mask = to_.nodes[next_node_[level] - 1].area_or_mask;
      if ((~mask & word.facing << 8) == 0) {
        continue;
      }
      mask |= word.facing << 8;
    }
    if (block_level_ == 2) {
      for (unsigned octant = 0; octant < 8; ++octant) {
        to_.nodes[next_node_[2] - 1].area_or_mask |=
            (word.listed >> (8 * octant) & 0xFFU) != 0 ? 1U << octant : 0U;
      }
    }
  }

  void add_materials(const SurfaceWord& word, uint8_t* to) const {
    if (word.block) {
      for (int left = __builtin_popcountll(word.listed); left > 0; --left) {
        *to++ = word.material;
      }
      return;
    }
    // The word's nodes of level 1, and with them the numbers of voxels, come in the order of the octants.
    uint32_t child = word.first_child;
    uint32_t voxel = tree_.node_count() + word.first_voxel;
    for (unsigned octant = 0; octant < 8; ++octant) {
      if ((word.children >> octant & 1U) == 0) {
        continue;
      }
      const unsigned mask = tree_.mask(child);
      const unsigned listed = static_cast<unsigned>(word.listed >> (8 * octant) & 0xFFU);
      const uint8_t material = mask == 0 && listed != 0 ? tree_.block_material(child) : uint8_t{0};
      for (unsigned left = listed; left != 0; left &= left - 1) {
        const unsigned below = (left & (0 - left)) - 1;
        *to++ = mask == 0
                    ? material
                    : tree_.voxel_material(voxel + static_cast<uint32_t>(__builtin_popcount(mask & below)));
      }
      voxel += static_cast<uint32_t>(__builtin_popcount(mask));
      ++child;
    }
  }

  const CompactTree& tree_;
  int block_level_;
  const ListTo& to_;
  NewNodes new_nodes_;
  uint32_t next_node_[kMaxLevel + 1];
  uint32_t written_ = 0;
};

}  // namespace

SurfaceCount count_surface(const CompactTree& tree, const uint32_t* level_begin) {
  Counter counter(tree.level());
  SurfaceWalk<Counter>(tree, level_begin, &counter).walk();
  return counter.count(tree.level());
}

void write_surface(const CompactTree& tree, const uint32_t* level_begin, const SurfaceCount& count,
                   int block_level, const ListTo& to) {
  Writer writer(tree, count, block_level, to);
  SurfaceWalk<Writer>(tree, level_begin, &writer).walk();
  writer.finish(count);
}

}  // namespace thimble::wide
