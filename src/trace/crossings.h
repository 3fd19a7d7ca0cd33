// Where a ray goes among the planes of the voxel lattice: the arithmetic of tracing, in 32 or 64 bits with
// the same answers. Internal to src/. src/trace/README.md derives the bounds.
//
// It works on a mirrored ray, whose direction has no negative component: the axes with a negative one are
// reflected in the middle of the world, which turns the half-open rule for them around as it must (a ray that
// starts on a face and leaves downwards starts in the voxel below).
//
// With s the distance from the origin to a plane and d the direction's component on that axis, the ray
// crosses a plane of axis a before one of axis b when s_a / d_a < s_b / d_b. So the sign of one number says
// which comes first:
//
//   order_ab = s_a * d_b - s_b * d_a        < 0: a's plane first    > 0: b's first    0: both at once
//
// It is linear in both planes' numbers, so a step to another node changes it by an addition. The ray spends a
// positive length in a box when, for every pair of axes, it crosses the lower plane of each before the upper
// plane of the other: a question about two axes at a time. Hence three such numbers, one a pair, tell for all
// eight octants of a node at once which of them the ray passes through. No product, no division, no time.
#pragma once

#include <stdint.h>

#include "../base/bits.h"
#include "../base/ranges.h"
#include "../base/wide_arithmetic.h"
#include "thimble/trace/ray.h"

namespace thimble {

// A distance times a direction's component, or the like: the products of tracing, all of which go through
// here, in its width.
template <class Int>
constexpr Int product(int32_t a, int32_t b);
template <>
constexpr int32_t product<int32_t>(int32_t a, int32_t b) {
  THIMBLE_NOTE(Range::kProduct32, Exact(a) * Exact(b));
  return a * b;
}
template <>
constexpr int64_t product<int64_t>(int32_t a, int32_t b) {
  THIMBLE_NOTE(Range::kProduct64, Exact(a) * Exact(b));
  return wide_product(a, b);
}

template <class Unsigned>
struct SignedOf;
template <>
struct SignedOf<uint32_t> {
  using Type = int32_t;
};
template <>
struct SignedOf<uint64_t> {
  using Type = int64_t;
};

// A ray with its negative axes reflected, and the box it is clipped to, reflected likewise.
struct MirroredRay {
  Vec3i origin_q8;
  Vec3i direction;  // no component negative
  Vec3i box_min;    // in voxels
  Vec3i box_max;
  unsigned flip = 0;  // bit a: axis a is reflected

  // In a world of `side` voxels a side.
  MirroredRay(const Ray& ray, int32_t side, const VoxelBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool negative = ray.direction[axis] < 0;
      direction[axis] = negative ? -ray.direction[axis] : ray.direction[axis];
      origin_q8[axis] = negative ? side * Q8::kOne - ray.origin[axis].raw : ray.origin[axis].raw;
      box_min[axis] = negative ? side - box.high[axis] : box.low[axis];
      box_max[axis] = negative ? side - box.low[axis] : box.high[axis];
      if (negative) {
        flip |= 1U << axis;
      }
      THIMBLE_NOTE(Range::kOrigin, Exact(origin_q8[axis]));
      THIMBLE_NOTE(Range::kDirection, Exact(direction[axis]));
    }
  }

  // Whether it starts in the world.
  bool within(int32_t side) const {
    const int32_t side_q8 = side * Q8::kOne;
    return origin_q8.x >= 0 && origin_q8.y >= 0 && origin_q8.z >= 0 && origin_q8.x < side_q8 &&
           origin_q8.y < side_q8 && origin_q8.z < side_q8;
  }
  // The octant that holds the origin, of the node of `level` that does.
  unsigned origin_octant(int level) const {
    const int shift = level + 7;
    return (static_cast<uint32_t>(origin_q8.x) >> shift & 1U) |
           (static_cast<uint32_t>(origin_q8.y) >> shift & 1U) << 1 |
           (static_cast<uint32_t>(origin_q8.z) >> shift & 1U) << 2;
  }

  // From the origin to plane `number` of `axis`, in 1/256 voxel.
  int32_t distance(int axis, int32_t number) const {
    THIMBLE_NOTE(Range::kDistance, Exact(number) * Exact(Q8::kOne) - Exact(origin_q8[axis]));
    return number * Q8::kOne - origin_q8[axis];
  }
};

// Octants as bits of a byte, changed from the mirrored numbering to the tree's or back: octant o moves to
// o ^ flip. Works on all bytes of a word at once.
constexpr uint32_t mirrored_octants(uint32_t octants, unsigned flip) {
  constexpr uint32_t kBytes = 0x01010101U;
  if ((flip & 1U) != 0) {
    octants = (octants & kBytes * 0x55U) << 1 | (octants >> 1 & kBytes * 0x55U);
  }
  if ((flip & 2U) != 0) {
    octants = (octants & kBytes * 0x33U) << 2 | (octants >> 2 & kBytes * 0x33U);
  }
  if ((flip & 4U) != 0) {
    octants = (octants & kBytes * 0x0FU) << 4 | (octants >> 4 & kBytes * 0x0FU);
  }
  return octants;
}

// The octants (as bits) that a ray in `octant` can still come to, which are those with all of its bits.
constexpr uint32_t octants_from(unsigned octant) {
  return ((octant & 1U) != 0 ? 0xAAU : 0xFFU) & ((octant & 2U) != 0 ? 0xCCU : 0xFFU) &
         ((octant & 4U) != 0 ? 0xF0U : 0xFFU);
}

// The way of a ray through the nodes that it crosses: which octants of them it passes through.
//
// Its state is one number for each pair of axes, the order of the upper plane of the first axis against the
// lower plane of the second, in units that shrink with the node (2^-k for nodes of 1/2^k of the world). In
// these units moving a plane by half a node always changes an order by the same amount, so everything that
// the state is compared with is made once a ray. The ray crosses the node, so the state lies between 0 and
// twice the sum of the two amounts, at every level: below 2 * R * D < 2^32 for a ray that `accepts_32` takes,
// below 2^42 for others. So it is unsigned: the difference of its two products may pass 2^31, and no more.
template <class Unsigned>
class NodePath {
 public:
  struct State {
    Unsigned xy;
    Unsigned yz;
    Unsigned zx;
  };

  // Not set up: only to be assigned to.
  NodePath() = default;
  // All rays of the same direction have the same path but for where it starts. The world is 2^level a side.
  NodePath(const MirroredRay& ray, int level) : xy_(ray, level), yz_(ray, level), zx_(ray, level) {}

  // At the world, which the ray crosses.
  State start(const MirroredRay& ray, int level) const {
    return {xy_.start(ray, level), yz_.start(ray, level), zx_.start(ray, level)};
  }
  // From a node to its child `octant` (mirrored), which the ray crosses.
  State child(const State& node, unsigned octant) const {
    THIMBLE_NOTE(state_range<Unsigned>(), Exact(2) * (Exact(node.xy) - Exact(xy_.change[octant & 3U])));
    THIMBLE_NOTE(state_range<Unsigned>(), Exact(2) * (Exact(node.yz) - Exact(yz_.change[octant >> 1])));
    THIMBLE_NOTE(state_range<Unsigned>(),
                 Exact(2) * (Exact(node.zx) - Exact(zx_.change[(octant >> 2 | octant << 1) & 3U])));
    return {2 * (node.xy - xy_.change[octant & 3U]), 2 * (node.yz - yz_.change[octant >> 1]),
            2 * (node.zx - zx_.change[(octant >> 2 | octant << 1) & 3U])};
  }
  // The octants, as bits in the tree's numbering, in which the line spends a positive length.
  uint32_t octants(const State& state) const {
    return xy_.octants(state.xy) & yz_.octants(state.yz) & zx_.octants(state.zx);
  }

 private:
  // Seen along the third axis the node is a square of four quadrants and the ray a line across. As the state
  // grows the line moves over the square, and each quadrant is met for a stretch of it:
  //
  //   state       0    least    most       middle      middle+least   middle+most   2 * middle
  //   a only      #########################
  //   neither           ##############################################
  //   both                      ####################################################
  //   b only                               #########################################
  //
  // (`half_a` and `half_b` are what the state changes by when a plane of b or a moves by half a node, `least`
  // and `most` the smaller and the greater of them; `neither` and `both` change places where half_b is the
  // greater). Quadrants are named by the axes on which they lie above the middle. At `middle` the line goes
  // through the centre and only touches the other two.
  //
  // An axis along which the ray does not move: its planes up to the origin were crossed before all others,
  // those ahead never are. Only a plane just at the origin needs care, since it would count as a tie:
  // `none_a` and `none_b` move the bounds by one, which no other state sees, as all are multiples of the half
  // that is not 0.
  template <int kA, int kB>
  struct Pair {
    Unsigned change[4];  // by the child: bit 0 above the middle on the first axis, bit 1 on the second
    Unsigned bound[6];
    uint8_t quadrants[8];  // by how many bounds are above the state

    Pair() = default;
    Pair(const MirroredRay& ray, int level) {
      const Unsigned d_a = static_cast<Unsigned>(ray.direction[kA]);
      const Unsigned d_b = static_cast<Unsigned>(ray.direction[kB]);
      const Unsigned half_a = d_a << (level + 7);
      const Unsigned half_b = d_b << (level + 7);
      const Unsigned middle = half_a + half_b;
      change[0] = half_b;
      change[1] = 0;
      change[2] = middle;
      change[3] = half_a;

      const bool a_most = half_a >= half_b;
      const Unsigned least = a_most ? half_b : half_a;
      const Unsigned most = a_most ? half_a : half_b;
      const Unsigned none_a = d_a == 0 ? 1 : 0;
      const Unsigned none_b = d_b == 0 ? 1 : 0;
      bound[0] = least + 1 - none_b;
      bound[1] = most + 1 - none_b;
      bound[2] = middle + none_a;
      bound[3] = middle + 1 - none_b;
      bound[4] = middle + least + none_a;
      bound[5] = middle + most + none_a;
      THIMBLE_NOTE(state_range<Unsigned>(),
                   (Exact(d_a) + Exact(d_b)) * Exact(1 << (level + 7)) + Exact(most) + Exact(none_a));

      constexpr uint32_t kAbove[3] = {0xAAU, 0xCCU, 0xF0U};
      constexpr uint32_t kOnlyA = kAbove[kA] & ~kAbove[kB];
      constexpr uint32_t kOnlyB = kAbove[kB] & ~kAbove[kA];
      constexpr uint32_t kBoth = kAbove[kA] & kAbove[kB];
      constexpr uint32_t kNeither = 0xFFU & ~(kAbove[kA] | kAbove[kB]);
      // Backwards: all bounds are above the smallest states.
      constexpr uint32_t kUpTo3 =
          kOnlyB | kOnlyB << 8 | (kNeither | kBoth | kOnlyB) << 16 | (kNeither | kBoth) << 24;
      constexpr uint32_t kFrom4 = (kNeither | kBoth | kOnlyA) | kOnlyA << 8 | kOnlyA << 16;
      uint32_t up_to_3 = kUpTo3 | (a_most ? kBoth : kNeither) << 8;
      uint32_t from_4 = kFrom4 | (a_most ? kNeither : kBoth) << 8;
      if (middle == 0) {  // the ray is a point here, and the other pairs say where
        up_to_3 = 0xFFFFFFFFU;
        from_4 = 0xFFFFFFFFU;
      }
      bits::store32(quadrants, mirrored_octants(up_to_3, ray.flip));
      bits::store32(quadrants + 4, mirrored_octants(from_4, ray.flip));
    }

    Unsigned start(const MirroredRay& ray, int level) const {
      using Int = typename SignedOf<Unsigned>::Type;
      const Int upper = product<Int>(ray.distance(kA, int32_t{1} << level), ray.direction[kB]);
      const Int lower = product<Int>(ray.distance(kB, 0), ray.direction[kA]);
      THIMBLE_NOTE(state_range<Unsigned>(), Exact(upper) - Exact(lower));
      return static_cast<Unsigned>(upper) - static_cast<Unsigned>(lower);
    }
    uint32_t octants(Unsigned state) const {
      // Written out, since gcc -O2 would make a loop of it.
      unsigned above = state < bound[0] ? 1 : 0;
      above += state < bound[1] ? 1 : 0;
      above += state < bound[2] ? 1 : 0;
      above += state < bound[3] ? 1 : 0;
      above += state < bound[4] ? 1 : 0;
      above += state < bound[5] ? 1 : 0;
      return quadrants[above];
    }
  };

  Pair<0, 1> xy_;
  Pair<1, 2> yz_;
  Pair<2, 0> zx_;
};

// `Int` is int64_t for all rays, int32_t for those that `accepts_32` takes: with R the largest distance to a
// plane of the world and D the largest direction component, R * D < 2^31.
template <class Int>
class Crossings {
 public:
  // The three orders of the planes that a cell is left by.
  struct Orders {
    Int xy;
    Int yz;
    Int zx;
  };

  explicit Crossings(const MirroredRay& ray)
      : ray_(ray),
        d_(ray.direction),
        none_{ray.direction.x == 0, ray.direction.y == 0, ray.direction.z == 0} {}

  // Whether the ray spends a positive length in its box; it then enters it at t = num / den (times 256).
  bool enter_box(int32_t* num, int32_t* den) const {
    *num = 0;
    *den = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t low = ray_.distance(axis, ray_.box_min[axis]);
      if (low > 0 && (d_[axis] == 0 || product<Int>(low, *den) > product<Int>(*num, d_[axis]))) {
        if (d_[axis] == 0) {
          return false;
        }
        *num = low;
        *den = d_[axis];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t high = ray_.distance(axis, ray_.box_max[axis]);
      if (high <= 0 || (d_[axis] != 0 && product<Int>(high, *den) <= product<Int>(*num, d_[axis]))) {
        return false;
      }
    }
    return true;
  }

  // The cell in which the ray continues from t = num / den (times 256), in a world of 2^level that it is in
  // then.
  Vec3i cell_at(int32_t num, int32_t den, int level) const {
    Vec3i cell;
    for (int axis = 0; axis < 3; ++axis) {
      for (int32_t bit = int32_t{1} << (level - 1); bit != 0; bit >>= 1) {
        if (product<Int>(ray_.distance(axis, cell[axis] | bit), den) <= product<Int>(num, d_[axis])) {
          cell[axis] |= bit;
        }
      }
    }
    return cell;
  }

  // The orders of plane `at.x` against plane `at.y`, and so on. The products stay within the bounds; so does
  // the difference when the planes meet a node that the ray crosses.
  Orders orders(const Vec3i& at) const {
    const Vec3i s{ray_.distance(0, at.x), ray_.distance(1, at.y), ray_.distance(2, at.z)};
    THIMBLE_NOTE(order_range<Int>(), Exact(s.x) * Exact(d_.y) - Exact(s.y) * Exact(d_.x));
    THIMBLE_NOTE(order_range<Int>(), Exact(s.y) * Exact(d_.z) - Exact(s.z) * Exact(d_.y));
    THIMBLE_NOTE(order_range<Int>(), Exact(s.z) * Exact(d_.x) - Exact(s.x) * Exact(d_.z));
    return {product<Int>(s.x, d_.y) - product<Int>(s.y, d_.x),
            product<Int>(s.y, d_.z) - product<Int>(s.z, d_.y),
            product<Int>(s.z, d_.x) - product<Int>(s.x, d_.z)};
  }

  // The axes on which the ray leaves a cell (bit a = axis a), all of them when it crosses several of its
  // upper planes at once; `orders` are those of these planes.
  unsigned leave(const Orders& orders) const {
    const bool x_before_y = orders.xy - none_.x < 0;
    const bool y_before_x = -orders.xy - none_.y < 0;
    const bool y_before_z = orders.yz - none_.y < 0;
    const bool z_before_y = -orders.yz - none_.z < 0;
    const bool z_before_x = orders.zx - none_.z < 0;
    const bool x_before_z = -orders.zx - none_.x < 0;
    return static_cast<unsigned>(!y_before_x && !z_before_x) |
           static_cast<unsigned>(!x_before_y && !z_before_y) << 1 |
           static_cast<unsigned>(!x_before_z && !y_before_z) << 2;
  }
  // From the upper planes of a cell to those of the next one beyond `crossed`.
  void advance(unsigned crossed, Orders* orders) const {
    const int32_t x = (crossed & 1U) != 0 ? Q8::kOne : 0;
    const int32_t y = (crossed & 2U) != 0 ? Q8::kOne : 0;
    const int32_t z = (crossed & 4U) != 0 ? Q8::kOne : 0;
    THIMBLE_NOTE(order_range<Int>(), Exact(orders->xy) + Exact(x) * Exact(d_.y) - Exact(y) * Exact(d_.x));
    THIMBLE_NOTE(order_range<Int>(), Exact(orders->yz) + Exact(y) * Exact(d_.z) - Exact(z) * Exact(d_.y));
    THIMBLE_NOTE(order_range<Int>(), Exact(orders->zx) + Exact(z) * Exact(d_.x) - Exact(x) * Exact(d_.z));
    orders->xy += product<Int>(x, d_.y) - product<Int>(y, d_.x);
    orders->yz += product<Int>(y, d_.z) - product<Int>(z, d_.y);
    orders->zx += product<Int>(z, d_.x) - product<Int>(x, d_.z);
  }

  // The axis of the face by which the ray enters the box with its lowest corner at `corner`: the lower plane
  // crossed last, the lowest axis on a tie; -1 when the ray starts inside.
  int entered(const Vec3i& corner) const {
    int axis = -1;
    int32_t last = 0;
    for (int a = 0; a < 3; ++a) {
      const int32_t s = ray_.distance(a, corner[a]);
      if (s > 0 && (axis < 0 || product<Int>(s, d_[axis]) > product<Int>(last, d_[a]))) {
        axis = a;
        last = s;
      }
    }
    return axis;
  }

 private:
  const MirroredRay& ray_;
  Vec3i d_;     // direction
  Vec3i none_;  // 1 where it is 0
};

}  // namespace thimble
