// Makes the map of a compact tree: chunks and leaves in one walk over the nodes, then how far the empty cubes reach.
#include <algorithm>

#include "wide/rays/leaf_tag.h"
#include "wide/rays/map_parts.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {
namespace {

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
  return begin == tree.node_count();
}

// The words of all numberings, and one more.
uint64_t top_words(const MapShape& shape, const MediaShape& media) {
  return shape.top * (1 + media.layers) + 1;
}
size_t map_bytes(const MapShape& shape, const MediaShape& media) {
  constexpr uint64_t kPadding = 2 * 64;
  return static_cast<size_t>(top_words(shape, media) * sizeof(uint32_t) +
                             (shape.words + media.words) * sizeof(uint64_t) + kPadding);
}

// Writes what a walk over the tree hands it.
class MapWriter {
 public:
  MapWriter(const CompactTree& tree, const MapShape& shape, uint32_t* top, uint64_t* chunks)
      : tree_(tree),
        top_(top),
        chunks_(chunks),
        bits_(map_level(tree) - kChunkLevel),
        has_nodes_(has_nodes(tree)),
        has_tags_(has_tags(tree)) {
    std::fill(top, top + shape.top, kEmptyCube);
    put_solid_chunk(UINT64_MAX);
  }

  void take_block(const Corner& corner, int level, uint8_t material) {
    fill_cubes(level, corner, has_tags_ ? solid_chunk(material) : 0);
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
    *cube(corner.x >> kChunkLevel, corner.y >> kChunkLevel, corner.z >> kChunkLevel) = next_word_ << 4;
    put_chunk(node);
  }
  uint64_t words() const { return next_word_; }

 private:
  // Returns where the chunk begins that is solid through in a material; writes it first if need be.
  uint32_t solid_chunk(uint8_t material) {
    if (solid_[material] == 0) {
      solid_[material] = next_word_;
      put_solid_chunk(kSolidChunk | material);
    }
    return solid_[material];
  }

  uint32_t* cube(uint32_t x, uint32_t y, uint32_t z) const {
    return top_ + ((uint64_t{z} << bits_ | y) << bits_ | x);
  }
  void fill_cubes(int level, const Corner& corner, uint32_t chunk) {
    const uint32_t side = uint32_t{1} << (level - kChunkLevel);
    const Corner low{corner.x >> kChunkLevel, corner.y >> kChunkLevel, corner.z >> kChunkLevel};
    for (uint32_t z = low.z; z < low.z + side; ++z) {
      for (uint32_t y = low.y; y < low.y + side; ++y) {
        std::fill_n(cube(low.x, y, z), side, chunk << 4);
      }
    }
  }

  void put_solid_chunk(uint64_t second) {
    std::fill(chunk_, chunk_ + kLeaves, ~uint64_t{0});
    put_chunk(second);
  }

  // Writes what was collected of a chunk, and begins the next.
  void put_chunk(uint64_t node) {
    uint64_t& mask = chunks_[next_word_++];
    mask = 0;
    if (has_nodes_) {
      chunks_[next_word_++] = node;
    }
    for (unsigned leaf = 0; leaf < kLeaves; ++leaf) {
      if (chunk_[leaf] != 0) {
        mask |= uint64_t{1} << leaf;
        chunks_[next_word_++] = chunk_[leaf];
      }
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
  uint32_t* top_;
  uint64_t* chunks_;
  int bits_;
  bool has_nodes_;
  bool has_tags_;
  uint32_t next_word_ = 0;
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

size_t RayMap::bytes(const CompactTree& tree, Span<const uint8_t> media) {
  MapShape shape;
  return measure(tree, &shape) ? map_bytes(shape, measure_media(tree, shape, media)) : 0;
}

Status RayMap::make(const CompactTree& tree, Arena* arena, RayMap* map, Span<const uint8_t> media) {
  MapShape shape;
  if (!measure(tree, &shape)) {
    return Status::kDamaged;
  }
  const Arena before = *arena;
  const MediaShape layers = measure_media(tree, shape, media);
  const uint64_t words = shape.words + layers.words;
  uint32_t* top = array<uint32_t>(arena, top_words(shape, layers));
  uint64_t* chunks = words < kMostWords ? array<uint64_t>(arena, words) : nullptr;
  if (top == nullptr || chunks == nullptr) {
    *arena = before;
    return Status::kOutOfMemory;
  }
  MapWriter writer(tree, shape, top, chunks);
  if (!tree.empty()) {
    TreeWalk(tree, shape, &writer).run();
  }
  write_media(tree, shape, layers, top + shape.top, chunks, writer.words());
  const int level = map_level(tree);
  for (uint64_t layer = 0; layer <= layers.layers; ++layer) {
    Reaches(top + layer * shape.top, level - kChunkLevel).write();
  }
  top[top_words(shape, layers) - 1] = kEmptyCube;
  *map = RayMap(tree);
  map->cells_ = {top, chunks, level, has_nodes(tree), has_tags(tree)};
  for (uint8_t layer = 0; layer < layers.layers; ++layer) {
    map->layers_[layers.materials[layer]] = static_cast<uint8_t>(layer + 1);
  }
  return Status::kOk;
}

}  // namespace thimble::wide
