// The traversal: down the octree to the child the ray is in, across to the next, up when it leaves the node.
// One loop for all trees and widths; the arithmetic is in crossings.h, the nodes behind the two small
// adaptors below.
#include "thimble/trace.h"

#include "bits.h"
#include "crossings.h"

namespace thimble {
namespace {

// A node as the loop needs it: which children there are, and where they are found.
struct NodeRef {
  uint32_t link = 0;  // compact: number of the first child; pool: index of the first child. At level 1 the
                      // node's own index
  uint8_t mask = 0;
};

struct CompactNodes {
  const CompactTree& tree;

  int level() const { return tree.level(); }
  bool empty() const { return tree.empty(); }
  uint32_t root() const { return 0; }
  // False for a node number outside the tree, which only a damaged tree leads to.
  bool load(uint32_t index, int level, NodeRef* node) const {
    if (index >= tree.node_count()) {
      return false;
    }
    node->mask = tree.mask(index);
    // Counting bits is left out where nobody follows the link.
    node->link = level > 1 && node->mask != 0 ? tree.first_child(index) : index;
    return true;
  }
  uint32_t child(const NodeRef& node, unsigned octant) const {
    return node.link + bits::popcount8(node.mask & ((1U << octant) - 1));
  }
  bool merged(uint32_t index) const { return tree.is_merged(index); }
  uint8_t block_material(uint32_t index) const { return tree.block_material(index); }
  uint8_t voxel_material(const NodeRef& node, unsigned octant) const {
    if (!tree.many_materials()) {
      return tree.uniform_material();
    }
    return tree.voxel_material(tree.first_child(node.link) +
                               bits::popcount8(node.mask & ((1U << octant) - 1)));
  }
};

struct PoolNodes {
  const Octree& tree;

  int level() const { return tree.level(); }
  bool empty() const { return tree.empty(); }
  uint32_t root() const { return tree.root(); }
  bool load(uint32_t index, int level, NodeRef* node) const {
    if (index == Octree::kNone) {
      return false;
    }
    const Octree::NodeView view = tree.node(index);
    node->mask = view.mask;
    node->link = level > 1 ? view.first_child : index;
    return true;
  }
  // Children are a chain in the order of their octants.
  uint32_t child(const NodeRef& node, unsigned octant) const {
    uint32_t index = node.link;
    for (unsigned left = bits::popcount8(node.mask & ((1U << octant) - 1));
         left > 0 && index != Octree::kNone; --left) {
      index = tree.node(index).next;
    }
    return index;
  }
  bool merged(uint32_t index) const { return tree.node(index).merged; }
  uint8_t block_material(uint32_t index) const { return tree.node(index).material; }
  uint8_t voxel_material(const NodeRef& node, unsigned octant) const {
    const Octree::NodeView view = tree.node(node.link);
    if (!view.has_children) {
      return view.material;
    }
    return tree.node(child({view.first_child, node.mask}, octant)).material;
  }
};

struct Request {
  uint32_t max_visits;
  bool any;  // only the kind is wanted
};

// Fills in what was hit: the block of `level` at `corner` (mirrored), entered at the present crossing.
template <class Crossings>
void report(const MirroredRay& ray, const Vec3i& extent, const Crossings& crossings, const Vec3i& corner,
            int level, Hit* hit) {
  int axis = crossings.entered(corner);
  // A damaged tree can begin the ray within a block, so that no face of it was entered: `t` keeps its range.
  if (axis >= 0 && (ray.direction[axis] == 0 || corner[axis] * Q8::kOne < ray.origin_q8[axis])) {
    axis = -1;
  }
  hit->axis = static_cast<int8_t>(axis);
  hit->block_level = static_cast<uint8_t>(level);
  for (int a = 0; a < 3; ++a) {
    const int32_t side = int32_t{1} << level;
    hit->voxel[a] = ((ray.flip >> a) & 1U) != 0 ? extent[a] - side - corner[a] : corner[a];
  }
  if (axis >= 0) {
    hit->t_numerator = corner[axis] * Q8::kOne - ray.origin_q8[axis];
    hit->t_denominator = ray.direction[axis] * Q8::kOne;
  } else {
    hit->t_numerator = 0;
    hit->t_denominator = 1;
  }
}

Vec3i child_corner(const Vec3i& corner, unsigned octant, int child_level) {
  return {corner.x | static_cast<int32_t>((octant & 1U) << child_level),
          corner.y | static_cast<int32_t>(((octant >> 1) & 1U) << child_level),
          corner.z | static_cast<int32_t>(((octant >> 2) & 1U) << child_level)};
}

template <class Nodes, class Crossings>
Hit walk_octree(const Nodes& nodes, const MirroredRay& ray, const Request& request) {
  Hit hit;
  Crossings crossings(ray);
  if (nodes.empty() || !crossings.begin()) {
    return hit;
  }

  const int world_level = nodes.level();
  const int32_t side = int32_t{1} << world_level;
  const Vec3i extent{side, side, side};
  NodeRef stack[kMaxLevel + 1];
  NodeRef node;
  uint32_t index = nodes.root();
  int level = world_level;
  Vec3i corner;
  crossings.enter(corner, level);

  // Each turn arrives at the node `index` of `level` at `corner`. The ray only moves forward, so there are at
  // most 3 * 2^world_level crossings and world_level arrivals between two of them.
  for (;;) {
    if (hit.visits == request.max_visits) {
      hit.kind = HitKind::kStepLimit;
      return hit;
    }
    ++hit.visits;
    if (!nodes.load(index, level, &node)) {
      return hit;
    }
    if (node.mask == 0) {  // a solid block
      hit.kind = HitKind::kHit;
      if (request.any) {
        return hit;
      }
      hit.material = nodes.block_material(index);
      const bool merged = nodes.merged(index);
      // A truly full block: the voxel entered is found by going down as if it had children.
      while (!merged && level > 0) {
        const unsigned octant = crossings.octant(corner, level);
        --level;
        corner = child_corner(corner, octant, level);
        crossings.descend(octant, corner, level);
      }
      report(ray, extent, crossings, corner, level, &hit);
      return hit;
    }

    unsigned octant = crossings.octant(corner, level);
    while (((node.mask >> (octant ^ ray.flip)) & 1U) == 0) {
      const unsigned crossed = crossings.leave(octant, corner, level);
      if (crossed == 0) {
        return hit;
      }
      if ((crossed & octant) == 0) {
        octant |= crossed;  // a sibling
        continue;
      }
      // Out of the node: up to the one that holds both the place left and the place entered.
      const Vec3i from = child_corner(corner, octant, level - 1);
      const int32_t step = int32_t{1} << (level - 1);
      const Vec3i to{from.x + ((crossed & 1U) != 0 ? step : 0), from.y + ((crossed & 2U) != 0 ? step : 0),
                     from.z + ((crossed & 4U) != 0 ? step : 0)};
      level =
          bits::highest_bit(static_cast<uint32_t>((from.x ^ to.x) | (from.y ^ to.y) | (from.z ^ to.z))) + 1;
      if (level > world_level) {
        return hit;
      }
      node = stack[level];
      octant = (static_cast<uint32_t>(to.x) >> (level - 1) & 1U) |
               (static_cast<uint32_t>(to.y) >> (level - 1) & 1U) << 1 |
               (static_cast<uint32_t>(to.z) >> (level - 1) & 1U) << 2;
      const int32_t keep = ~((int32_t{1} << level) - 1);
      corner = {to.x & keep, to.y & keep, to.z & keep};
      crossings.enter(corner, level);
    }

    if (level == 1) {  // a voxel
      hit.kind = HitKind::kHit;
      if (request.any) {
        return hit;
      }
      hit.material = nodes.voxel_material(node, octant ^ ray.flip);
      report(ray, extent, crossings, child_corner(corner, octant, 0), 0, &hit);
      return hit;
    }
    stack[level] = node;
    index = nodes.child(node, octant ^ ray.flip);
    --level;
    corner = child_corner(corner, octant, level);
    crossings.descend(octant, corner, level);
  }
}

// The dense grid has no empty space to skip: from voxel to voxel.
template <class Crossings>
Hit walk_grid(const DenseGrid& grid, const MirroredRay& ray, const Request& request) {
  Hit hit;
  Crossings crossings(ray);
  if (grid.voxel_count() == 0 || !crossings.begin()) {
    return hit;
  }
  Vec3i corner;
  int level = grid.level();
  crossings.enter(corner, level);
  while (level > 0) {
    const unsigned octant = crossings.octant(corner, level);
    --level;
    corner = child_corner(corner, octant, level);
    crossings.descend(octant, corner, level);
  }
  const int32_t side = int32_t{1} << grid.level();
  const Vec3i extent{side, side, side};
  for (;;) {
    if (hit.visits == request.max_visits) {
      hit.kind = HitKind::kStepLimit;
      return hit;
    }
    ++hit.visits;
    const Vec3i voxel{(ray.flip & 1U) != 0 ? extent.x - 1 - corner.x : corner.x,
                      (ray.flip & 2U) != 0 ? extent.y - 1 - corner.y : corner.y,
                      (ray.flip & 4U) != 0 ? extent.z - 1 - corner.z : corner.z};
    if (grid.bit(voxel)) {
      hit.kind = HitKind::kHit;
      if (!request.any) {
        report(ray, extent, crossings, corner, 0, &hit);
      }
      return hit;
    }
    const unsigned crossed = crossings.leave(0, corner, 0);
    if (crossed == 0) {
      return hit;
    }
    corner = {corner.x + static_cast<int32_t>(crossed & 1U),
              corner.y + static_cast<int32_t>((crossed >> 1) & 1U),
              corner.z + static_cast<int32_t>((crossed >> 2) & 1U)};
    crossings.enter(corner, 0);
  }
}

struct Structure {
  int level;
  Vec3i extent;
  VoxelBox bounds;
};
Structure describe(const CompactTree& tree) {
  const int32_t side = int32_t{1} << tree.level();
  return {tree.level(), {side, side, side}, tree.bounds()};
}
Structure describe(const Octree& tree) {
  const int32_t side = int32_t{1} << tree.level();
  return {tree.level(), {side, side, side}, tree.bounds()};
}
// Reflected in the middle of the world, as the trees are, and not of the grid: its planes, those beyond the
// grid too, are then the world's, which the ranges of both widths are made for.
Structure describe(const DenseGrid& grid) {
  const int32_t side = int32_t{1} << grid.level();
  return {grid.level(), {side, side, side}, grid.bounds()};
}

template <class Crossings>
Hit walk(const CompactTree& tree, const MirroredRay& ray, const Request& request) {
  return walk_octree<CompactNodes, Crossings>(CompactNodes{tree}, ray, request);
}
template <class Crossings>
Hit walk(const Octree& tree, const MirroredRay& ray, const Request& request) {
  return walk_octree<PoolNodes, Crossings>(PoolNodes{tree}, ray, request);
}
template <class Crossings>
Hit walk(const DenseGrid& grid, const MirroredRay& ray, const Request& request) {
  return walk_grid<Crossings>(grid, ray, request);
}

// Chips with 32-bit registers take the narrow path whenever they may.
constexpr bool kPrefer32 = sizeof(void*) <= 4;

template <class Target>
Status trace(const Target& target, const Ray& ray, const TraceOptions& options, bool any, Hit* hit) {
  const Structure structure = describe(target);
  const Status status = check_ray(ray, structure.level);
  if (status != Status::kOk) {
    return status;
  }
  bool narrow = options.width == Width::k32;
  if (narrow || (kPrefer32 && options.width == Width::kAuto)) {
    const bool accepted = accepts_32(ray, structure.level);
    if (narrow && !accepted) {
      return Status::kOutOfRange;
    }
    narrow = accepted;
  }
  const MirroredRay mirrored(ray, structure.extent, structure.bounds);
  const Request request{options.max_visits, any};
  *hit = narrow ? walk<Crossings32>(target, mirrored, request) : walk<Crossings64>(target, mirrored, request);
  return Status::kOk;
}

template <class Target>
Status trace_kind(const Target& target, const Ray& ray, const TraceOptions& options, HitKind* kind,
                  uint32_t* visits) {
  Hit hit;
  const Status status = trace(target, ray, options, true, &hit);
  if (status != Status::kOk) {
    return status;
  }
  *kind = hit.kind;
  if (visits != nullptr) {
    *visits = hit.visits;
  }
  return Status::kOk;
}

}  // namespace

bool accepts_32(const Ray& ray, int level) {
  const int32_t side_q8 = Q8::kOne << level;
  uint32_t distances = 0;
  uint32_t directions = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t origin = ray.origin[axis].raw;
    const int32_t beyond = side_q8 - origin;
    distances |= static_cast<uint32_t>(origin < 0 ? -origin : origin);
    distances |= static_cast<uint32_t>(beyond < 0 ? -beyond : beyond);
    const int32_t direction = ray.direction[axis];
    directions |= static_cast<uint32_t>(direction < 0 ? -direction : direction);
  }
  return bits::bit_length(distances) + bits::bit_length(directions) <= 31;
}

Status closest_hit(const CompactTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options) {
  return trace(tree, ray, options, false, hit);
}
Status closest_hit(const Octree& tree, const Ray& ray, Hit* hit, const TraceOptions& options) {
  return trace(tree, ray, options, false, hit);
}
Status closest_hit(const DenseGrid& grid, const Ray& ray, Hit* hit, const TraceOptions& options) {
  return trace(grid, ray, options, false, hit);
}
Status any_hit(const CompactTree& tree, const Ray& ray, HitKind* kind, uint32_t* visits,
               const TraceOptions& options) {
  return trace_kind(tree, ray, options, kind, visits);
}
Status any_hit(const Octree& tree, const Ray& ray, HitKind* kind, uint32_t* visits,
               const TraceOptions& options) {
  return trace_kind(tree, ray, options, kind, visits);
}
Status any_hit(const DenseGrid& grid, const Ray& ray, HitKind* kind, uint32_t* visits,
               const TraceOptions& options) {
  return trace_kind(grid, ray, options, kind, visits);
}

}  // namespace thimble
