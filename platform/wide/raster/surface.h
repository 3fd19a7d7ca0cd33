/// @file surface.h
/// Finds the voxels of a compact tree that have a neighbour which is not solid, in Morton order.
///
/// The tree is read in words of 4 x 4 x 4 voxels, a bit each in Morton order. Six shifts of a word and of its
/// neighbours say which of its voxels are hidden; neighbours are looked up only where the word itself leaves that open.
/// Solid blocks are cut only where one of their faces is not known to be covered, so the work grows with the surface,
/// not with the volume.
#ifndef THIMBLE_PLATFORM_WIDE_RASTER_SURFACE_H
#define THIMBLE_PLATFORM_WIDE_RASTER_SURFACE_H

#include <stdint.h>

#include "thimble/tree/compact_tree.h"

namespace thimble::wide {

/// Some of the voxels of a 4 x 4 x 4 cube.
struct SurfaceWord {
  uint64_t listed;     ///< voxels with a neighbour that is not solid; at least one
  unsigned facing;     ///< see BlockNode
  uint32_t corner[3];  ///< lowest voxel
  /// What the cube is made of: its nodes of level 1, the first of them and the number of their first voxel; or, where
  /// `block` says so, one solid block and its material.
  unsigned children;  ///< mask of these nodes
  uint32_t first_child;
  uint32_t first_voxel;
  bool block;
  uint8_t material;
};

/// Whether the voxel is solid; false outside the world. Sets `level` to that of a block around the voxel that is wholly
/// solid or wholly empty.
bool solid_at(const CompactTree& tree, const int32_t (&voxel)[3], int* level);

/// The most voxels of a 2 x 2 x 2 cube with this mask that can have six solid neighbours: those whose three neighbours
/// in the cube are solid.
unsigned most_hidden(unsigned mask);

/// The part of SurfaceWalk (below) that does not depend on its sink.
class SurfaceFinder {
 protected:
  /// A cube of the world is one of these, or else the number of its node.
  static constexpr uint32_t kNothing = UINT32_MAX;
  static constexpr uint32_t kSolid = UINT32_MAX - 1;
  /// A cube's children: their mask, and the number of the first of their nodes. All children of a solid cube are solid.
  struct Family {
    bool is_solid;
    unsigned mask;
    uint32_t first_child;
  };
  /// A cube, and its neighbours of the same size: below and above along x, y and z.
  struct Cube {
    int level;
    uint32_t corner[3];
    uint32_t beside[6];
  };
  /// A cube with its own children and those of its neighbours.
  struct OpenCube {
    int level;
    uint32_t corner[3];
    Family self;
    Family beside[6];
  };
  /// The voxels of a word that are listed, and the ways from which they may be seen (BlockNode).
  struct Surface {
    uint64_t listed;
    unsigned facing;
  };
  /// The eight words of a cube of level 3, by octant.
  struct Words {
    bool is_known = false;
    uint64_t of[8] = {};
  };

  /// `level_begin`: the first node of every level.
  SurfaceFinder(const CompactTree& tree, const uint32_t* level_begin);

  Family family_of(uint32_t cube) const;
  uint32_t child_of(const Family& family, unsigned octant) const;
  uint64_t word_of(uint32_t cube) const;
  uint64_t word_from(unsigned mask, uint32_t first_child) const;
  void find_words(const Family& family, unsigned side, Words* words) const;
  Cube part_of(const OpenCube& cube, unsigned octant) const;
  OpenCube open(const Cube& cube, const Family& self) const;
  /// Finds the listed voxels of the cube's word in `octant`; `beside` holds the words of the neighbouring cubes, which
  /// are looked up when they are needed.
  Surface surface_of(const Words& words, unsigned octant, const OpenCube& cube, Words (&beside)[6]) const;
  /// The same for a world of one word, and for a solid word.
  Surface surface_of_word(uint64_t word, const Cube& cube) const;
  static Surface surface_between(uint64_t word, const uint64_t (&others)[6]);
  static bool is_enclosed(const Cube& cube);

  const CompactTree& tree_;
  uint32_t next_node_[kMaxLevel + 1];  ///< the next node of each level
  uint32_t voxels_ = 0;                ///< voxels in nodes of level 1 before this place
};

/// Walks the surface of a tree of level 2 or more that is not empty and was not coarsened, and whose masks add up level
/// by level. It trusts nothing else: the directory may be damaged.
template <class Sink>
class SurfaceWalk : SurfaceFinder {
 public:
  /// Each word is handed to `sink.add(const SurfaceWord&)`.
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

}  // namespace thimble::wide

#endif
