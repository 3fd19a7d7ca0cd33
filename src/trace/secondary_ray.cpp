// Secondary rays, which start at a hit. The walk through a medium is that of trace.cpp by another rule: there the octants
// that hold something are visited, here all of them, and what ends the walk is the first cell that is not of the medium.
#include "thimble/trace/secondary_ray.h"

#include "../base/bits.h"
#include "../base/wide_arithmetic.h"
#include "../tree/compact_header.h"
#include "crossings.h"
#include "descent.h"
#include "width.h"

namespace thimble {
namespace {

// Whether the mirrored ray is in the world right after t = num / den.
template <class Int>
bool in_world(const MirroredRay& ray, int32_t side, int32_t num, int32_t den) {
  for (int axis = 0; axis < 3; ++axis) {
    const Int way = product<Int>(num, ray.direction[axis]);
    if (product<Int>(ray.distance(axis, 0), den) > way ||
        product<Int>(ray.distance(axis, side), den) <= way) {
      return false;
    }
  }
  return true;
}

// The rule of a walk that begins at a point of the ray: to the first solid voxel, or through a medium.
struct Search : FirstSolid {
  static constexpr bool kPasses = true;

  bool medium;       // to the first cell that is not of `material`; otherwise the first solid one
  uint8_t material;  // of the medium; afterwards of what the walk ends in
  bool into_solid = false;
  bool is_in_world = true;  // the ray is where the search begins
  int32_t numerator = 0;    // of t, times 256
  int32_t denominator = 1;
  Vec3i start;  // the cell in which the search begins; mirrored

  Search(bool through, uint8_t of) : medium(through), material(of) {}

  template <class Int, class Nodes>
  bool begins(const Nodes& nodes, const MirroredRay& ray, const Crossings<Int>& crossings, int32_t* num,
              int32_t* den) {
    *num = numerator;
    *den = denominator;
    is_in_world = in_world<Int>(ray, int32_t{1} << nodes.level(), *num, *den);
    if (is_in_world) {
      start = crossings.cell_at(*num, *den, nodes.level());
    }
    return is_in_world;
  }
  bool begins_inside(const MirroredRay&, int32_t) const { return true; }
  unsigned first_octant(const MirroredRay&, int level) const { return octant_of(start, level); }
  uint32_t wanted(uint32_t mask) const { return medium && mask != 0 ? 0xFFU : mask; }
  bool ends_in_empty() const { return medium; }

  // Whether the walk ends in the node; takes those of its voxels off `rest` that the ray goes through before.
  template <class Nodes>
  bool ends(const Nodes& nodes, uint32_t index, NodeRef node, int level, unsigned flip, uint32_t* rest) {
    if (node.mask == 0) {
      return stops_in(nodes.block_material(index));
    }
    if (level != 1 || *rest == 0) {
      return false;
    }
    nodes.find_children(index, &node);
    for (; *rest != 0; *rest &= *rest - 1) {
      const unsigned octant = bits::lowest_bit(*rest) ^ flip;
      if ((node.mask >> octant & 1U) == 0) {
        material = 0;
        return true;
      }
      if (stops_in(nodes.tree.voxel_material(nodes.child(node, octant)))) {
        return true;
      }
    }
    return false;
  }

 private:
  bool stops_in(uint8_t solid) {
    into_solid = !medium || solid != material;
    material = solid;
    return into_solid;
  }
};

// The cell outside the world that the ray comes to first.
template <class Int>
void leave_world(const MirroredRay& ray, int level, Hit* hit) {
  const int32_t side = int32_t{1} << level;
  const Crossings<Int> crossings(ray);
  int32_t num = 0;
  int32_t den = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t distance = ray.distance(axis, side);
    const int32_t direction = ray.direction[axis];
    if (direction != 0 && (den == 0 || product<Int>(distance, den) < product<Int>(num, direction))) {
      num = distance;
      den = direction;
    }
  }
  Vec3i cell = crossings.cell_at(num, den, level);
  for (int axis = 0; axis < 3; ++axis) {
    if (product<Int>(ray.distance(axis, side), den) <= product<Int>(num, ray.direction[axis])) {
      cell[axis] = side;
    }
  }
  hit->kind = HitKind::kHit;
  report(ray, side, crossings, cell, 0, hit);
}

// Not inlined, so that a ray takes the stack of its own width only.
template <class Int, class Unsigned>
[[gnu::noinline]] void walk_search(const CompactTree& tree, const MirroredRay& ray, uint32_t max_visits,
                                   Search* search, MediumExit* exit) {
  DirectionPath<Unsigned> path;
  exit->hit = walk_octree<Int>(CompactNodes{tree}, ray, {max_visits, false}, *search, &path);
  exit->into_solid = search->into_solid;
  if (search->medium && search->is_in_world && exit->hit.kind == HitKind::kMiss) {
    exit->left_world = true;
    leave_world<Int>(ray, tree.level(), &exit->hit);
  }
}

// A ray as the walk takes it, or what is wrong with it.
Status begin_at(const Ray& ray, int level, const RayPoint& from, Search* search) {
  search->numerator = from.t_numerator;
  search->denominator = from.t_denominator >> Q8::kBits;
  if (from.t_numerator <= 0 || search->denominator <= 0) {
    search->numerator = 0;
    search->denominator = 1;
  }
  return check_ray(ray, level);
}

// The point is a plane's, so its terms are a distance and a component like those of the ray; they are judged
// as such.
bool accepts_32_from(const Ray& ray, int level, const Search& search) {
  uint32_t directions = static_cast<uint32_t>(search.denominator);
  for (int axis = 0; axis < 3; ++axis) {
    directions |= static_cast<uint32_t>(magnitude(ray.direction[axis]));
  }
  return accepts_32(ray, level) &&
         bits::bit_length(static_cast<uint32_t>(search.numerator)) + bits::bit_length(directions) <= 31;
}

// Inlined, so that its callers have no frame of their own below them on a small stack.
[[gnu::always_inline]] inline Status search_from(const CompactTree& tree, const Ray& ray,
                                                 const RayPoint& from, const TraceOptions& options,
                                                 Search* search, MediumExit* exit) {
  const int level = tree.level();
  const Status status = begin_at(ray, level, from, search);
  if (status != Status::kOk) {
    return status;
  }
  bool narrow = false;
  if (!choose_width(options.width, &narrow, [&] { return accepts_32_from(ray, level, *search); })) {
    return Status::kOutOfRange;
  }
  const int32_t side = int32_t{1} << level;
  const MirroredRay mirrored(ray, side, {{0, 0, 0}, {side, side, side}});
  if (narrow) {
    walk_search<int32_t, uint32_t>(tree, mirrored, options.max_visits, search, exit);
  } else {
    walk_search<int64_t, uint64_t>(tree, mirrored, options.max_visits, search, exit);
  }
  return Status::kOk;
}

// Whether the hit's t is below that of the point: 31 bits times 28 and 23 times 31.
bool earlier(const Hit& hit, const RayPoint& point) {
  THIMBLE_NOTE(Range::kPlaces, Exact(hit.t_numerator) * Exact(point.t_denominator));
  THIMBLE_NOTE(Range::kPlaces, Exact(point.t_numerator) * Exact(hit.t_denominator));
  return is_product_less(hit.t_numerator, point.t_denominator, point.t_numerator, hit.t_denominator);
}

// For a ray that is not in the world at `from`: it comes to it after that, or has left it.
void only_from(const RayPoint& from, Hit* hit) {
  if (hit->kind == HitKind::kHit && earlier(*hit, from)) {
    const uint32_t visits = hit->visits;
    *hit = Hit{};
    hit->visits = visits;
  }
}

}  // namespace

Vec3Q8 start_on_plane(const Ray& ray, int axis, int32_t plane_q8, const Vec3i& low_q8, const Vec3i& high_q8) {
  const int32_t speed = ray.direction[axis];
  const uint32_t divisor = static_cast<uint32_t>(magnitude(speed));
  const int32_t way = speed < 0 ? ray.origin[axis].raw - plane_q8 : plane_q8 - ray.origin[axis].raw;
  Vec3Q8 start;
  start[axis] = Q8::from_raw(plane_q8);
  for (int other = 0; other < 3; ++other) {
    if (other == axis) {
      continue;
    }
    // From the lower bound to the exact point, times the divisor: two products of 24 and 20 bits.
    const int32_t low = low_q8[other];
    const int64_t offset = wide_product(ray.origin[other].raw - low, static_cast<int32_t>(divisor)) +
                           wide_product(way, ray.direction[other]);
    THIMBLE_NOTE(Range::kStart, Exact(ray.origin[other].raw - low) * Exact(divisor));
    THIMBLE_NOTE(Range::kStart, Exact(way) * Exact(ray.direction[other]));
    THIMBLE_NOTE(Range::kStart, Exact(offset));
    const uint32_t range = static_cast<uint32_t>(high_q8[other] - low);
    uint32_t steps = 0;
    if (offset >= static_cast<int64_t>(wide_product_u(range, divisor))) {
      steps = range - 1;
    } else if (offset > UINT32_MAX) {
      steps = static_cast<uint32_t>(divide(static_cast<uint64_t>(offset), divisor));
    } else if (offset > 0) {
      THIMBLE_NOTE(range > 8 * Q8::kOne ? Range::kStart : Range::kStartInside, Exact(offset));
      steps = static_cast<uint32_t>(offset) / divisor;  // always for up to 8 voxels: 11 bits and 20
    }
    start[other] = Q8::from_raw(low + static_cast<int32_t>(steps));
  }
  return start;
}

Vec3Q8 start_on_face(const Ray& ray, const Hit& hit) {
  if (hit.axis < 0) {
    return ray.origin;
  }
  const int32_t side = Q8::kOne << hit.block_level;
  const Vec3i low{hit.voxel.x * Q8::kOne, hit.voxel.y * Q8::kOne, hit.voxel.z * Q8::kOne};
  const Vec3i high{low.x + side, low.y + side, low.z + side};
  const int32_t plane = looks_to_smaller(ray, hit) ? low[hit.axis] : high[hit.axis];
  return start_on_plane(ray, hit.axis, plane, low, high);
}

bool material_at(const CompactTree& tree, const Vec3i& voxel, uint8_t* material) {
  const int32_t side = int32_t{1} << tree.level();
  for (int axis = 0; axis < 3; ++axis) {
    if (voxel[axis] < 0 || voxel[axis] >= side) {
      return false;
    }
  }
  uint32_t index = 0;
  for (int level = tree.level(); level >= 1; --level) {
    if (index >= tree.node_count()) {
      return false;
    }
    const uint8_t mask = tree.mask(index);
    if (mask == 0) {
      if (material != nullptr) {
        *material = tree.block_material(index);
      }
      return true;
    }
    const unsigned octant = octant_of(voxel, level);
    if ((mask >> octant & 1U) == 0) {
      return false;
    }
    index = tree.first_child(index) + bits::popcount8(mask & ((1U << octant) - 1));
  }
  if (material != nullptr) {
    *material = tree.voxel_material(index);
  }
  return true;
}

Status leave_medium(const CompactTree& tree, const Ray& ray, uint8_t material, MediumExit* exit,
                    const RayPoint& from, const TraceOptions& options) {
  MediumExit found;
  Search search(true, material);
  const Status status = search_from(tree, ray, from, options, &search, &found);
  if (status == Status::kOk) {
    *exit = found;
    if (!search.is_in_world) {
      exit->hit.kind = HitKind::kHit;
      exit->hit.voxel = starting_voxel(ray);
      exit->left_world = true;
    }
  }
  return status;
}

Status closest_hit_from(const CompactTree& tree, const Ray& ray, const RayPoint& from, Hit* hit,
                        const TraceOptions& options) {
  MediumExit found;
  Search search(false, 0);
  Status status = search_from(tree, ray, from, options, &search, &found);
  if (status == Status::kOk && !search.is_in_world) {
    status = closest_hit(tree, ray, &found.hit, options);
    only_from(from, &found.hit);
  }
  if (status == Status::kOk) {
    *hit = found.hit;
  }
  return status;
}

Status any_hit_before(const CompactTree& tree, const Ray& ray, const RayPoint& before, HitKind* kind,
                      uint32_t* visits, const TraceOptions& options) {
  Hit hit;
  const Status status = closest_hit(tree, ray, &hit, options);
  if (status == Status::kOk) {
    *kind = hit.kind == HitKind::kHit && !earlier(hit, before) ? HitKind::kMiss : hit.kind;
    if (visits != nullptr) {
      *visits = hit.visits;
    }
  }
  return status;
}
bool ray_towards(const Vec3Q8& start, const Vec3Q8& point, int direction_bits, Ray* ray, RayPoint* place) {
  Vec3i way;
  uint32_t largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    way[axis] = point[axis].raw - start[axis].raw;  // 24 bits within the limits of origins
    const uint32_t size = static_cast<uint32_t>(magnitude(way[axis]));
    largest = size > largest ? size : largest;
  }
  if (largest == 0) {
    return false;
  }
  int shift = bits::bit_length(largest) - direction_bits;
  if (shift > 0 && (largest + (1U << (shift - 1))) >> shift >> direction_bits != 0) {
    ++shift;  // rounding would carry into one bit more
  }
  shift = shift < 0 ? 0 : shift;
  for (int axis = 0; axis < 3; ++axis) {
    ray->direction[axis] =
        static_cast<int32_t>(with_sign_of(way[axis], shift_rounded(magnitude(way[axis]), shift)));
  }
  ray->origin = start;
  *place = {int32_t{1} << shift, Q8::kOne};
  return true;
}

}  // namespace thimble
