#include "scene/point_tree.h"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <functional>
#include <future>
#include <vector>

#include "output/units.h"
#include "readers/oct.h"
#include "scene/host_memory.h"
#include "scene/scene_source.h"
#include "scene/workers.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {
namespace {

constexpr std::size_t kPartVoxels = std::size_t{1} << (3 * kPartLevel);
// Of a list. Many are open at a time, and half of each is empty. Behind an address it holds whole lines, of 63 or of 60
// bytes.
constexpr std::size_t kChunkBytes = std::size_t{32} << 10;

// The bits of a byte, each in front of two others.
constexpr std::array<std::uint32_t, 256> kSpread = [] {
  std::array<std::uint32_t, 256> spread{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    spread[byte] = static_cast<std::uint32_t>(morton_code(byte, 0, 0));
  }
  return spread;
}();

std::uint32_t morton_of_bytes(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return kSpread[x & 255U] | kSpread[y & 255U] << 1 | kSpread[z & 255U] << 2;
}

// Gives whole pages back to the system: they are zero when they are next read.
void release_pages(Bytes pages) {
  if (!pages.empty() && ::madvise(pages.data, pages.size, MADV_DONTNEED) != 0) {
    std::memset(pages.data, 0, pages.size);
  }
}

/// The voxels of a part: bit i of word w is the voxel of Morton code 64 w + i.
struct PartGrid {
  std::uint64_t* words = nullptr;
  std::uint8_t* materials = nullptr;  ///< one a voxel; null where there is one material

  static std::size_t bytes(bool many) { return kPartVoxels / 8 + (many ? kPartVoxels : 0); }
  /// `memory` is all zero.
  PartGrid(Bytes memory, bool many)
      : words(reinterpret_cast<std::uint64_t*>(memory.data)),
        materials(many ? memory.data + kPartVoxels / 8 : nullptr) {}
  PartGrid() = default;

  void add(std::uint32_t voxel, std::uint8_t material) const {
    std::uint64_t& word = words[voxel >> 6];
    const std::uint64_t bit = std::uint64_t{1} << (voxel & 63U);
    if (materials != nullptr) {
      materials[voxel] = (word & bit) == 0 ? material : std::max(materials[voxel], material);
    }
    word |= bit;
  }
};

/// Lists of the points of each part, in chunks; each begins with the address of the one before it. The last points of a
/// part are gathered in a line, so that chunks, which lie far apart, are written to in larger pieces.
class PartLists {
 public:
  PartLists(Bytes room, std::size_t parts, bool many)
      : room_(room), parts_(parts), lines_(parts), many_(many) {}

  /// Adds a point, a byte for x, y, z and the material each from the lowest on. False where there is no room.
  bool add(std::size_t number, std::uint32_t point) {
    Line& line = lines_[number];
    const unsigned used = line.used;
    std::memcpy(line.bytes + used, &point, sizeof point);  // of three bytes the fourth is written over
    line.used = static_cast<std::uint8_t>(used + width());
    return line.used < line_bytes() || write_line(number);
  }
  /// Whether a part's points have a grid already; all others are zero.
  const PartGrid& grid_of(std::size_t number) const { return parts_[number].grid; }
  /// Adds the points of a part's list to `grid`.
  void draw(std::size_t number, const PartGrid& grid) const {
    const auto add = [&](const std::uint8_t* at, std::size_t bytes) {
      for (const std::uint8_t* const end = at + bytes; at != end; at += width()) {
        grid.add(morton_of_bytes(at[0], at[1], at[2]), many_ ? at[3] : std::uint8_t{0});
      }
    };
    const Part& part = parts_[number];
    add(lines_[number].bytes, lines_[number].used);
    std::size_t end = part.used;
    for (const std::uint8_t* chunk = part.chunk; chunk != nullptr; chunk = before(chunk)) {
      add(chunk + sizeof chunk, end - sizeof chunk);
      end = kChunkBytes;
    }
  }
  bool is_empty(std::size_t number) const { return bytes_of(number) + lines_[number].used == 0; }
  std::uint64_t bytes_of(std::size_t number) const {
    const Part& part = parts_[number];
    return part.chunks * kChunkBytes + (part.grid.words != nullptr ? PartGrid::bytes(many_) : 0);
  }
  std::uint64_t bytes() const { return bytes_; }
  /// Empties a part and gives its memory back to the system.
  void drop(std::size_t number) {
    Part& part = parts_[number];
    lines_[number].used = 0;
    drop_list(&part, true);
    if (part.grid.words != nullptr) {
      const Bytes memory(reinterpret_cast<std::uint8_t*>(part.grid.words), PartGrid::bytes(many_));
      release_pages(memory);
      free_grids_.push_back(memory);
      bytes_ -= memory.size;
      part.grid = {};
    }
  }

 private:
  struct Part {
    std::uint8_t* chunk = nullptr;
    std::size_t used = kChunkBytes;  // of that chunk
    std::size_t chunks = 0;
    PartGrid grid;  // of points that came before; without words where there is none
  };
  struct alignas(64) Line {
    std::uint8_t bytes[63];
    std::uint8_t used = 0;
  };

  std::size_t width() const { return many_ ? 4 : 3; }
  unsigned line_bytes() const { return many_ ? 60 : 63; }
  bool write_line(std::size_t number) {
    Part& part = parts_[number];
    if (part.used == kChunkBytes && !add_chunk(&part)) {
      return false;
    }
    std::memcpy(part.chunk + part.used, lines_[number].bytes, line_bytes());
    part.used += line_bytes();
    lines_[number].used = 0;
    return true;
  }
  static std::uint8_t* before(const std::uint8_t* chunk) {
    std::uint8_t* address = nullptr;
    std::memcpy(&address, chunk, sizeof address);
    return address;
  }
  // Memory that was dropped, or new one of zeros; empty where there is none.
  Bytes take(std::vector<Bytes>* dropped, std::size_t size) {
    Bytes taken;
    if (!dropped->empty()) {
      taken = dropped->back();
      dropped->pop_back();
    } else if (size <= room_.size) {
      taken = room_.subspan(0, size);
      room_ = room_.subspan(size);
    }
    bytes_ += taken.size;
    return taken;
  }
  bool add_chunk(Part* part) {
    if (part->chunks * kChunkBytes > PartGrid::bytes(many_)) {
      if (part->grid.words == nullptr) {
        const Bytes memory = take(&free_grids_, PartGrid::bytes(many_));
        if (memory.empty()) {
          return false;
        }
        part->grid = PartGrid(memory, many_);
      }
      draw(static_cast<std::size_t>(part - parts_.data()), part->grid);
      drop_list(part, false);
    }
    const Bytes chunk = take(&free_chunks_, kChunkBytes);
    if (chunk.empty()) {
      return false;
    }
    std::memcpy(chunk.data, &part->chunk, sizeof part->chunk);
    part->chunk = chunk.data;
    part->used = sizeof part->chunk;
    ++part->chunks;
    return true;
  }
  void drop_list(Part* part, bool releases) {
    for (std::uint8_t* chunk = part->chunk; chunk != nullptr;) {
      const Bytes memory(chunk, kChunkBytes);
      chunk = before(chunk);
      if (releases) {
        release_pages(memory);
      }
      free_chunks_.push_back(memory);
    }
    bytes_ -= part->chunks * kChunkBytes;
    part->chunk = nullptr;
    part->used = kChunkBytes;
    part->chunks = 0;
  }

  Bytes room_;
  std::vector<Part> parts_;
  std::vector<Line> lines_;
  bool many_;
  std::vector<Bytes> free_chunks_;
  std::vector<Bytes> free_grids_;
  std::uint64_t bytes_ = 0;
};

// One bit for each byte of `word` that is not zero.
unsigned full_bytes(std::uint64_t word) {
  constexpr std::uint64_t kLow = 0x7F7F7F7F7F7F7F7F;
  const std::uint64_t high = (((word & kLow) + kLow) | word) & ~kLow;
  return static_cast<unsigned>((high >> 7) * 0x0102040810204080U >> 56);
}

/// The nodes of one level in Morton order.
struct LevelNodes {
  std::vector<std::uint8_t> masks;  // room for all that there may be, and for 7 more
  std::size_t count = 0;
  std::uint64_t solid_blocks = 0;
  std::vector<std::uint8_t> block_materials;

  Span<const std::uint8_t> written() const { return {masks.data(), count}; }
};
struct CubeNodes {
  /// For a cube of level `top`: those of `base` up to `highest`.
  CubeNodes(int base, int highest, int top) {
    for (int level = base; level <= highest; ++level) {
      levels[level].masks.resize((std::size_t{1} << (3 * (top - level))) + 7);
    }
  }
  LevelNodes levels[kMaxLevel + 1];
  std::vector<std::uint8_t> voxel_materials;
};

/// All places for nodes of the levels `base` to `top` of one cube, in Morton order.
class MaskPyramid {
 public:
  MaskPyramid(int base, int top) : base_(base), top_(top) {
    for (int level = base; level <= top; ++level) {
      const std::size_t words = level == top ? 1 : std::size_t{1} << (3 * (top - level - 1));
      own_[level].resize(level == 1 ? 0 : words);
      words_[level] = {own_[level].data(), words};
      solid_[level].resize(words);
    }
  }
  /// The masks of the base level, 8 a word, and the materials of what lies a level below (null: there is one). Of the
  /// lowest level of all its nodes are said by the voxels in it; of another `set_solid` says which are solid blocks.
  void set_base(std::uint64_t* words, const std::uint8_t* materials) {
    words_[base_].data = words;
    materials_ = materials;
  }
  void set_solid(std::size_t node) {
    std::uint8_t& mask = solid_[base_][node >> 3];
    mask = static_cast<std::uint8_t>(mask | 1U << (node & 7U));
  }
  unsigned root_mask() const { return static_cast<unsigned>(words_[top_][0] & 0xFFU); }
  bool is_root_solid() const { return (solid_[top_][0] & 1U) != 0; }

  /// Finds the masks of all levels from those of the base.
  void raise() {
    for (int level = base_; level <= top_; ++level) {
      const Span<const std::uint64_t> words(words_[level].data, words_[level].size);
      std::uint8_t* const solid = level == 1 || level > base_ ? solid_[level].data() : nullptr;
      for (std::size_t i = 0; i < words.size; i += 8) {
        std::uint64_t above = 0;
        for (std::size_t k = i; k < std::min(words.size, i + 8); ++k) {
          const std::uint64_t word = words[k];
          above |= std::uint64_t{full_bytes(word)} << (8 * (k & 7U));
          if (solid != nullptr) {
            solid[k] = solid_of(level, k, word);
          }
        }
        if (level < top_) {
          words_[level + 1][i >> 3] = above;
        }
      }
    }
  }

  /// Writes the nodes of levels up to `highest`, in place of what `nodes` had.
  void emit(int highest, CubeNodes* nodes) const {
    nodes->voxel_materials.clear();
    for (int level = base_; level <= highest; ++level) {
      LevelNodes& to = nodes->levels[level];
      to.count = to.solid_blocks = 0;
      to.block_materials.clear();
      for (std::size_t first = 0; first < words_[level].size; first += kRun) {
        emit_run(level, first, &to, &nodes->voxel_materials);
      }
    }
  }

 private:
  static constexpr std::size_t kRun = 512;

  // The nodes of a run of words. Words with nodes are listed first, since to guess which those are takes longer.
  void emit_run(int level, std::size_t first, LevelNodes* to, std::vector<std::uint8_t>* voxels) const {
    const std::uint64_t* const words = words_[level].data;
    const std::uint8_t* const solid_above = level < top_ ? solid_[level + 1].data() : nullptr;
    std::array<std::size_t, kRun> listed;
    std::size_t count = 0;
    for (std::size_t i = first; i < std::min(words_[level].size, first + kRun); ++i) {
      listed[count] = i;
      const bool in_block = solid_above != nullptr && (solid_above[i >> 3] >> (i & 7U) & 1) != 0;
      count += words[i] != 0 && !in_block ? 1 : 0;
    }
    std::uint8_t* next = to->masks.data() + to->count;
    for (const std::size_t i : Span<const std::size_t>(listed.data(), count)) {
      std::uint8_t* const begin = next;
      const std::uint64_t word = words[i];
      for (unsigned node = 0; node < 8; ++node) {
        const auto mask = static_cast<std::uint8_t>(word >> (8 * node));
        *next = mask;
        next += mask != 0 ? 1 : 0;
      }
      for (unsigned left = solid_[level][i]; left != 0; left &= left - 1) {
        begin[std::popcount(full_bytes(word) & ((left & -left) - 1))] = 0;
        ++to->solid_blocks;
      }
      if (materials_ != nullptr) {
        emit_materials(level, i, &to->block_materials, voxels);
      }
    }
    to->count = static_cast<std::size_t>(next - to->masks.data());
  }
  // Below the node: the first of the materials of a solid block stands for all.
  std::uint8_t material(int level, std::size_t node) const {
    return materials_[node << (3 * (level - (base_ == 1 ? 0 : base_)))];
  }
  std::uint8_t solid_of(int level, std::size_t i, std::uint64_t word) const {
    unsigned solid = 255U & ~full_bytes(~word);  // whose children are all there
    for (unsigned left = solid; left != 0; left &= left - 1) {
      const auto node = 8 * i + static_cast<std::size_t>(std::countr_zero(left));
      bool is_solid = level == 1 || solid_[level - 1][node] == 255;
      for (std::size_t child = 1; is_solid && materials_ != nullptr && child < 8; ++child) {
        is_solid = material(level - 1, 8 * node + child) == material(level - 1, 8 * node);
      }
      solid &= is_solid ? 255U : ~(left & -left);
    }
    return static_cast<std::uint8_t>(solid);
  }
  void emit_materials(int level, std::size_t i, std::vector<std::uint8_t>* blocks,
                      std::vector<std::uint8_t>* voxels) const {
    const unsigned solid = solid_[level][i];
    for (unsigned node = 0; node < 8; ++node) {
      const std::size_t number = 8 * i + node;
      if ((solid >> node & 1U) != 0) {
        blocks->push_back(material(level, number));
      } else if (level == 1) {
        for (unsigned left = words_[1][i] >> (8 * node) & 255U; left != 0; left &= left - 1) {
          voxels->push_back(material(0, 8 * number + static_cast<std::size_t>(std::countr_zero(left))));
        }
      }
    }
  }

  int base_;
  int top_;
  std::vector<std::uint64_t> own_[kMaxLevel + 1];
  Span<std::uint64_t> words_[kMaxLevel + 1];
  std::vector<std::uint8_t> solid_[kMaxLevel + 1];  // a bit for each byte of a word
  const std::uint8_t* materials_ = nullptr;
};

/// Writes what a compact tree has beside masks and materials, which stand in their places: header and directory
/// (src/FORMAT.md). Counts the voxels, `in_blocks` of them in solid blocks.
/// @return how many there are; 0 where they are too many for a tree
std::uint64_t complete_tree(const CompactShape& shape, const VoxelBox& bounds, std::uint64_t in_blocks,
                            std::uint8_t material, Bytes tree) {
  const auto store = [&](std::size_t at, std::uint64_t value, std::size_t size) {
    put_little(tree.data + at, value, size);
  };
  const std::uint8_t* const masks = tree.data + kCompactHeaderBytes;
  const std::size_t ranks = kCompactHeaderBytes + ((std::size_t{shape.nodes} + 3) & ~std::size_t{3});
  const std::size_t blocks = (std::size_t{shape.nodes} + 63) / 64;
  std::memset(tree.data + kCompactHeaderBytes + shape.nodes, 0, ranks - kCompactHeaderBytes - shape.nodes);
  std::uint64_t children = 0;
  std::uint64_t solid_blocks = 0;
  for (std::size_t block = 0; block < blocks; ++block) {
    store(ranks + 4 * block, children, 4);
    if (shape.many_materials && shape.solid_blocks != 0) {
      store(ranks + 4 * (blocks + block), solid_blocks, 4);
    }
    std::array<std::uint64_t, 8> words{};
    const std::size_t size = std::min<std::size_t>(64, shape.nodes - 64 * block);
    std::memcpy(words.data(), masks + 64 * block, size);
    children += count_bits({words.data(), words.size()});
    for (std::size_t i = 0; shape.many_materials && i < size; ++i) {
      solid_blocks += masks[64 * block + i] == 0 ? 1 : 0;
    }
  }
  const std::uint64_t voxel_bits = children + 1 - shape.nodes;
  if (voxel_bits > UINT32_MAX) {
    return 0;
  }
  if (shape.many_materials) {
    const std::uint64_t end = std::uint64_t{shape.solid_blocks} + shape.voxel_bits;
    const auto padding = static_cast<std::size_t>((0 - end) & 3U);
    std::memset(tree.data + tree.size - padding, 0, padding);
  }
  std::memset(tree.data, 0, kCompactHeaderBytes);
  std::memcpy(tree.data, "TMB\1", 4);
  store(4, static_cast<std::uint64_t>(shape.level), 1);
  store(5, kDefaultRankShift, 1);
  store(6, shape.many_materials ? 1 : 0, 1);
  store(7, material, 1);
  store(8, tree.size, 4);
  store(16, shape.nodes, 4);
  store(20, shape.solid_blocks, 4);
  store(24, voxel_bits, 4);
  for (int axis = 0; axis < 3; ++axis) {
    store(28 + 2 * static_cast<std::size_t>(axis), static_cast<std::uint64_t>(bounds.low[axis]), 2);
    store(34 + 2 * static_cast<std::size_t>(axis), static_cast<std::uint64_t>(bounds.high[axis]), 2);
  }
  store(40, voxel_bits + in_blocks, 8);
  store(12, crc32({tree.data + 16, tree.size - 16}, crc32({tree.data, 12})), 4);
  return voxel_bits + in_blocks;
}

/// What a thread draws parts in.
struct PartWorker {
  explicit PartWorker(bool many)
      : memory(PartGrid::bytes(many)), grid(memory.bytes(), many), pyramid(1, kPartLevel) {}
  HostMemory memory;
  PartGrid grid;
  MaskPyramid pyramid;
};

/// A part as the tree of its cube, without its root.
struct BuiltPart {
  std::size_t number = 0;
  CubeNodes nodes{1, kPartLevel - 1, kPartLevel};
  unsigned root_mask = 0;
  bool is_solid = false;
  std::uint8_t material = 0;  // of a solid one

  void build(const PartLists& lists, PartWorker* worker) {
    const PartGrid& kept = lists.grid_of(number);
    const PartGrid& grid = kept.words != nullptr ? kept : worker->grid;
    lists.draw(number, grid);
    MaskPyramid& pyramid = worker->pyramid;
    pyramid.set_base(grid.words, grid.materials);
    pyramid.raise();
    pyramid.emit(kPartLevel - 1, &nodes);
    root_mask = pyramid.root_mask();
    is_solid = pyramid.is_root_solid();
    material = grid.materials != nullptr ? grid.materials[0] : std::uint8_t{0};
    if (kept.words == nullptr) {
      std::memset(grid.words, 0, kPartVoxels / 8);
    }
  }
};

/// The tree as it grows: bytes of each level in a stretch of the room that holds all there may be of them, in the order of
/// the tree, so that in the end each only moves down.
class GrowingTree {
 public:
  GrowingTree(const SceneSource& source, Bytes room)
      : level_(source.level()), many_(!source.single_material()), room_(room), roots_(kPartLevel, level_) {
    const std::size_t parts = std::size_t{1} << (3 * (level_ - kPartLevel));
    const auto points = static_cast<std::size_t>(source.points());
    materials_.resize(many_ ? parts : 0);
    root_words_.resize((parts + 7) / 8);
    std::size_t at = up(kCompactHeaderBytes + 2 * parts);
    for (int level = kPartLevel - 1; level >= 1; --level) {
      stretches_[level] = {at, 0};
      at = up(at + std::min(points, std::size_t{1} << (3 * (level_ - level))));
    }
    // The directory comes between masks and materials.
    at = up(at + at / 8 + points / 8);
    stretches_[0] = {at, 0};
    end_ = up(at + (many_ ? points : 0));
  }
  /// Where what is behind the stretches begins.
  std::size_t end() const { return end_; }
  std::uint64_t bytes() const { return bytes_; }

  void append(const BuiltPart& part) {
    for (int level = 1; level < kPartLevel; ++level) {
      const LevelNodes& nodes = part.nodes.levels[level];
      append(level, nodes.written());
      solid_blocks_[level] += nodes.solid_blocks;
      block_materials_[level].insert(block_materials_[level].end(), nodes.block_materials.begin(),
                                     nodes.block_materials.end());
    }
    append(0, {part.nodes.voxel_materials.data(), part.nodes.voxel_materials.size()});
    root_words_[part.number >> 3] |= std::uint64_t{part.root_mask} << (8 * (part.number & 7U));
    if (part.is_solid) {
      roots_.set_solid(part.number);
    }
    if (many_) {
      materials_[part.number] = part.material;
    }
  }

  /// The tree's bytes, at the front of the room, and its voxels; empty where a tree cannot hold them.
  void finish(const VoxelBox& bounds, PointTree* result) {
    roots_.set_base(root_words_.data(), many_ ? materials_.data() : nullptr);
    roots_.raise();
    CubeNodes top(kPartLevel, level_, level_);
    roots_.emit(level_, &top);
    if (top.levels[level_].count == 0) {
      return;
    }
    CompactShape shape;
    shape.level = level_;
    std::uint64_t nodes = 0;
    std::uint64_t blocks = 0;
    std::uint64_t in_blocks = 0;  // voxels
    std::vector<std::uint8_t> block_materials;
    for (int level = level_; level >= 1; --level) {
      const LevelNodes& own = top.levels[level];
      const bool is_top = level >= kPartLevel;
      nodes += is_top ? own.count : stretches_[level].size;
      const std::uint64_t solid = is_top ? own.solid_blocks : solid_blocks_[level];
      blocks += solid;
      in_blocks += solid << (3 * level);
      const std::vector<std::uint8_t>& shown = is_top ? own.block_materials : block_materials_[level];
      block_materials.insert(block_materials.end(), shown.begin(), shown.end());
    }
    shape.nodes = static_cast<std::uint32_t>(nodes);
    shape.solid_blocks = static_cast<std::uint32_t>(blocks);
    shape.voxel_bits = static_cast<std::uint32_t>(stretches_[0].size);  // where there are several materials
    const std::uint8_t material = material_of_all(block_materials, &shape.many_materials);
    const std::size_t bytes = compact_bytes(shape);
    if (bytes == 0 || nodes > UINT32_MAX || stretches_[0].size > UINT32_MAX) {
      return;
    }
    std::size_t to = kCompactHeaderBytes;
    for (int level = level_; level >= kPartLevel; --level) {
      const Span<const std::uint8_t> own = top.levels[level].written();
      std::memcpy(room_.data + to, own.data, own.size);
      to += own.size;
    }
    for (int level = kPartLevel - 1; level >= 1; --level) {
      to = move_down(stretches_[level], to);
    }
    if (shape.many_materials) {
      to = bytes - static_cast<std::size_t>((blocks + stretches_[0].size + 3) & ~std::uint64_t{3});
      std::memcpy(room_.data + to, block_materials.data(), block_materials.size());
      move_down(stretches_[0], to + block_materials.size());
    }
    release_pages(room_.subspan(up(bytes), end_ - up(bytes)));
    result->voxels = complete_tree(shape, bounds, in_blocks, material, room_.subspan(0, bytes));
    result->tree = result->voxels == 0 ? Bytes() : room_.subspan(0, bytes);
  }

 private:
  struct Stretch {
    std::size_t first = 0, size = 0;
  };
  // To a page, so that it can be given back.
  std::size_t up(std::size_t place) const {
    return place + (-reinterpret_cast<std::size_t>(room_.data + place) & 4095U);
  }

  void append(int stretch, Span<const std::uint8_t> bytes) {
    Stretch& to = stretches_[stretch];
    if (bytes.size != 0) {
      std::memcpy(room_.data + to.first + to.size, bytes.data, bytes.size);
    }
    to.size += bytes.size;
    bytes_ += bytes.size;
  }
  // A piece at a time, whose pages then go back, so that nothing is there twice.
  std::size_t move_down(const Stretch& from, std::size_t to) {
    constexpr std::size_t kPiece = std::size_t{8} << 20;
    for (std::size_t done = 0; done < from.size; done += kPiece) {
      const std::size_t size = std::min(kPiece, from.size - done);
      std::memmove(room_.data + to + done, room_.data + from.first + done, size);
      const std::size_t written = up(to + done + size);
      const std::size_t first = std::max(written, from.first + done);
      const std::size_t end = from.first + done + size == from.first + from.size ? up(from.first + from.size)
                                                                                 : from.first + done + size;
      if (first < end) {
        release_pages(room_.subspan(first, end - first));
      }
    }
    return to + from.size;
  }
  // The material of all, where there is but one: materials of voxels are compared, too.
  std::uint8_t material_of_all(const std::vector<std::uint8_t>& blocks, bool* many) const {
    const Span<const std::uint8_t> voxels(room_.data + stretches_[0].first, stretches_[0].size);
    const std::uint8_t first = voxels.size != 0 ? voxels[0] : !blocks.empty() ? blocks[0] : std::uint8_t{0};
    const auto differs = [first](std::uint8_t material) { return material != first; };
    *many = std::any_of(voxels.begin(), voxels.end(), differs) ||
            std::any_of(blocks.begin(), blocks.end(), differs);
    return *many ? std::uint8_t{0} : first;
  }

  int level_;
  bool many_;
  Bytes room_;
  MaskPyramid roots_;
  std::vector<std::uint64_t> root_words_;
  std::vector<std::uint8_t> materials_;  // of parts that are solid
  Stretch stretches_[kPartLevel];        // masks by level; 0: materials of voxels
  std::uint64_t solid_blocks_[kPartLevel] = {};
  std::vector<std::uint8_t> block_materials_[kPartLevel];
  std::size_t end_ = 0;
  std::uint64_t bytes_ = 0;
};

struct DealtPoint {
  std::uint32_t part;
  std::uint32_t point;
};

/// Hands points to `deal` many at a time, with several threads on another one while the next points come. What `deal`
/// throws, `add` or `finish` does.
class PointBatches {
 public:
  PointBatches(int threads, std::function<void(const std::vector<DealtPoint>& points)> deal)
      : policy_(threads > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred),
        deal_(std::move(deal)) {}

  void add(const DealtPoint& point) {
    coming_.push_back(point);
    if (coming_.size() == std::size_t{1} << 16) {
      hand_over();
    }
  }
  void finish() {
    hand_over();
    dealing_.get();
  }

 private:
  void hand_over() {
    if (dealing_.valid()) {
      dealing_.get();
    }
    dealt_.swap(coming_);
    coming_.clear();
    dealing_ = std::async(policy_, [this] { deal_(dealt_); });
  }

  std::launch policy_;
  std::function<void(const std::vector<DealtPoint>& points)> deal_;
  std::vector<DealtPoint> coming_;
  std::vector<DealtPoint> dealt_;
  std::future<void> dealing_;  // the last: whatever is thrown, it ends before what it reads goes
};

/// Streams the source once into the lists of the parts from `first` on. Where these take too much the last parts are
/// left for another time.
/// @return the first part that is left out; `first` where there is no room
std::size_t deal_points(const SceneSource& source, std::size_t first, std::size_t end,
                        std::uint64_t most_bytes, int threads, PartLists* lists, VoxelBox* bounds,
                        const Progress& progress) {
  struct NoRoom {};
  const auto shorten = [&] {
    std::uint64_t kept = 0;
    std::size_t last = first;
    while (last < end && (last == first || kept + lists->bytes_of(last) <= most_bytes / 2)) {
      kept += lists->bytes_of(last++);
    }
    while (end > last) {
      lists->drop(--end);
    }
  };
  PointBatches batches(threads, [&](const std::vector<DealtPoint>& points) {
    for (const DealtPoint& dealt : points) {
      if (dealt.part < end && !lists->add(dealt.part, dealt.point)) {
        throw NoRoom{};
      }
      if (lists->bytes() > most_bytes && end - first > 1) {
        shorten();
      }
    }
  });
  std::array<std::array<bool, std::size_t{1} << kMaxLevel>, 3> is_taken{};  // places along each axis
  try {
    source.stream(
        [&](std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material) {
          const auto ux = static_cast<std::uint32_t>(x);
          const auto uy = static_cast<std::uint32_t>(y);
          const auto uz = static_cast<std::uint32_t>(z);
          is_taken[0][ux] = is_taken[1][uy] = is_taken[2][uz] = true;
          const std::uint32_t part = morton_of_bytes(ux >> kPartLevel, uy >> kPartLevel, uz >> kPartLevel);
          if (part >= first) {
            batches.add(
                {part, (ux & 255U) | (uy & 255U) << 8 | (uz & 255U) << 16 | std::uint32_t{material} << 24});
          }
        },
        progress);
    batches.finish();
  } catch (const NoRoom&) {
    return first;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const auto& taken = is_taken[static_cast<std::size_t>(axis)];
    const auto low = std::find(taken.begin(), taken.end(), true);
    const auto high = std::find(taken.rbegin(), taken.rend(), true);
    bounds->low[axis] = static_cast<std::int32_t>(low - taken.begin());
    bounds->high[axis] = static_cast<std::int32_t>(taken.rend() - high);
  }
  return end;
}

}  // namespace

PointTree build_point_tree(const SceneSource& source, Bytes room, int threads, const Progress& progress,
                           std::uint64_t most_list_bytes) {
  const bool many = !source.single_material();
  const std::size_t parts = std::size_t{1} << (3 * (source.level() - kPartLevel));
  PointTree result;
  GrowingTree tree(source, room);
  if (room.size < tree.end()) {
    return {};
  }
  PartLists lists(room.subspan(tree.end()), parts, many);
  std::vector<PartWorker> workers;
  workers.reserve(static_cast<std::size_t>(threads));
  for (int worker = 0; worker < threads; ++worker) {
    workers.emplace_back(many);
  }
  // More parts than threads, since some take longer.
  std::vector<BuiltPart> batch(static_cast<std::size_t>(threads == 1 ? 1 : 4 * threads));
  VoxelBox bounds;
  for (std::size_t first = 0; first < parts;) {
    const std::size_t end =
        deal_points(source, first, parts, most_list_bytes, threads, &lists, &bounds, progress);
    if (end == first) {
      return {};
    }
    result.most_bytes = std::max(result.most_bytes, lists.bytes() + tree.bytes());
    while (first < end) {
      std::size_t count = 0;
      for (; first < end && count < batch.size(); ++first) {
        if (!lists.is_empty(first)) {
          batch[count++].number = first;
        }
      }
      each_task(count, threads,
                [&](std::size_t task, std::size_t worker) { batch[task].build(lists, &workers[worker]); });
      for (std::size_t i = 0; i < count; ++i) {
        tree.append(batch[i]);
        lists.drop(batch[i].number);
      }
    }
  }
  tree.finish(bounds, &result);
  result.most_bytes = std::max<std::uint64_t>(result.most_bytes, result.tree.size);
  return result;
}

}  // namespace thimble::tools
