// The traversal: from each node to those of its children that the ray passes through, in the order in which
// it does. One loop for all trees, widths and rules of where to stop. Internal to src/; functions are static,
// so that each file that traces gets its own.
#pragma once

#include <stdint.h>

#include "../base/bits.h"
#include "crossings.h"
#include "path_cache.h"
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
    THIMBLE_NOTE(Range::kNumerator, Exact(hit->t_numerator));
    THIMBLE_NOTE(Range::kDenominator, Exact(ray.direction[axis]) * Exact(Q8::kOne));
  }
}

// A node on the way down. Octants are mirrored ones.
template <class Path>
struct NodeStep {
  typename Path::State state;
  NodeRef node;
  uint8_t octant;  // the child that the loop is in
  uint8_t rest;    // children still to visit, as bits
};

// The lowest corner of the node of `level` on the way down from `world_level`.
template <class Step>
static Vec3i corner_of(const Step (&stack)[kMaxLevel + 1], int level, int world_level) {
  uint32_t x = 0;
  uint32_t y = 0;
  uint32_t z = 0;
  for (int above = world_level; above > level; --above) {
    const uint32_t octant = stack[above].octant;
    x = x << 1 | (octant & 1U);
    y = y << 1 | (octant >> 1 & 1U);
    z = z << 1 | octant >> 2;
  }
  return {static_cast<int32_t>(x << level), static_cast<int32_t>(y << level),
          static_cast<int32_t>(z << level)};
}

// Goes down from a node of `level` that is solid through to the voxel that the ray enters it by. `inside`:
// the ray starts in the node.
template <class Path>
static void descend_to_voxel(const Path& path, const MirroredRay& ray, typename Path::State state, int level,
                             bool inside, NodeStep<Path> (&stack)[kMaxLevel + 1]) {
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

// Those of a node's children that are still ahead of the ray, mirrored. `inside`: the ray starts in the node.
static inline uint32_t children_ahead(const MirroredRay& ray, uint32_t octants, int level, bool inside) {
  if (octants != 0) {
    octants = mirrored_octants(octants, ray.flip);
    if (inside) {
      octants &= octants_from(ray.origin_octant(level));
    }
  }
  return octants;
}

struct Request {
  uint32_t max_visits;
  bool any;  // only the kind is wanted
};

// The rule of where a walk stops above the voxels: nowhere. A rule hears which child the walk enters, when it
// keeps a node to come back to, and when it is back.
struct GoesThrough {
  bool stops_at(const MirroredRay&, uint32_t, int) { return false; }
  void keep(int) {}
  void go_back(int) {}
  void enter(unsigned, int) {}
};

// The children along the ray's path, in order, are the set bits of (mask & path) from the lowest up: in the
// mirrored numbering every crossing of a middle plane adds a bit to the octant. So the loop never steps
// through empty octants: it takes the next bit, or goes up to the next level that has one left.
template <class Int, class Unsigned, class Nodes, class Stop>
static Hit walk_octree(const Nodes& nodes, const MirroredRay& ray, const Request& request, Stop& stop,
                       DirectionPath<Unsigned>* cache) {
  Hit hit;
  const Crossings<Int> crossings(ray);
  int32_t num;
  int32_t den;
  if (nodes.empty() || !crossings.enter_box(&num, &den)) {
    return hit;
  }

  const int world_level = nodes.level();
  const int32_t side = int32_t{1} << world_level;
  using Path = NodePath<Unsigned>;
  const Path& path = cache->path(ray, world_level);
  NodeStep<Path> stack[kMaxLevel + 1];
  uint32_t pending = 0;  // bit k: stack[k].rest is not 0
  typename Path::State state = path.start(ray, world_level);
  uint32_t index = nodes.root();
  int level = world_level;
  // While the node holds the ray's origin, only the octants ahead of it are on the ray.
  bool inside = ray.within(side);

  // Each turn arrives at the node `index` of `level`. The ray passes at most 3 * 2^k nodes of a level whose
  // nodes are 1/2^k of the world.
  for (uint32_t visits = 0;;) {
    if (stop.stops_at(ray, index, level)) {
      hit.kind = HitKind::kHit;
      hit.visits = visits;
      report(ray, side, crossings, corner_of(stack, level, world_level), level, &hit);
      return hit;
    }
    if (visits == request.max_visits) {
      hit.kind = HitKind::kStepLimit;
      hit.visits = visits;
      return hit;
    }
    ++visits;
    NodeRef node;
    if (!nodes.load(index, &node)) {
      hit.visits = visits;
      return hit;
    }
    const bool solid = node.mask == 0;
    uint32_t rest = children_ahead(ray, path.octants(state) & node.mask, level, inside);
    if (solid || (level == 1 && rest != 0)) {
      hit.kind = HitKind::kHit;
      hit.visits = visits;
      if (request.any) {
        return hit;
      }
      if (!solid) {  // a voxel
        const unsigned octant = bits::lowest_bit(rest);
        hit.material = nodes.voxel_material(index, node.mask, octant ^ ray.flip);
        stack[level].octant = static_cast<uint8_t>(octant);
        level = 0;
      } else {
        hit.material = nodes.block_material(index);
        if (!nodes.merged(index)) {
          descend_to_voxel(path, ray, state, level, inside, stack);
          level = 0;
        }
      }
      report(ray, side, crossings, corner_of(stack, level, world_level), level, &hit);
      return hit;
    }

    if (rest == 0) {  // up to the next level that has a child left
      if (pending == 0) {
        hit.visits = visits;
        return hit;
      }
      level = static_cast<int>(bits::lowest_bit(pending));
      inside = false;  // what holds the origin comes first
      state = stack[level].state;
      node = stack[level].node;
      rest = stack[level].rest;
      stop.go_back(level);
    } else {
      nodes.find_children(index, &node);
      stack[level].state = state;
      stack[level].node = node;
      stop.keep(level);
    }
    const unsigned octant = bits::lowest_bit(rest);
    rest &= rest - 1;
    stack[level].octant = static_cast<uint8_t>(octant);
    stack[level].rest = static_cast<uint8_t>(rest);
    pending = (pending & ~(uint32_t{1} << level)) | static_cast<uint32_t>(rest != 0) << level;
    inside = inside && octant == ray.origin_octant(level);
    index = nodes.child(node, octant ^ ray.flip);
    state = path.child(state, octant);
    --level;
    stop.enter(octant, level);
  }
}

}  // namespace thimble
