// Makes the map of a compact tree: chunks and leaves in one walk over the nodes, then how far the empty cubes reach.
#include <algorithm>

#include "wide/rays/leaf_tag.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {
namespace {

constexpr int kChunkLevel = 4;
constexpr int kLeafLevel = 2;
constexpr unsigned kLeaves = 64;                    // of a chunk
constexpr uint32_t kEmptyCube = 0x11111111U;        // before it is known how far it reaches
constexpr uint64_t kMostWords = uint64_t{1} << 28;  // of chunks, so that a cube says where its own begins

// How large a map is, and where each level of the tree begins.
struct MapShape {
  uint32_t level_begin[kMaxLevel + 1];
  uint32_t block_begin[kMaxLevel + 1];  // the number of the first solid block of each level
  uint64_t top = 0;                     // cubes
  uint64_t words = 0;                   // of chunks
};

using Corner = Vec3<uint32_t>;

// One numbering of a map's cubes, 2^bits a side.
struct Cubes {
  uint32_t* top;
  int bits;

  // The word of the cube that begins at `corner`, in voxels.
  uint32_t* at(const Corner& corner) const {
    return top + ((uint64_t{corner.z >> kChunkLevel} << bits | corner.y >> kChunkLevel) << bits |
                  corner.x >> kChunkLevel);
  }
  // Fills the cubes of a block of 2^level voxels a side.
  void fill(const Corner& corner, int level, uint32_t word) const {
    const uint32_t side = uint32_t{1} << (level - kChunkLevel);
    for (uint32_t i = 0; i < side * side; ++i) {
      std::fill_n(at({corner.x, corner.y + i % side * 16, corner.z + i / side * 16}), side, word);
    }
  }
};

Corner child_corner(const Corner& corner, unsigned octant, int level) {
  const uint32_t half = uint32_t{1} << (level - 1);
  return {corner.x + ((octant & 1U) != 0 ? half : 0), corner.y + ((octant & 2U) != 0 ? half : 0),
          corner.z + ((octant & 4U) != 0 ? half : 0)};
}

// The number of a cell in its cube of 4^3 cells.
unsigned bit_of(const Corner& corner, int level) {
  return ((corner.x >> level) & 3U) | ((corner.y >> level) & 3U) << 2 | ((corner.z >> level) & 3U) << 4;
}

// Spreads the mask of a node of level 1 to the bits of a leaf, of which the node has the first voxel.
uint64_t spread(unsigned mask) {
  return uint64_t{mask & 3U} | uint64_t{(mask >> 2) & 3U} << 4 | uint64_t{(mask >> 4) & 3U} << 16 |
         uint64_t{(mask >> 6) & 3U} << 20;
}

// Walks the tree depth first, which meets the nodes, blocks and voxels of each level in the order in which they stand,
// and hands `taker` what is solid:
//
//     take_block(corner, level, material)   a block of a chunk's size or larger
//     take_leaf(corner, voxels, material)   within a chunk: bits of the leaf at `corner`, of one block
//     take_voxels(corner, mask, number)     single voxels: the mask of their node, and the number of the first
//     take_chunk(corner, node)              behind all that a chunk holds; in a smaller world it is the root
template <class Taker>
class TreeWalk {
 public:
  TreeWalk(const CompactTree& tree, const MapShape& shape, Taker* taker)
      : tree_(tree), taker_(*taker), next_voxel_(tree.node_count()) {
    std::copy(shape.level_begin, shape.level_begin + kMaxLevel + 1, next_node_);
    std::copy(shape.block_begin, shape.block_begin + kMaxLevel + 1, next_block_);
  }

  void run() {
    if (tree_.level() < kChunkLevel) {
      enter_chunk(tree_.level(), {0, 0, 0});
    } else {
      enter(tree_.level(), {0, 0, 0});
    }
  }

 private:
  void enter(int level, const Corner& corner) {
    if (level == kChunkLevel && tree_.mask(next_node_[level]) != 0) {
      enter_chunk(level, corner);
      return;
    }
    visit(
        level, [&](unsigned octant) { enter(level - 1, child_corner(corner, octant, level)); },
        [&](uint8_t material) { taker_.take_block(corner, level, material); });
  }

  void enter_chunk(int level, const Corner& corner) {
    const uint32_t node = next_node_[level];
    collect(level, corner);
    taker_.take_chunk(corner, node);
  }

  void collect(int level, const Corner& corner) {
    const unsigned mask = tree_.mask(next_node_[level]);
    if (level == 1 && mask != 0) {
      ++next_node_[1];
      taker_.take_voxels(corner, mask, next_voxel_);
      next_voxel_ += static_cast<uint32_t>(__builtin_popcount(mask));
      return;
    }
    visit(
        level, [&](unsigned octant) { collect(level - 1, child_corner(corner, octant, level)); },
        [&](uint8_t material) {
          if (level < kLeafLevel) {
            taker_.take_leaf(corner, spread(0xFF) << bit_of(corner, 0), material);
            return;
          }
          const uint32_t side = uint32_t{1} << (level - kLeafLevel);
          for (uint32_t i = 0; i < side * side * side; ++i) {
            taker_.take_leaf(
                {corner.x + i % side * 4, corner.y + i / side % side * 4, corner.z + i / side / side * 4},
                ~uint64_t{0}, material);
          }
        });
  }

  // Calls enter_child(octant) for each child of the next node of `level`, or enter_block(material) where it is solid.
  template <class EnterChild, class EnterBlock>
  void visit(int level, const EnterChild& enter_child, const EnterBlock& enter_block) {
    unsigned mask = tree_.mask(next_node_[level]++);
    if (mask == 0) {
      enter_block(tree_.material_of_block(next_block_[level]++));
    }
    for (; mask != 0; mask &= mask - 1) {
      enter_child(static_cast<unsigned>(__builtin_ctz(mask)));
    }
  }

  const CompactTree& tree_;
  Taker& taker_;
  uint32_t next_node_[kMaxLevel + 1];
  uint32_t next_block_[kMaxLevel + 1];
  uint32_t next_voxel_;
};

bool has_nodes(const CompactTree& tree) {
  return tree.many_materials() || tree.merged();
}
// Whether chunks say where the tree keeps the materials of their voxels.
bool has_tags(const CompactTree& tree) {
  return tree.many_materials() && !tree.merged();
}
int map_level(const CompactTree& tree) {
  return std::max(tree.level(), kChunkLevel);
}

constexpr uint32_t kMaxReach = 15;
constexpr uint64_t kMaterials = 256;

// Measures a map. Returns false for a tree whose masks do not add up.
bool measure(const CompactTree& tree, MapShape* shape) {
  uint64_t begin = 0;
  uint64_t end = tree.empty() ? 0 : 1;
  shape->top = uint64_t{1} << (3 * (map_level(tree) - kChunkLevel));
  uint64_t chunks = 1;  // the chunk that is solid through, which all such cubes share
  uint64_t leaves = kLeaves;
  uint64_t blocks = 0;
  uint64_t solid_cubes = 0;  // solid blocks of a cube's size or larger
  for (int level = tree.level(); level >= 1; --level) {
    shape->level_begin[level] = static_cast<uint32_t>(begin);
    shape->block_begin[level] = static_cast<uint32_t>(blocks);
    uint64_t children = 0;
    uint64_t solid = 0;
    for (uint64_t node = begin; node < end; ++node) {
      const unsigned mask = tree.mask(static_cast<uint32_t>(node));
      children += static_cast<unsigned>(__builtin_popcount(mask));
      solid += mask == 0 ? 1 : 0;
    }
    blocks += solid;
    solid_cubes += level >= kChunkLevel ? solid : 0;
    const bool is_root = level == tree.level();
    if (level == kChunkLevel || (is_root && level < kChunkLevel)) {
      chunks += end - begin;
    }
    if (level == kLeafLevel || (is_root && level < kLeafLevel)) {
      leaves += end - begin;
    }
    if (level == kLeafLevel + 1) {
      leaves += 8 * solid;
    }
    if (level > 1 && children > tree.node_count() - end) {
      return false;
    }
    begin = end;
    end += level == 1 ? 0 : children;
  }
  if (has_tags(tree)) {
    const uint64_t of_materials = std::min(solid_cubes, kMaterials);
    leaves =
        2 * leaves + kLeaves * of_materials;  // each leaf has a tag, except in chunks that are solid through
    chunks += of_materials;
  }
  shape->words = leaves + chunks * (has_nodes(tree) ? 2 : 1);
  return tree.nodes_in_order() && begin == tree.node_count();
}

// Writes what a walk over the tree hands it.
class MapWriter {
 public:
  MapWriter(const CompactTree& tree, const MapShape& shape, uint32_t* top, uint64_t* chunks)
      : tree_(tree),
        cubes_{top, map_level(tree) - kChunkLevel},
        chunks_(chunks),
        has_nodes_(has_nodes(tree)),
        has_tags_(has_tags(tree)) {
    std::fill(top, top + shape.top, kEmptyCube);
    put_solid_chunk(UINT64_MAX);
  }

  void take_block(const Corner& corner, int level, uint8_t material) {
    cubes_.fill(corner, level, has_tags_ ? solid_chunk(material) << 4 : 0);
  }
  void take_leaf(const Corner& leaf, uint64_t voxels, uint8_t material) {
    chunk_[bit_of(leaf, kLeafLevel)] |= voxels;
    if (has_tags_) {
      tag_cells(leaf, voxels == ~uint64_t{0} ? 0xFF : 1U << LeafOrder::cell_of(bit_of(leaf, 0)), material);
    }
  }
  void take_voxels(const Corner& corner, unsigned mask, uint32_t number) {
    chunk_[bit_of(corner, kLeafLevel)] |= spread(mask) << bit_of(corner, 0);
    if (has_tags_) {
      tag_voxels(corner, number, static_cast<unsigned>(__builtin_popcount(mask)));
    }
  }
  void take_chunk(const Corner& corner, uint32_t node) {
    *cubes_.at(corner) = static_cast<uint32_t>(next_word_) << 4;
    put_chunk(node);
  }

 private:
  // Returns where the chunk begins that is solid through in a material; writes it first if need be.
  uint32_t solid_chunk(uint8_t material) {
    if (solid_[material] == 0) {
      solid_[material] = static_cast<uint32_t>(next_word_);
      put_solid_chunk(kSolidChunk | material);
    }
    return solid_[material];
  }

  void put_solid_chunk(uint64_t second) {
    std::fill(chunk_, chunk_ + kLeaves, ~uint64_t{0});
    put_chunk(second);
  }

  // Writes what was collected of a chunk, and begins the next.
  void put_chunk(uint64_t node) {
    const uint64_t begin = next_word_;
    next_word_ += has_nodes_ ? 2 : 1;
    chunks_[begin] = 0;
    for (unsigned leaf = 0; leaf < kLeaves; ++leaf) {
      if (chunk_[leaf] != 0) {
        chunks_[begin] |= uint64_t{1} << leaf;
        chunks_[next_word_++] = chunk_[leaf];
      }
    }
    if (has_nodes_) {
      chunks_[begin + 1] = node;
    }
    for (unsigned leaf = 0; has_tags_ && node < kSolidChunk && leaf < kLeaves; ++leaf) {
      if (chunk_[leaf] != 0) {
        chunks_[next_word_++] = tags_[leaf].is_plain ? tags_[leaf].whole() : tags_[leaf].tag.word();
      }
    }
    std::fill(chunk_, chunk_ + kLeaves, 0);
    std::fill(tags_, tags_ + kLeaves, Collected());
  }

  // What is known of a leaf's materials.
  struct Collected {
    LeafTag tag;
    bool has_voxels = false;  // whether there are voxels with bytes of their own
    bool has_first = false;   // whether the material of one voxel is known
    bool is_plain = true;     // whether all voxels have that material
    uint8_t material = 0;

    void take(uint8_t of_voxel) {
      is_plain = is_plain && (!has_first || material == of_voxel);
      material = of_voxel;
      has_first = true;
    }
    uint64_t whole() const {
      LeafTag all;
      all.plain = 0xFF;
      all.material = material;
      return all.word();
    }
  };

  // Tags the cells of a leaf that are solid through in one material.
  void tag_cells(const Corner& leaf, unsigned cells, uint8_t material) {
    Collected& to = tags_[bit_of(leaf, kLeafLevel)];
    LeafTag& tag = to.tag;
    if (tag.plain == 0) {
      tag.material = material;
    }
    uint8_t& set = tag.material == material ? tag.plain : tag.other;
    set = static_cast<uint8_t>(set | cells);
    to.take(material);
  }
  void tag_voxels(const Corner& leaf, uint32_t number, unsigned count) {
    Collected& to = tags_[bit_of(leaf, kLeafLevel)];
    if (!to.has_voxels) {
      to.has_voxels = true;
      to.tag.first_voxel = number;
    }
    for (unsigned i = 0; i < count; ++i) {
      to.take(tree_.voxel_material(number + i));
    }
  }

  const CompactTree& tree_;
  Cubes cubes_;
  uint64_t* chunks_;
  bool has_nodes_;
  bool has_tags_;
  uint64_t next_word_ = 0;
  uint32_t solid_[kMaterials] = {};  // by material: where its solid chunk begins; 0: not written yet
  uint64_t chunk_[kLeaves];
  Collected tags_[kLeaves];
};

// Writes how far the empty cubes reach along one octant after the other. An empty cube of side k + 1 is an empty cell,
// and the empty cubes of side k that begin at its seven neighbours ahead. Octant 0, whose bits also tell chunks, comes
// last.
class Reaches {
 public:
  Reaches(uint32_t* top, int bits) : top_(top), side_(size_t{1} << bits) {}

  void write() {
    for (unsigned octant = 8; octant-- > 0;) {
      write_octant(octant);
    }
  }

 private:
  static constexpr size_t kMostSide = size_t{1} << (kMaxLevel - kChunkLevel);
  using Row = uint32_t[kMostSide];

  // Lowers `reach` to the reaches of a row of cubes.
  void lower(const uint32_t* row, unsigned octant, Row& reach) const {
    for (size_t x = 0; x < side_; ++x) {
      const uint32_t cube = row[x];
      reach[x] = std::min(reach[x], (cube & 15U) == 0 ? 0 : (cube >> (4 * octant)) & 15U);
    }
  }

  void write_octant(unsigned octant) {
    for (size_t i = 0; i < side_; ++i) {
      const size_t z = (octant & 4U) != 0 ? i : side_ - 1 - i;
      const size_t z_ahead = (octant & 4U) != 0 ? z - 1 : z + 1;
      for (size_t j = 0; j < side_; ++j) {
        const size_t y = (octant & 2U) != 0 ? j : side_ - 1 - j;
        const size_t y_ahead = (octant & 2U) != 0 ? y - 1 : y + 1;
        Row reach;
        std::fill(reach, reach + side_, kMaxReach);
        if (j != 0) {
          lower(row(y_ahead, z), octant, reach);
        }
        if (i != 0) {
          lower(row(y, z_ahead), octant, reach);
        }
        if (i != 0 && j != 0) {
          lower(row(y_ahead, z_ahead), octant, reach);
        }
        write_row(row(y, z), octant, reach);
      }
    }
  }

  // Writes a row of cubes; `reach` is the least of the three rows ahead.
  void write_row(uint32_t* cubes, unsigned octant, const Row& reach) const {
    const unsigned shift = 4 * octant;
    uint32_t ahead = kMaxReach;  // of the cube ahead in the row, and of the three beside that
    for (size_t k = 0; k < side_; ++k) {
      const size_t x = (octant & 1U) != 0 ? k : side_ - 1 - k;
      const uint32_t cube = cubes[x];
      const uint32_t largest = std::min(std::min(ahead, reach[x]) + 1, kMaxReach);
      const bool empty = (cube & 15U) != 0;
      cubes[x] = empty ? (cube & ~(15U << shift)) | largest << shift : cube;
      ahead = std::min(empty ? largest : 0, reach[x]);
    }
  }

  uint32_t* row(size_t y, size_t z) const { return top_ + (z * side_ + y) * side_; }

  uint32_t* top_;
  size_t side_;
};

template <class T>
T* array(Arena* arena, uint64_t count) {
  return reinterpret_cast<T*>(arena->take(static_cast<size_t>(count) * sizeof(T), 64).data);
}

}  // namespace

size_t RayMap::bytes(const CompactTree& tree) {
  MapShape shape;
  constexpr uint64_t kPadding = 2 * 64;
  return measure(tree, &shape) ? static_cast<size_t>((shape.top + 1) * sizeof(uint32_t) +
                                                     shape.words * sizeof(uint64_t) + kPadding)
                               : 0;
}

Status RayMap::make(const CompactTree& tree, Arena* arena, RayMap* map) {
  MapShape shape;
  if (!measure(tree, &shape)) {
    return Status::kDamaged;
  }
  const Arena before = *arena;
  uint32_t* top = array<uint32_t>(arena, shape.top + 1);
  uint64_t* chunks = shape.words < kMostWords ? array<uint64_t>(arena, shape.words) : nullptr;
  if (top == nullptr || chunks == nullptr) {
    *arena = before;
    return Status::kOutOfMemory;
  }
  MapWriter writer(tree, shape, top, chunks);
  if (!tree.empty()) {
    TreeWalk(tree, shape, &writer).run();
  }
  const int level = map_level(tree);
  Reaches(top, level - kChunkLevel).write();
  top[shape.top] = kEmptyCube;
  *map = RayMap(tree);
  map->cells_ = {top, chunks, level, has_nodes(tree), has_tags(tree)};
  return Status::kOk;
}

}  // namespace thimble::wide
