// Secondary rays, which start at a hit. The walk through a medium is that of trace.cpp turned round: there the octants
// that hold something are visited, here all of them, and what ends the walk is the first cell that is not of
// the medium. Both starts at a point of a ray share the one loop.
#include "thimble/trace/secondary_ray.h"

#include "../base/bits.h"
#include "../base/wide_arithmetic.h"
#include "../tree/compact_header.h"
#include "crossings.h"
#include "descent.h"
#include "width.h"

namespace thimble {
namespace {

// What a walk looks for, and where it begins.
struct Search {
  bool medium;  // the first cell that is not of `material`; otherwise the first solid one
  uint8_t material;
  uint32_t max_visits;
  int32_t numerator;  // of t, times 256
  int32_t denominator;
};

template <class Path>
struct SearchStep {
  typename Path::State state;
  uint32_t link;  // the first child
  uint8_t mask;
  uint8_t octant;  // the child that the walk is in; mirrored, as `rest`
  uint8_t rest;    // children still to visit, as bits
};

void add_octant(unsigned octant, int level, Vec3i* corner) {
  corner->x |= static_cast<int32_t>((octant & 1U) << (level - 1));
  corner->y |= static_cast<int32_t>((octant >> 1 & 1U) << (level - 1));
  corner->z |= static_cast<int32_t>((octant >> 2 & 1U) << (level - 1));
}

uint32_t child_number(uint32_t link, uint8_t mask, unsigned octant) {
  return link + bits::popcount8(mask & ((1U << octant) - 1));
}

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

// One walk of one ray in one width.
template <class Int, class Unsigned>
class SearchWalk {
 public:
  SearchWalk(const CompactTree& tree, const MirroredRay& ray)
      : tree_(tree),
        ray_(ray),
        level_(tree.level()),
        side_(int32_t{1} << tree.level()),
        crossings_(ray),
        path_(ray, tree.level()) {}

  // False when the ray is not in the world where the search begins. `exit->hit.kind` is kMiss when the ray
  // leaves the world without an answer.
  bool run(const Search& search, MediumExit* exit);
  // The cell outside the world that the ray comes to first.
  void leave_world(Hit* hit) const;

 private:
  using Path = NodePath<Unsigned>;

  // The block of `level` at `corner`, in which the walk ends; `state` is its. What is not merged is gone down
  // into, to the voxel by which the ray enters it.
  void report(typename Path::State state, Vec3i corner, int level, bool inside, bool merged, Hit* hit) const;
  void report_cell(const Vec3i& corner, int level, Hit* hit) const {
    hit->kind = HitKind::kHit;
    thimble::report(ray_, side_, crossings_, corner, level, hit);
  }
  Vec3i corner_of(int level) const { return thimble::corner_of(stack_, level, level_); }
  uint8_t voxel_material(const SearchStep<Path>& step, unsigned octant) const {
    return tree_.many_materials() ? tree_.voxel_material(child_number(step.link, step.mask, octant))
                                  : tree_.uniform_material();
  }

  const CompactTree& tree_;
  const MirroredRay& ray_;
  int level_;
  int32_t side_;
  Crossings<Int> crossings_;
  Path path_;
  Vec3i start_;  // the cell in which the search begins; mirrored
  SearchStep<Path> stack_[kMaxLevel + 1];
};

template <class Int, class Unsigned>
void SearchWalk<Int, Unsigned>::report(typename Path::State state, Vec3i corner, int level, bool inside,
                                       bool merged, Hit* hit) const {
  for (; level > 0 && !merged; --level) {
    uint32_t octants = mirrored_octants(path_.octants(state), ray_.flip);
    const unsigned start = octant_of(start_, level);
    if (inside) {
      octants &= octants_from(start);
    }
    const unsigned octant = bits::lowest_bit(octants);
    inside = inside && octant == start;
    add_octant(octant, level, &corner);
    state = path_.child(state, octant);
  }
  report_cell(corner, level, hit);
}

template <class Int, class Unsigned>
void SearchWalk<Int, Unsigned>::leave_world(Hit* hit) const {
  int32_t num = 0;
  int32_t den = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t distance = ray_.distance(axis, side_);
    const int32_t direction = ray_.direction[axis];
    if (direction != 0 && (den == 0 || product<Int>(distance, den) < product<Int>(num, direction))) {
      num = distance;
      den = direction;
    }
  }
  Vec3i cell = crossings_.cell_at(num, den, level_);
  for (int axis = 0; axis < 3; ++axis) {
    if (product<Int>(ray_.distance(axis, side_), den) <= product<Int>(num, ray_.direction[axis])) {
      cell[axis] = side_;
    }
  }
  report_cell(cell, 0, hit);
}

template <class Int, class Unsigned>
bool SearchWalk<Int, Unsigned>::run(const Search& search, MediumExit* exit) {
  const int32_t num = search.numerator;
  const int32_t den = search.denominator;
  if (!in_world<Int>(ray_, side_, num, den)) {
    return false;
  }
  start_ = crossings_.cell_at(num, den, level_);
  Hit* hit = &exit->hit;
  uint32_t pending = 0;  // bit k: stack_[k].rest is not 0
  typename Path::State state = path_.start(ray_, level_);
  uint32_t index = 0;
  int level = level_;
  bool inside = true;  // the node holds the start: only the octants ahead of it are looked at

  // Each turn arrives at the node `index` of `level`. The ray passes at most 3 * 2^k nodes of a level whose
  // nodes are 1/2^k of the world.
  for (;;) {
    if (hit->visits == search.max_visits) {
      hit->kind = HitKind::kStepLimit;
      return true;
    }
    ++hit->visits;
    SearchStep<Path>& arrived = stack_[level];
    arrived.rest = 0;
    if (index >= tree_.node_count()) {  // an empty or a damaged tree
      if (search.medium) {
        report(state, corner_of(level), level, inside, false, hit);
      }
      return true;
    }
    arrived.mask = tree_.mask(index);
    if (arrived.mask == 0) {
      const uint8_t material = tree_.block_material(index);
      if (!search.medium || material != search.material) {
        hit->material = material;
        exit->into_solid = true;
        report(state, corner_of(level), level, inside, tree_.is_merged(index), hit);
        return true;
      }
    } else {
      const uint32_t wanted = search.medium ? 0xFFU : arrived.mask;
      uint32_t rest = mirrored_octants(path_.octants(state) & wanted, ray_.flip);
      if (inside) {
        rest &= octants_from(octant_of(start_, level));
      }
      arrived.state = state;
      arrived.link = rest != 0 ? tree_.first_child(index) : 0;
      arrived.rest = static_cast<uint8_t>(rest);
      pending |= (rest != 0 ? 1U : 0U) << level;
    }

    // On to the next child that is a node; children that are cells are decided here, at most 4 of a node.
    for (bool down = false; !down;) {
      if (stack_[level].rest == 0) {
        if (pending == 0) {
          return true;
        }
        level = static_cast<int>(bits::lowest_bit(pending));
        inside = false;  // what holds the start comes first
      }
      SearchStep<Path>& step = stack_[level];
      const unsigned octant = bits::lowest_bit(step.rest);
      step.rest = static_cast<uint8_t>(step.rest & (step.rest - 1));
      step.octant = static_cast<uint8_t>(octant);
      if (step.rest == 0) {
        pending &= ~(1U << level);
      }
      const bool filled = ((uint32_t{step.mask} >> (octant ^ ray_.flip)) & 1U) != 0;
      if (level == 1 && filled) {
        const uint8_t material = voxel_material(step, octant ^ ray_.flip);
        if (search.medium && material == search.material) {
          continue;
        }
        hit->material = material;
        exit->into_solid = true;
      }
      const bool child_inside = inside && octant == octant_of(start_, level);
      state = path_.child(step.state, octant);
      if (level == 1 || !filled) {
        report(state, corner_of(level - 1), level - 1, child_inside, false, hit);
        return true;
      }
      index = child_number(step.link, step.mask, octant ^ ray_.flip);
      inside = child_inside;
      --level;
      down = true;
    }
  }
}

// Not inlined, so that a ray takes the stack of its own width only. False: not in the world there.
template <class Int, class Unsigned>
[[gnu::noinline]] bool walk_search(const CompactTree& tree, const MirroredRay& ray, const Search& search,
                                   MediumExit* exit) {
  SearchWalk<Int, Unsigned> walk(tree, ray);
  if (!walk.run(search, exit)) {
    return false;
  }
  if (search.medium && exit->hit.kind == HitKind::kMiss) {
    exit->left_world = true;
    walk.leave_world(&exit->hit);
  }
  return true;
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

MirroredRay in_all_of(int level, const Ray& ray) {
  const int32_t side = int32_t{1} << level;
  return MirroredRay(ray, side, {{0, 0, 0}, {side, side, side}});
}

// Inlined, so that its callers have no frame of their own below them on a small stack.
[[gnu::always_inline]] inline Status search_from(const CompactTree& tree, const Ray& ray,
                                                 const RayPoint& from, Search search, Width width,
                                                 bool* in_world, MediumExit* exit) {
  const int level = tree.level();
  const Status status = begin_at(ray, level, from, &search);
  if (status != Status::kOk) {
    return status;
  }
  bool narrow = false;
  if (!choose_width(width, &narrow, [&] { return accepts_32_from(ray, level, search); })) {
    return Status::kOutOfRange;
  }
  const MirroredRay mirrored = in_all_of(level, ray);
  *in_world = narrow ? walk_search<int32_t, uint32_t>(tree, mirrored, search, exit)
                     : walk_search<int64_t, uint64_t>(tree, mirrored, search, exit);
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
    index = child_number(tree.first_child(index), mask, octant);
  }
  if (material != nullptr) {
    *material = tree.voxel_material(index);
  }
  return true;
}

Status leave_medium(const CompactTree& tree, const Ray& ray, uint8_t material, MediumExit* exit,
                    const RayPoint& from, const TraceOptions& options) {
  MediumExit found;
  bool in_world = true;
  const Status status = search_from(tree, ray, from, {true, material, options.max_visits, 0, 1},
                                    options.width, &in_world, &found);
  if (status == Status::kOk) {
    *exit = found;
    if (!in_world) {
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
  bool in_world = true;
  Status status =
      search_from(tree, ray, from, {false, 0, options.max_visits, 0, 1}, options.width, &in_world, &found);
  if (status == Status::kOk && !in_world) {
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
