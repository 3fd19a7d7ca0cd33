// Traces a ray through each of the structures. The loop for all trees is in descent.h, the arithmetic in
// crossings.h; what differs between the trees is behind the small adaptors below.
#include "thimble/trace/ray.h"

#include "../base/bits.h"
#include "crossings.h"
#include "descent.h"
#include "path_cache.h"
#include "width.h"

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

// The dense grid has no empty space to skip: from voxel to voxel.
template <class Int>
Hit walk_grid(const DenseGrid& grid, const MirroredRay& ray, const Request& request) {
  Hit hit;
  const Crossings<Int> crossings(ray);
  int32_t num;
  int32_t den;
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
  GoesThrough stop;
  return walk_octree<Int>(CompactNodes{tree}, ray, request, stop, cache);
}
template <class Int, class Unsigned>
[[gnu::noinline]] Hit walk(const Octree& tree, const MirroredRay& ray, const Request& request,
                           DirectionPath<Unsigned>* cache) {
  GoesThrough stop;
  return walk_octree<Int>(PoolNodes{tree}, ray, request, stop, cache);
}
template <class Int, class Unsigned>
[[gnu::noinline]] Hit walk(const SharedTree& tree, const MirroredRay& ray, const Request& request,
                           DirectionPath<Unsigned>* cache) {
  GoesThrough stop;
  Hit hit = walk_octree<Int>(SharedNodes{tree}, ray, request, stop, cache);
  if (hit.kind == HitKind::kHit && !request.any && tree.many_materials()) {
    hit.material = tree.material(hit.voxel);
  }
  return hit;
}
template <class Int, class Unsigned>
Hit walk(const DenseGrid& grid, const MirroredRay& ray, const Request& request, DirectionPath<Unsigned>*) {
  return walk_grid<Int>(grid, ray, request);
}

template <class Target>
Status trace(const Target& target, const Ray& ray, const TraceOptions& options, bool any, Hit* hit,
             PathCache* cache) {
  const int level = target.level();
  const Status status = check_ray(ray, level);
  if (status != Status::kOk) {
    return status;
  }
  bool narrow = false;
  if (!choose_width(options.width, &narrow, [&] { return accepts_32(ray, level); })) {
    return Status::kOutOfRange;
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

template <class Structure>
Status closest_hit(const Structure& structure, const Ray& ray, Hit* hit, const TraceOptions& options,
                   PathCache* cache) {
  return trace(structure, ray, options, false, hit, cache);
}
template Status closest_hit(const CompactTree&, const Ray&, Hit*, const TraceOptions&, PathCache*);
template Status closest_hit(const Octree&, const Ray&, Hit*, const TraceOptions&, PathCache*);
template Status closest_hit(const SharedTree&, const Ray&, Hit*, const TraceOptions&, PathCache*);
template Status closest_hit(const DenseGrid&, const Ray&, Hit*, const TraceOptions&, PathCache*);

Status closest_hit(const CompactTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options) {
  PathCache cache;
  return trace(tree, ray, options, false, hit, &cache);
}
Status closest_hit(const Octree& tree, const Ray& ray, Hit* hit, const TraceOptions& options) {
  PathCache cache;
  return trace(tree, ray, options, false, hit, &cache);
}
Status closest_hit(const SharedTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options) {
  PathCache cache;
  return trace(tree, ray, options, false, hit, &cache);
}
Status closest_hit(const DenseGrid& grid, const Ray& ray, Hit* hit, const TraceOptions& options) {
  PathCache cache;
  return trace(grid, ray, options, false, hit, &cache);
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
