// The traversal: from each node to those of its children that the ray passes through, in the order in which
// it does. One loop for all trees and widths; the arithmetic is in crossings.h, the nodes behind the two
// small adaptors below.
#include "thimble/trace/trace.h"

#include "../base/bits.h"
#include "crossings.h"
#include "descent.h"
#include "path_cache.h"

namespace thimble {
namespace {

struct PoolNodes {
  const Octree& tree;

  int level() const { return tree.level(); }
  bool empty() const { return tree.empty(); }
  uint32_t root() const { return tree.root(); }
  bool load(uint32_t index, NodeRef* node) const {
    if (index == Octree::kNone) {
      return false;
    }
    const Octree::NodeView view = tree.node(index);
    node->mask = view.mask;
    node->link = view.first_child;
    return true;
  }
  void find_children(uint32_t, NodeRef*) const {}
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
  uint8_t voxel_material(uint32_t index, uint8_t mask, unsigned octant) const {
    const Octree::NodeView view = tree.node(index);
    if (!view.has_children) {
      return view.material;
    }
    return tree.node(child({view.first_child, mask}, octant)).material;
  }
};

// References are looked up child by child, so a node's link is its own one. Materials are not at the nodes:
// they are found from the voxel that was hit, once it is known.
struct SharedNodes {
  const SharedTree& tree;

  int level() const { return tree.level(); }
  bool empty() const { return tree.empty(); }
  uint32_t root() const { return tree.root(); }
  bool load(uint32_t index, NodeRef* node) const { return tree.load(index, &node->mask); }
  void find_children(uint32_t index, NodeRef* node) const { node->link = index; }
  uint32_t child(const NodeRef& node, unsigned octant) const {
    return tree.child(node.link, node.mask, octant);
  }
  bool merged(uint32_t index) const { return (index & SharedTree::kMergedBit) != 0; }
  uint8_t block_material(uint32_t) const { return tree.uniform_material(); }
  uint8_t voxel_material(uint32_t, uint8_t, unsigned) const { return tree.uniform_material(); }
};

struct Request {
  uint32_t max_visits;
  bool any;  // only the kind is wanted
};

// The children along the ray's path, in order, are the set bits of (mask & path) from the lowest up: in the
// mirrored numbering every crossing of a middle plane adds a bit to the octant. So the loop never steps
// through empty octants: it takes the next bit, or goes up to the next level that has one left.
template <class Nodes, class Int, class Unsigned>
Hit walk_octree(const Nodes& nodes, const MirroredRay& ray, const Request& request,
                DirectionPath<Unsigned>* cache) {
  Hit hit;
  const Crossings<Int> crossings(ray);
  Int num;
  Int den;
  if (nodes.empty() || !crossings.enter_box(&num, &den)) {
    return hit;
  }

  const int world_level = nodes.level();
  const int32_t side = int32_t{1} << world_level;
  using Path = NodePath<Unsigned>;
  const Path& path = cache->path(ray, world_level);
  Step<Path> stack[kMaxLevel + 1];
  uint32_t pending = 0;  // bit k: stack[k].rest is not 0
  typename Path::State state = path.start(ray, world_level);
  uint32_t index = nodes.root();
  int level = world_level;
  // While the node holds the ray's origin, only the octants ahead of it are on the ray.
  bool inside = ray.within(side);

  // Each turn arrives at the node `index` of `level`. The ray passes at most 3 * 2^k nodes of a level whose
  // nodes are 1/2^k of the world.
  for (uint32_t visits = 0;;) {
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
    uint32_t rest = path.octants(state) & node.mask;
    if (rest != 0) {
      rest = mirrored_octants(rest, ray.flip);
      if (inside) {
        rest &= octants_from(ray.origin_octant(level));
      }
    }
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
    } else {
      nodes.find_children(index, &node);
      stack[level].state = state;
      stack[level].node = node;
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
  }
}

// The dense grid has no empty space to skip: from voxel to voxel.
template <class Int>
Hit walk_grid(const DenseGrid& grid, const MirroredRay& ray, const Request& request) {
  Hit hit;
  const Crossings<Int> crossings(ray);
  Int num;
  Int den;
  if (grid.voxel_count() == 0 || !crossings.enter_box(&num, &den)) {
    return hit;
  }
  const int32_t side = int32_t{1} << grid.level();
  Vec3i corner = crossings.cell_at(num, den, grid.level());
  auto orders = crossings.orders({corner.x + 1, corner.y + 1, corner.z + 1});
  for (;;) {
    if (hit.visits == request.max_visits) {
      hit.kind = HitKind::kStepLimit;
      return hit;
    }
    ++hit.visits;
    const Vec3i voxel{(ray.flip & 1U) != 0 ? side - 1 - corner.x : corner.x,
                      (ray.flip & 2U) != 0 ? side - 1 - corner.y : corner.y,
                      (ray.flip & 4U) != 0 ? side - 1 - corner.z : corner.z};
    if (grid.solid_at(voxel)) {
      hit.kind = HitKind::kHit;
      if (!request.any) {
        report(ray, side, crossings, corner, 0, &hit);
      }
      return hit;
    }
    const unsigned crossed = crossings.leave(orders);
    corner = {corner.x + static_cast<int32_t>(crossed & 1U),
              corner.y + static_cast<int32_t>((crossed >> 1) & 1U),
              corner.z + static_cast<int32_t>((crossed >> 2) & 1U)};
    if (corner.x >= ray.box_max.x || corner.y >= ray.box_max.y || corner.z >= ray.box_max.z) {
      return hit;
    }
    crossings.advance(crossed, &orders);
  }
}

// Not inlined, so that a ray takes the stack of its own width only.
template <class Int, class Unsigned>
[[gnu::noinline]] Hit walk(const CompactTree& tree, const MirroredRay& ray, const Request& request,
                           DirectionPath<Unsigned>* cache) {
  return walk_octree<CompactNodes, Int, Unsigned>(CompactNodes{tree}, ray, request, cache);
}
template <class Int, class Unsigned>
[[gnu::noinline]] Hit walk(const Octree& tree, const MirroredRay& ray, const Request& request,
                           DirectionPath<Unsigned>* cache) {
  return walk_octree<PoolNodes, Int, Unsigned>(PoolNodes{tree}, ray, request, cache);
}
template <class Int, class Unsigned>
[[gnu::noinline]] Hit walk(const SharedTree& tree, const MirroredRay& ray, const Request& request,
                           DirectionPath<Unsigned>* cache) {
  Hit hit = walk_octree<SharedNodes, Int, Unsigned>(SharedNodes{tree}, ray, request, cache);
  if (hit.kind == HitKind::kHit && !request.any && tree.many_materials()) {
    hit.material = tree.material(hit.voxel);
  }
  return hit;
}
template <class Int, class Unsigned>
Hit walk(const DenseGrid& grid, const MirroredRay& ray, const Request& request, DirectionPath<Unsigned>*) {
  return walk_grid<Int>(grid, ray, request);
}

// Chips with 32-bit registers take the narrow path whenever they may.
constexpr bool kPrefer32 = sizeof(void*) <= 4;

template <class Target>
Status trace(const Target& target, const Ray& ray, const TraceOptions& options, bool any, Hit* hit,
             PathCache* cache) {
  const int level = target.level();
  const Status status = check_ray(ray, level);
  if (status != Status::kOk) {
    return status;
  }
  bool narrow = options.width == Width::k32;
  if (narrow || (kPrefer32 && options.width == Width::kAuto)) {
    const bool accepted = accepts_32(ray, level);
    if (narrow && !accepted) {
      return Status::kOutOfRange;
    }
    narrow = accepted;
  }
  // A grid too is reflected in the middle of the world that holds it, whose planes the bounds are made for.
  const MirroredRay mirrored(ray, int32_t{1} << level, target.bounds());
  const Request request{options.max_visits, any};
  *hit = narrow ? walk<int32_t, uint32_t>(target, mirrored, request, cache->of(uint32_t{0}))
                : walk<int64_t, uint64_t>(target, mirrored, request, cache->of(uint64_t{0}));
  return Status::kOk;
}

template <class Target>
Status trace_kind(const Target& target, const Ray& ray, const TraceOptions& options, HitKind* kind,
                  uint32_t* visits) {
  Hit hit;
  PathCache cache;
  const Status status = trace(target, ray, options, true, &hit, &cache);
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
  PathCache cache;
  return trace(tree, ray, options, false, hit, &cache);
}
Status closest_hit(const CompactTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache) {
  return trace(tree, ray, options, false, hit, cache);
}
Status closest_hit(const Octree& tree, const Ray& ray, Hit* hit, const TraceOptions& options) {
  PathCache cache;
  return trace(tree, ray, options, false, hit, &cache);
}
Status closest_hit(const Octree& tree, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache) {
  return trace(tree, ray, options, false, hit, cache);
}
Status closest_hit(const SharedTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options) {
  PathCache cache;
  return trace(tree, ray, options, false, hit, &cache);
}
Status closest_hit(const SharedTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache) {
  return trace(tree, ray, options, false, hit, cache);
}
Status closest_hit(const DenseGrid& grid, const Ray& ray, Hit* hit, const TraceOptions& options) {
  PathCache cache;
  return trace(grid, ray, options, false, hit, &cache);
}
Status closest_hit(const DenseGrid& grid, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache) {
  return trace(grid, ray, options, false, hit, cache);
}
Status closest_hit_32(const CompactTree& tree, const Ray& ray, Hit* hit, uint32_t max_visits,
                      DirectionPath<uint32_t>* cache) {
  const int level = tree.level();
  const Status status = check_ray(ray, level);
  if (status != Status::kOk) {
    return status;
  }
  if (!accepts_32(ray, level)) {
    return Status::kOutOfRange;
  }
  const MirroredRay mirrored(ray, int32_t{1} << level, tree.bounds());
  *hit = walk<int32_t, uint32_t>(tree, mirrored, {max_visits, false}, cache);
  return Status::kOk;
}
Status closest_hit_32(const CompactTree& tree, const Ray& ray, Hit* hit, uint32_t max_visits) {
  DirectionPath<uint32_t> cache;
  return closest_hit_32(tree, ray, hit, max_visits, &cache);
}
Status any_hit(const CompactTree& tree, const Ray& ray, HitKind* kind, uint32_t* visits,
               const TraceOptions& options) {
  return trace_kind(tree, ray, options, kind, visits);
}
Status any_hit(const Octree& tree, const Ray& ray, HitKind* kind, uint32_t* visits,
               const TraceOptions& options) {
  return trace_kind(tree, ray, options, kind, visits);
}
Status any_hit(const SharedTree& tree, const Ray& ray, HitKind* kind, uint32_t* visits,
               const TraceOptions& options) {
  return trace_kind(tree, ray, options, kind, visits);
}
Status any_hit(const DenseGrid& grid, const Ray& ray, HitKind* kind, uint32_t* visits,
               const TraceOptions& options) {
  return trace_kind(grid, ray, options, kind, visits);
}

}  // namespace thimble
