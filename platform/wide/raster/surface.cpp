#include "wide/raster/surface.h"

namespace thimble::wide {
namespace {

// The voxels of a word whose coordinate along an axis is 0, 1, 2 or 3. A word's bits are numbered x0 y0 z0 x1
// y1 z1, the lowest first.
constexpr uint64_t layer(unsigned axis, unsigned at) {
  uint64_t bits = 0;
  for (unsigned bit = 0; bit < 64; ++bit) {
    const unsigned coordinate = (bit >> axis & 1U) | (bit >> (3 + axis) & 1U) << 1;
    bits |= uint64_t{coordinate == at ? 1U : 0U} << bit;
  }
  return bits;
}
struct Layers {
  uint64_t of[3][4] = {};
  constexpr Layers() {
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (unsigned at = 0; at < 4; ++at) {
        of[axis][at] = layer(axis, at);
      }
    }
  }
};
constexpr Layers kLayers;

// The voxels of a word whose upper neighbour along an axis is solid; `next` is the word above.
template <unsigned kAxis>
uint64_t with_upper(uint64_t word, uint64_t next) {
  const uint64_t(&at)[4] = kLayers.of[kAxis];
  constexpr unsigned kOne = 1U << kAxis;  // from 0 to 1, and from 2 to 3
  constexpr unsigned kTwo = 7U << kAxis;  // from 1 to 2
  constexpr unsigned kAll = 9U << kAxis;  // from 3 back to 0
  return (word >> kOne & (at[0] | at[2])) | (word >> kTwo & at[1]) | (next << kAll & at[3]);
}
// The voxels whose lower neighbour along an axis is solid; `before` is the word below.
template <unsigned kAxis>
uint64_t with_lower(uint64_t word, uint64_t before) {
  const uint64_t(&at)[4] = kLayers.of[kAxis];
  constexpr unsigned kOne = 1U << kAxis;
  constexpr unsigned kTwo = 7U << kAxis;
  constexpr unsigned kAll = 9U << kAxis;
  return (word << kOne & (at[1] | at[3])) | (word << kTwo & at[2]) | (before >> kAll & at[0]);
}

uint64_t with_beside(uint64_t word, uint64_t other, unsigned side) {
  switch (side) {
    case 0:
      return with_lower<0>(word, other);
    case 1:
      return with_upper<0>(word, other);
    case 2:
      return with_lower<1>(word, other);
    case 3:
      return with_upper<1>(word, other);
    case 4:
      return with_lower<2>(word, other);
    default:
      return with_upper<2>(word, other);
  }
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

SurfaceFinder::SurfaceFinder(const CompactTree& tree, const uint32_t* level_begin) : tree_(tree) {
  for (int level = 1; level <= tree.level(); ++level) {
    next_node_[level] = level_begin[level];
  }
}

SurfaceFinder::Family SurfaceFinder::family_of(uint32_t cube) const {
  if (cube == kNothing || cube == kSolid) {
    return {cube == kSolid, 0, 0};
  }
  return {false, tree_.mask(cube), tree_.first_child(cube)};
}

uint32_t SurfaceFinder::child_of(const Family& family, unsigned octant) const {
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
uint64_t SurfaceFinder::word_from(unsigned mask, uint32_t first_child) const {
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

uint64_t SurfaceFinder::word_of(uint32_t cube) const {
  const Family family = family_of(cube);
  return family.is_solid ? ~uint64_t{0} : word_from(family.mask, family.first_child);
}

// Finds those words of a cube's neighbour at side `side` that touch the cube.
void SurfaceFinder::find_words(const Family& family, unsigned side, Words* words) const {
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

SurfaceFinder::Cube SurfaceFinder::part_of(const OpenCube& cube, unsigned octant) const {
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

SurfaceFinder::OpenCube SurfaceFinder::open(const Cube& cube, const Family& self) const {
  OpenCube opened{cube.level, {cube.corner[0], cube.corner[1], cube.corner[2]}, self, {}};
  for (unsigned side = 0; side < 6; ++side) {
    opened.beside[side] = family_of(cube.beside[side]);
  }
  return opened;
}

SurfaceFinder::Surface SurfaceFinder::surface_of(const Words& words, unsigned octant, const OpenCube& cube,
                                                 Words (&beside)[6]) const {
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

SurfaceFinder::Surface SurfaceFinder::surface_of_word(uint64_t word, const Cube& cube) const {
  uint64_t others[6];
  for (unsigned side = 0; side < 6; ++side) {
    others[side] = word_of(cube.beside[side]);
  }
  return surface_between(word, others);
}

SurfaceFinder::Surface SurfaceFinder::surface_between(uint64_t word, const uint64_t (&others)[6]) {
  uint64_t below[3];  // voxels whose neighbour on that side is solid
  uint64_t above[3];
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

bool SurfaceFinder::is_enclosed(const Cube& cube) {
  for (const uint32_t beside : cube.beside) {
    if (beside != kSolid) {
      return false;
    }
  }
  return true;
}

}  // namespace thimble::wide
