// On the way down an octree: a node, the stack of nodes behind a ray, and what is reported where it ends.
// Shared by the loops of trace.cpp and cutoff.cpp. Internal to src/; functions are static, so that each loop
// gets its own.
#ifndef THIMBLE_SRC_TRACE_DESCENT_H
#define THIMBLE_SRC_TRACE_DESCENT_H

#include <stdint.h>

#include "../base/bits.h"
#include "crossings.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble {

// A node as the loop needs it: which children there are, and where they are found.
struct NodeRef {
  uint32_t link;  // of the first child
  uint8_t mask;
};

struct CompactNodes {
  const CompactTree& tree;

  int level() const { return tree.level(); }
  bool empty() const { return tree.empty(); }
  uint32_t root() const { return 0; }
  // False for a node number outside the tree, which only a damaged tree leads to.
  bool load(uint32_t index, NodeRef* node) const {
    if (index >= tree.node_count()) {
      return false;
    }
    node->mask = tree.mask(index);
    return true;
  }
  // Where the children are is counted from bits, so only when one of them is wanted.
  void find_children(uint32_t index, NodeRef* node) const { node->link = tree.first_child(index); }
  uint32_t child(const NodeRef& node, unsigned octant) const {
    return node.link + bits::popcount8(node.mask & ((1U << octant) - 1));
  }
  bool merged(uint32_t index) const { return tree.is_merged(index); }
  uint8_t block_material(uint32_t index) const { return tree.block_material(index); }
  uint8_t voxel_material(uint32_t index, uint8_t mask, unsigned octant) const {
    if (!tree.many_materials()) {
      return tree.uniform_material();
    }
    return tree.voxel_material(child({tree.first_child(index), mask}, octant));
  }
};

// Fills in what was hit: the block of `level` at `corner` (mirrored) in a world of `side`.
template <class Int>
static void report(const MirroredRay& ray, int32_t side, const Crossings<Int>& crossings, const Vec3i& corner,
                   int level, Hit* hit) {
  const int axis = crossings.entered(corner);
  hit->axis = static_cast<int8_t>(axis);
  hit->block_level = static_cast<uint8_t>(level);
  for (int a = 0; a < 3; ++a) {
    const int32_t block = int32_t{1} << level;
    hit->voxel[a] = ((ray.flip >> a) & 1U) != 0 ? side - block - corner[a] : corner[a];
  }
  if (axis >= 0) {
    hit->t_numerator = ray.distance(axis, corner[axis]);
    hit->t_denominator = ray.direction[axis] * Q8::kOne;
  }
}

// A node on the way down. Octants are mirrored ones.
template <class Path>
struct Step {
  typename Path::State state;
  NodeRef node;
  uint8_t octant;  // the child that the loop is in
  uint8_t rest;    // children still to visit, as bits
};

// The lowest corner of the node of `level` on the way down from `world_level`.
template <class Step>
static Vec3i corner_of(const Step (&stack)[kMaxLevel + 1], int level, int world_level) {
  Vec3i corner;
  for (int above = world_level; above > level; --above) {
    const unsigned octant = stack[above].octant;
    corner.x |= static_cast<int32_t>((octant & 1U) << (above - 1));
    corner.y |= static_cast<int32_t>(((octant >> 1) & 1U) << (above - 1));
    corner.z |= static_cast<int32_t>(((octant >> 2) & 1U) << (above - 1));
  }
  return corner;
}

// Goes down from a node of `level` that is solid through to the voxel that the ray enters it by. `inside`:
// the ray starts in the node.
template <class Path>
static void descend_to_voxel(const Path& path, const MirroredRay& ray, typename Path::State state, int level,
                             bool inside, Step<Path> (&stack)[kMaxLevel + 1]) {
  for (; level > 0; --level) {
    uint32_t octants = mirrored_octants(path.octants(state), ray.flip);
    const unsigned origin = ray.origin_octant(level);
    if (inside) {
      octants &= octants_from(origin);
    }
    const unsigned octant = bits::lowest_bit(octants);
    inside = inside && octant == origin;
    stack[level].octant = static_cast<uint8_t>(octant);
    state = path.child(state, octant);
  }
}

}  // namespace thimble

#endif
