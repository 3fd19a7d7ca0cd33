// The definitions, word for word: every box against the ray, in 128-bit integers.
#include <stdexcept>

#include "reference/reference.h"

namespace thimble::reference {

namespace {

__extension__ typedef __int128 Int128;

// A value of t; denominator > 0.
struct Instant {
  Int128 numerator;
  Int128 denominator;
};

bool earlier(const Instant& a, const Instant& b) {
  return a.numerator * b.denominator < b.numerator * a.denominator;
}

// When the ray is at coordinate `plane` (in voxels) of `axis`; the direction there is not zero. Negative when
// that lies behind the origin.
Instant passes(const Ray& ray, std::size_t axis, int plane) {
  const Int128 distance_q8 = Int128{256} * plane - ray.origin_q8[axis];
  const Int128 speed_q8 = Int128{256} * ray.direction[axis];
  return speed_q8 > 0 ? Instant{distance_q8, speed_q8} : Instant{-distance_q8, -speed_q8};
}

// The ray against the one half-open cube [lowest, lowest + side).
Hit intersect(const Voxel& lowest, int side, const Ray& ray) {
  Instant enter{0, 1};  // the ray begins at t = 0
  Instant leave{0, 1};
  bool leave_known = false;
  int axis_entered = -1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int low = lowest[axis];
    const int high = low + side;
    const std::int64_t direction = ray.direction[axis];
    if (direction == 0) {
      // The coordinate never changes: it is in the half-open interval all the time or never.
      const std::int64_t origin_q8 = ray.origin_q8[axis];
      if (origin_q8 < std::int64_t{256} * low || origin_q8 >= std::int64_t{256} * high) {
        return Hit{};
      }
      continue;
    }
    // Which end of the interval is closed makes no difference to a length, so it is not looked at here.
    const Instant in = passes(ray, axis, direction > 0 ? low : high);
    const Instant out = passes(ray, axis, direction > 0 ? high : low);
    // Only a strictly later entry takes over: on a tie the lowest axis stays, and -1 stays where the ray is
    // between all planes from t = 0 on.
    if (earlier(enter, in)) {
      enter = in;
      axis_entered = static_cast<int>(axis);
    }
    if (!leave_known || earlier(out, leave)) {
      leave = out;
      leave_known = true;
    }
  }
  if (!earlier(enter, leave)) {
    return Hit{};  // no positive length
  }
  return Hit{true, lowest, static_cast<std::int64_t>(enter.numerator),
             static_cast<std::int64_t>(enter.denominator), axis_entered};
}

// Keeps the earlier of two hits in `first`.
void keep_first(Hit& first, const Hit& candidate) {
  if (!candidate.hit) {
    return;
  }
  const Instant entered{candidate.t_numerator, candidate.t_denominator};
  const Instant best{first.t_numerator, first.t_denominator};
  if (!first.hit || earlier(entered, best)) {
    first = candidate;
  } else if (!earlier(best, entered) && first.voxel != candidate.voxel) {
    // Disjoint boxes cannot be entered at the same t (see reference.h).
    throw std::logic_error("reference: two boxes entered at the same t, so they overlap");
  }
}

}  // namespace

Hit brute_force(const std::vector<Voxel>& voxels, const Ray& ray) {
  check_ray(ray);
  Hit first;
  for (const Voxel& voxel : voxels) {
    keep_first(first, intersect(voxel, 1, ray));
  }
  return first;
}

Hit judge_blocks(const std::vector<Block>& blocks, const Ray& ray) {
  check_ray(ray);
  Hit first;
  for (const Block& block : blocks) {
    if (block.log2_side < 0 || block.log2_side > 12) {
      throw std::invalid_argument("reference: block side out of range");
    }
    const int side = 1 << block.log2_side;
    for (const int corner : block.lowest) {
      if (corner % side != 0) {
        throw std::invalid_argument("reference: block not aligned to its side");
      }
    }
    keep_first(first, intersect(block.lowest, side, ray));
  }
  return first;
}

}  // namespace thimble::reference
