#include "wide/raster/surface.h"

namespace thimble::wide {
namespace {

// The voxels of a word whose coordinate along an axis is 0, 1, 2 or 3. A word's bits are numbered x0 y0 z0 x1
// y1 z1, the lowest first.
struct Layers {
  uint64_t of[3][4] = {};
  constexpr Layers() {
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (unsigned bit = 0; bit < 64; ++bit) {
        of[axis][(bit >> axis & 1U) | (bit >> (3 + axis) & 1U) << 1] |= uint64_t{1} << bit;
      }
    }
  }
};
constexpr Layers kLayers;

// The voxels of a word whose neighbour on a side is solid: below and above along x, y and z. `other` is the word there.
inline uint64_t with_beside(uint64_t word, uint64_t other, unsigned side) {
  const unsigned axis = side / 2;
  const uint64_t(&at)[4] = kLayers.of[axis];
  const unsigned one = 1U << axis;  // from 0 to 1, and from 2 to 3
  const unsigned two = 7U << axis;  // from 1 to 2
  const unsigned all = 9U << axis;  // from 3 back to 0
  return side % 2 == 0 ? (word << one & (at[1] | at[3])) | (word << two & at[2]) | (other >> all & at[0])
                       : (word >> one & (at[0] | at[2])) | (word >> two & at[1]) | (other << all & at[3]);
}

// For every mask of 2 x 2 x 2 voxels: how many have all three neighbours in the mask.
struct HiddenCounts {
  uint8_t of[256] = {};
  constexpr HiddenCounts() {
    for (unsigned mask = 0; mask < 256; ++mask) {
      for (unsigned voxel = 0; voxel < 8; ++voxel) {
        const unsigned wanted = 1U << voxel | 1U << (voxel ^ 1U) | 1U << (voxel ^ 2U) | 1U << (voxel ^ 4U);
        of[mask] = static_cast<uint8_t>(of[mask] + ((mask & wanted) == wanted ? 1 : 0));
      }
    }
  }
};
constexpr HiddenCounts kHiddenCounts;

// Some of the voxels of a 4 x 4 x 4 cube.
struct SurfaceWord {
  uint64_t listed;     // voxels with a neighbour that is not solid; at least one
  unsigned facing;     // see BlockNode
  uint32_t corner[3];  // lowest voxel
  // What the cube is made of: its nodes of level 1, the first of them and the number of their first voxel; or, where
  // `block` says so, one solid block and its material.
  unsigned children;  // mask of these nodes
  uint32_t first_child;
  uint32_t first_voxel;
  bool block;
  uint8_t material;
};

// The part of SurfaceWalk (below) that does not depend on its sink.
class SurfaceFinder {
 protected:
  // A cube of the world is one of these, or else the number of its node.
  static constexpr uint32_t kNothing = UINT32_MAX;
  static constexpr uint32_t kSolid = UINT32_MAX - 1;
  // A cube's children: their mask, and the number of the first of their nodes. All children of a solid cube are solid.
  struct Family {
    bool is_solid;
    unsigned mask;
    uint32_t first_child;
  };
  // A cube, and its neighbours of the same size: below and above along x, y and z.
  struct Cube {
    int level;
    uint32_t corner[3];
    uint32_t beside[6];
  };
  // A cube with its own children and those of its neighbours.
  struct OpenCube {
    int level;
    uint32_t corner[3];
    Family self;
    Family beside[6];
  };
  // The voxels of a word that are listed, and the ways from which they may be seen (BlockNode).
  struct Surface {
    uint64_t listed;
    unsigned facing;
  };
  // The eight words of a cube of level 3, by octant.
  struct Words {
    bool is_known = false;
    uint64_t of[8] = {};
  };

  // `level_begin`: the first node of every level.
  SurfaceFinder(const CompactTree& tree, const uint32_t* level_begin) : tree_(tree) {
    for (int level = 1; level <= tree.level(); ++level) {
      next_node_[level] = level_begin[level];
    }
  }

  Family family_of(uint32_t cube) const {
    if (cube == kNothing || cube == kSolid) {
      return {cube == kSolid, 0, 0};
    }
    return {false, tree_.mask(cube), tree_.first_child(cube)};
  }

  uint32_t child_of(const Family& family, unsigned octant) const {
    if (family.is_solid) {
      return kSolid;
    }
    if ((family.mask >> octant & 1U) == 0) {
      return kNothing;
    }
    const uint32_t child =
        family.first_child + static_cast<uint32_t>(__builtin_popcount(family.mask & ((1U << octant) - 1)));
    return child >= tree_.node_count() ? kNothing : tree_.mask(child) == 0 ? kSolid : child;
  }

  // A damaged directory may make `first_child` any number.
  uint64_t word_from(unsigned mask, uint32_t first_child) const {
    uint64_t word = 0;
    if (uint64_t{first_child} + static_cast<unsigned>(__builtin_popcount(mask)) > tree_.node_count()) {
      return 0;
    }
    for (uint32_t child = first_child; mask != 0; mask &= mask - 1, ++child) {
      const unsigned octant = static_cast<unsigned>(__builtin_ctz(mask));
      const uint64_t voxels = tree_.mask(child);
      word |= (voxels == 0 ? uint64_t{0xFF} : voxels) << (8 * octant);
    }
    return word;
  }

  uint64_t word_of(uint32_t cube) const {
    const Family family = family_of(cube);
    return family.is_solid ? ~uint64_t{0} : word_from(family.mask, family.first_child);
  }

  // Finds those words of a cube's neighbour at side `side` that touch the cube.
  void find_words(const Family& family, unsigned side, Words* words) const {
    words->is_known = true;
    if (family.is_solid) {
      for (uint64_t& word : words->of) {
        word = ~uint64_t{0};
      }
      return;
    }
    if (family.mask == 0 || family.first_child >= tree_.node_count()) {
      return;
    }
    // Nodes that stand one after the other have children that do so, too.
    uint32_t child = family.first_child;
    uint32_t below = tree_.first_child(child);
    for (unsigned left = family.mask; left != 0 && child < tree_.node_count(); left &= left - 1, ++child) {
      const unsigned octant = static_cast<unsigned>(__builtin_ctz(left));
      const unsigned mask = tree_.mask(child);
      if ((octant >> (side >> 1) & 1U) != (side & 1U)) {
        words->of[octant] = mask == 0 ? ~uint64_t{0} : word_from(mask, below);
      }
      below += static_cast<uint32_t>(__builtin_popcount(mask));
    }
  }

  Cube part_of(const OpenCube& cube, unsigned octant) const {
    Cube part{cube.level - 1, {}, {}};
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned is_upper = octant >> axis & 1U;
      const unsigned outside = 2 * axis + is_upper;
      part.corner[axis] = cube.corner[axis] + (is_upper << part.level);
      part.beside[outside] = child_of(cube.beside[outside], octant ^ 1U << axis);
      part.beside[outside ^ 1U] = child_of(cube.self, octant ^ 1U << axis);
    }
    return part;
  }

  OpenCube open(const Cube& cube, const Family& self) const {
    OpenCube opened{cube.level, {cube.corner[0], cube.corner[1], cube.corner[2]}, self, {}};
    for (unsigned side = 0; side < 6; ++side) {
      opened.beside[side] = family_of(cube.beside[side]);
    }
    return opened;
  }

  // Finds the listed voxels of the cube's word in `octant`; `beside` holds the words of the neighbouring cubes, which are
  // looked up when they are needed.
  Surface surface_of(const Words& words, unsigned octant, const OpenCube& cube, Words (&beside)[6]) const {
    const uint64_t word = words.of[octant];
    uint64_t others[6];
    for (unsigned side = 0; side < 6; ++side) {
      const unsigned other = octant ^ 1U << (side >> 1);
      if ((octant >> (side >> 1) & 1U) != (side & 1U)) {
        others[side] = words.of[other];
        continue;
      }
      if (!beside[side].is_known) {
        find_words(cube.beside[side], side, &beside[side]);
      }
      others[side] = beside[side].of[other];
    }
    return surface_between(word, others);
  }

  // The same for a world of one word, and for a solid word.
  Surface surface_of_word(uint64_t word, const Cube& cube) const {
    uint64_t others[6];
    for (unsigned side = 0; side < 6; ++side) {
      others[side] = word_of(cube.beside[side]);
    }
    return surface_between(word, others);
  }

  static Surface surface_between(uint64_t word, const uint64_t (&others)[6]) {
    uint64_t below[3];  // voxels whose neighbour on that side is solid
    uint64_t above[3];
#pragma GCC unroll 3
    for (unsigned axis = 0; axis < 3; ++axis) {
      below[axis] = with_beside(word, others[2 * axis], 2 * axis);
      above[axis] = with_beside(word, others[2 * axis + 1], 2 * axis + 1);
    }
    const uint64_t hidden = below[0] & below[1] & below[2] & above[0] & above[1] & above[2];
    Surface surface{word & ~hidden, 0};
    for (unsigned octant = 0; octant < 8; ++octant) {
      uint64_t behind = ~uint64_t{0};
      for (unsigned axis = 0; axis < 3; ++axis) {
        behind &= (octant >> axis & 1U) != 0 ? above[axis] : below[axis];
      }
      surface.facing |= (surface.listed & ~behind) != 0 ? 1U << octant : 0U;
    }
    return surface;
  }

  static bool is_enclosed(const Cube& cube) {
    for (const uint32_t beside : cube.beside) {
      if (beside != kSolid) {
        return false;
      }
    }
    return true;
  }

  const CompactTree& tree_;
  uint32_t next_node_[kMaxLevel + 1] = {};  // the next node of each level
  uint32_t voxels_ = 0;                     // voxels in nodes of level 1 before this place
};

// Walks the surface of a tree.
template <class Sink>
class SurfaceWalk : SurfaceFinder {
 public:
  // Each word is handed to `sink.add(const SurfaceWord&)`.
  SurfaceWalk(const CompactTree& tree, const uint32_t* level_begin, Sink* sink)
      : SurfaceFinder(tree, level_begin), sink_(sink) {}

  void walk() {
    enter(Cube{tree_.level(), {0, 0, 0}, {kNothing, kNothing, kNothing, kNothing, kNothing, kNothing}});
  }

 private:
  // Walks a cube; its node is the next one of its level.
  void enter(const Cube& cube) {
    const uint32_t node = next_node_[cube.level]++;
    const unsigned mask = tree_.mask(node);
    if (mask == 0) {
      add_solid(cube, tree_.block_material(node));
    } else if (cube.level == 2) {  // a world of one word
      const SurfaceWord word = take_word(mask, cube.corner);
      add(word, surface_of_word(word.listed, cube));
    } else {
      const OpenCube opened = open(cube, Family{false, mask, next_node_[cube.level - 1]});
      if (cube.level == 3) {
        add_words(opened);
        return;
      }
      for (unsigned left = mask; left != 0; left &= left - 1) {
        enter(part_of(opened, static_cast<unsigned>(__builtin_ctz(left))));
      }
    }
  }

  void add_words(const OpenCube& cube) {
    Words words;
    SurfaceWord found[8];
    for (unsigned left = cube.self.mask; left != 0; left &= left - 1) {
      const unsigned octant = static_cast<unsigned>(__builtin_ctz(left));
      const uint32_t corner[3] = {cube.corner[0] + 4 * (octant & 1U), cube.corner[1] + 4 * (octant >> 1 & 1U),
                                  cube.corner[2] + 4 * (octant >> 2)};
      const uint32_t node = next_node_[2]++;
      const unsigned mask = tree_.mask(node);
      found[octant] = mask != 0 ? take_word(mask, corner) : solid_word(corner, tree_.block_material(node));
      words.of[octant] = found[octant].listed;
    }
    Words beside[6];
    for (unsigned left = cube.self.mask; left != 0; left &= left - 1) {
      const unsigned octant = static_cast<unsigned>(__builtin_ctz(left));
      add(found[octant], surface_of(words, octant, cube, beside));
    }
  }

  void add_solid(const Cube& cube, uint8_t material) {
    if (is_enclosed(cube)) {
      return;
    }
    if (cube.level == 2) {
      add(solid_word(cube.corner, material), surface_of_word(~uint64_t{0}, cube));
      return;
    }
    const OpenCube opened = open(cube, Family{true, 0, 0});
    for (unsigned octant = 0; octant < 8; ++octant) {
      add_solid(part_of(opened, octant), material);
    }
  }

  // Makes the word of a node with this mask; all its voxels are listed.
  SurfaceWord take_word(unsigned mask, const uint32_t (&corner)[3]) {
    const uint32_t first_child = next_node_[1];
    const uint32_t first_voxel = voxels_;
    const uint32_t children = static_cast<uint32_t>(__builtin_popcount(mask));
    for (uint32_t child = 0; child < children; ++child) {
      voxels_ += static_cast<uint32_t>(__builtin_popcount(tree_.mask(first_child + child)));
    }
    next_node_[1] += children;
    return {word_from(mask, first_child),
            0,
            {corner[0], corner[1], corner[2]},
            mask,
            first_child,
            first_voxel,
            false,
            0};
  }
  static SurfaceWord solid_word(const uint32_t (&corner)[3], uint8_t material) {
    return {~uint64_t{0}, 0, {corner[0], corner[1], corner[2]}, 0, 0, 0, true, material};
  }

  void add(SurfaceWord word, const Surface& surface) {
    word.listed = surface.listed;
    word.facing = surface.facing;
    if (surface.listed != 0) {
      sink_->add(word);
    }
  }

  Sink* sink_;
};

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

unsigned most_hidden(unsigned mask) {
  return kHiddenCounts.of[mask & 0xFFU];
}

bool solid_at(const CompactTree& tree, const int32_t (&voxel)[3], int* level) {
  const int32_t side = int32_t{1} << tree.level();
  *level = 0;
  for (const int32_t at : voxel) {
    if (at < 0 || at >= side) {
      return false;
    }
  }
  *level = tree.level();
  if (tree.empty()) {
    return false;
  }
  uint32_t node = 0;
  for (;;) {
    const unsigned mask = tree.mask(node);
    if (mask == 0) {
      return true;
    }
    --*level;
    const unsigned octant = (static_cast<unsigned>(voxel[0]) >> *level & 1U) |
                            (static_cast<unsigned>(voxel[1]) >> *level & 1U) << 1 |
                            (static_cast<unsigned>(voxel[2]) >> *level & 1U) << 2;
    const bool is_set = (mask >> octant & 1U) != 0;
    if (!is_set || *level == 0) {
      return is_set;
    }
    node = tree.first_child(node) + static_cast<uint32_t>(__builtin_popcount(mask & ((1U << octant) - 1)));
    if (node >= tree.node_count()) {
      return false;
    }
  }
}

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
