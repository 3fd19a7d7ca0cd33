// Makes the layers of a map. The layer of a material that rays go through says where that material is not: a cube that
// it fills is empty there, a cube that holds nothing of it is solid.
#include <algorithm>

#include "wide/rays/map_parts.h"

namespace thimble::wide {
namespace {

// Hands single voxels to a taker of leaves, each with its material.
template <class Taker>
void take_each(const CompactTree& tree, const Corner& corner, unsigned mask, uint32_t voxel, Taker* taker) {
  for (; mask != 0; mask &= mask - 1, ++voxel) {
    taker->take_leaf(corner, spread(mask & (0 - mask)) << bit_of(corner, 0),
                     tree.many_materials() ? tree.voxel_material(voxel) : tree.uniform_material());
  }
}

// Collects which materials the tree holds.
struct UsedMaterials {
  const CompactTree& tree;
  bool of[256] = {};
  void take_leaf(const Corner& /*corner*/, uint64_t /*voxels*/, uint8_t material) { of[material] = true; }
  void take_voxels(const Corner& corner, unsigned mask, uint32_t voxel) {
    take_each(tree, corner, mask, voxel, this);
  }
  void take_block(const Corner& /*corner*/, int /*level*/, uint8_t material) { of[material] = true; }
  void take_chunk(const Corner& /*corner*/, uint32_t /*node*/) {}
};

// Writes cubes and chunks; without a place to write it only counts words.
class LayerWriter {
 public:
  LayerWriter(const CompactTree& tree, const MediaShape& media, uint32_t* top, uint64_t* chunks,
              uint64_t next_word)
      : tree_(tree),
        media_(media),
        bits_(map_level(tree) - kChunkLevel),
        has_nodes_(has_nodes(tree)),
        top_(top),
        chunks_(chunks),
        next_word_(next_word) {
    for (uint8_t layer = 0; layer < media.layers; ++layer) {
      layer_of_[media.materials[layer]] = layer;
    }
  }

  void take_leaf(const Corner& corner, uint64_t voxels, uint8_t material) {
    const uint8_t layer = layer_of_[material];
    if (layer != kNone) {
      inside_[layer][bit_of(corner, kLeafLevel)] |= voxels;
      holds_[layer] = true;
    }
  }
  void take_voxels(const Corner& corner, unsigned mask, uint32_t voxel) {
    take_each(tree_, corner, mask, voxel, this);
  }
  void take_block(const Corner& corner, int level, uint8_t material) {
    const uint8_t layer = layer_of_[material];
    const uint32_t side = uint32_t{1} << (level - kChunkLevel);
    for (uint32_t i = 0; layer != kNone && top_ != nullptr && i < side * side; ++i) {
      std::fill_n(cube(layer, {corner.x, corner.y + i % side * 16, corner.z + i / side * 16}), side,
                  kEmptyCube);
    }
  }
  void take_chunk(const Corner& corner, uint32_t /*node*/) {
    for (uint8_t layer = 0; layer < media_.layers; ++layer) {
      if (holds_[layer]) {
        put(layer, corner);
        std::fill(inside_[layer], inside_[layer] + kLeaves, 0);
        holds_[layer] = false;
      }
    }
  }
  uint64_t words() const { return next_word_; }

 private:
  static constexpr uint8_t kNone = UINT8_MAX;
  struct Layers {
    uint8_t of[256];
    Layers() { std::fill(of, of + 256, kNone); }
    uint8_t& operator[](uint8_t material) { return of[material]; }
  };

  uint32_t* cube(uint8_t layer, const Corner& corner) const {
    const uint64_t x = corner.x >> kChunkLevel;
    const uint64_t y = corner.y >> kChunkLevel;
    const uint64_t z = corner.z >> kChunkLevel;
    return top_ + ((((uint64_t{layer} << bits_ | z) << bits_ | y) << bits_) | x);
  }
  void put(uint8_t layer, const Corner& corner) {
    const uint64_t begin = next_word_++;
    next_word_ += has_nodes_ ? 1 : 0;
    uint64_t mask = 0;
    for (unsigned leaf = 0; leaf < kLeaves; ++leaf) {
      const uint64_t outside = ~inside_[layer][leaf];
      if (outside != 0) {
        mask |= uint64_t{1} << leaf;
        if (chunks_ != nullptr) {
          chunks_[next_word_] = outside;
        }
        ++next_word_;
      }
    }
    if (mask == 0) {
      next_word_ = begin;
    }
    if (chunks_ == nullptr) {
      return;
    }
    *cube(layer, corner) = mask == 0 ? kEmptyCube : static_cast<uint32_t>(begin) << 4;
    if (mask != 0) {
      chunks_[begin] = mask;
      if (has_nodes_) {
        chunks_[begin + 1] = UINT64_MAX;
      }
    }
  }

  const CompactTree& tree_;
  const MediaShape& media_;
  int bits_;
  bool has_nodes_;
  uint32_t* top_;
  uint64_t* chunks_;
  uint64_t next_word_;
  Layers layer_of_;
  uint64_t inside_[kMostMedia][kLeaves] = {};
  bool holds_[kMostMedia] = {};
};

}  // namespace

MediaShape measure_media(const CompactTree& tree, const MapShape& shape, Span<const uint8_t> materials) {
  MediaShape media;
  if (materials.size == 0 || tree.empty() || tree.level() > kMostMediaLevel) {
    return media;
  }
  UsedMaterials used{tree};
  TreeWalk(tree, shape, &used).run();
  for (size_t i = 0; i < materials.size && media.layers < kMostMedia; ++i) {
    if (used.of[materials.data[i]]) {
      used.of[materials.data[i]] = false;  // each material gets one layer
      media.materials[media.layers++] = materials.data[i];
    }
  }
  LayerWriter counter(tree, media, nullptr, nullptr, 0);
  if (media.layers != 0) {
    TreeWalk(tree, shape, &counter).run();
  }
  // A chunk's first words are written before it is known to be empty.
  media.words = counter.words() + 2;
  return media;
}

void write_media(const CompactTree& tree, const MapShape& shape, const MediaShape& media, uint32_t* top,
                 uint64_t* chunks, uint64_t next_word) {
  if (media.layers == 0) {
    return;
  }
  std::fill(top, top + shape.top * media.layers, 0U);  // 0 is the first chunk, which is solid
  LayerWriter writer(tree, media, top, chunks, next_word);
  TreeWalk(tree, shape, &writer).run();
}

}  // namespace thimble::wide
