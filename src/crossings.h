// Where a ray goes among the planes of the voxel lattice: the arithmetic of tracing, in 32 or 64 bits with the
// same answers. Internal to src/. DESIGN.md, "Tracing", derives the bounds.
//
// It works on a mirrored ray, whose direction has no negative component: the axes with a negative one are
// reflected in the middle of the world, which turns the half-open rule for them around as it must (a ray that
// starts on a face and leaves downwards starts in the voxel below).
//
// With s the distance from the origin to a plane and d the direction's component on that axis (both of one
// sign for what lies ahead), the ray crosses a plane of axis a before one of axis b when s_a / d_a < s_b / d_b.
// So the sign of one number says which comes first:
//
//   order_ab = s_a * d_b - s_b * d_a        < 0: a's plane first    > 0: b's first    0: both at once
//
// It is linear in both planes' numbers, hence all that a step to another node changes is an addition. A ray
// spends a positive length in a box when, for every pair of axes, it crosses the lower plane of each before
// the upper plane of the other. That is a question about a pair of axes at a time, and three of these numbers
// answer it for all eight octants of a node.
#ifndef THIMBLE_SRC_CROSSINGS_H
#define THIMBLE_SRC_CROSSINGS_H

#include <stdint.h>

#include "thimble/ray.h"

namespace thimble {

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
      box_min[axis] = negative ? side - box.max[axis] : box.min[axis];
      box_max[axis] = negative ? side - box.min[axis] : box.max[axis];
      if (negative) {
        flip |= 1U << axis;
      }
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
  int32_t distance(int axis, int32_t number) const { return number * Q8::kOne - origin_q8[axis]; }
};

// The eight octants as bits of a byte, changed from the mirrored numbering to the tree's or back: octant o
// moves to o ^ flip.
inline uint32_t mirrored_octants(uint32_t octants, unsigned flip) {
  if ((flip & 1U) != 0) {
    octants = (octants & 0x55U) << 1 | (octants >> 1 & 0x55U);
  }
  if ((flip & 2U) != 0) {
    octants = (octants & 0x33U) << 2 | (octants >> 2 & 0x33U);
  }
  if ((flip & 4U) != 0) {
    octants = (octants & 0x0FU) << 4 | octants >> 4;
  }
  return octants;
}

// The octants (as bits) that a ray in `octant` can still come to, which are those with all of its bits.
constexpr uint32_t octants_from(unsigned octant) {
  return ((octant & 1U) != 0 ? 0xAAU : 0xFFU) & ((octant & 2U) != 0 ? 0xCCU : 0xFFU) &
         ((octant & 4U) != 0 ? 0xF0U : 0xFFU);
}

// `Int` is int64_t for all rays, int32_t for those that `accepts_32` takes: with R the largest distance to a
// plane of the world and D the largest direction component, R * D < 2^31.
template <class Int>
class Crossings {
 public:
  // The three orders, of the planes that halve a node (trees) or of those that a cell is left by (grids).
  struct Orders {
    Int xy;
    Int yz;
    Int zx;
  };

  explicit Crossings(const MirroredRay& ray)
      : ray_(ray),
        d_{ray.direction.x, ray.direction.y, ray.direction.z},
        none_{ray.direction.x == 0, ray.direction.y == 0, ray.direction.z == 0},
        xy_(0xAAU, 0xCCU, ray.flip),
        yz_(0xCCU, 0xF0U, ray.flip),
        zx_(0xF0U, 0xAAU, ray.flip) {}

  // Whether the ray spends a positive length in its box; it then enters it at t = num / den (times 256).
  bool enter_box(Int* num, Int* den) const {
    *num = 0;
    *den = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const Int low = ray_.distance(axis, ray_.box_min[axis]);
      if (low > 0 && (d_[axis] == 0 || low * *den > *num * d_[axis])) {
        if (d_[axis] == 0) {
          return false;
        }
        *num = low;
        *den = d_[axis];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const Int high = ray_.distance(axis, ray_.box_max[axis]);
      if (high <= 0 || (d_[axis] != 0 && high * *den <= *num * d_[axis])) {
        return false;
      }
    }
    return true;
  }

  // The cell in which the ray goes on from t = num / den (times 256), in a world of 2^level that it is in then.
  Vec3i cell_at(Int num, Int den, int level) const {
    Vec3i cell;
    for (int axis = 0; axis < 3; ++axis) {
      for (int32_t bit = int32_t{1} << (level - 1); bit != 0; bit >>= 1) {
        if (ray_.distance(axis, cell[axis] | bit) * den <= num * d_[axis]) {
          cell[axis] |= bit;
        }
      }
    }
    return cell;
  }

  // The orders of plane `at.x` against plane `at.y`, and so on. The products stay within the bounds; so does
  // the difference when the planes meet a node that the ray crosses.
  Orders orders(const Vec3i& at) const {
    const Vec3<Int> s{ray_.distance(0, at.x), ray_.distance(1, at.y), ray_.distance(2, at.z)};
    return {s.x * d_.y - s.y * d_.x, s.y * d_.z - s.z * d_.y, s.z * d_.x - s.x * d_.z};
  }

  // The octants, in the tree's numbering, in which the whole line spends a positive length, of a node of
  // `level` that it crosses; `orders` are those of its middle planes.
  uint32_t path(const Orders& orders, int level) const {
    const Vec3<Int> step = quarter(level);
    return xy_.path(orders.xy, step.x, step.y, none_.x, none_.y) &
           yz_.path(orders.yz, step.y, step.z, none_.y, none_.z) &
           zx_.path(orders.zx, step.z, step.x, none_.z, none_.x);
  }

  // From the middle planes of a node of `level` to those of its child `octant` (mirrored), which lie half of
  // half its side away.
  void descend(unsigned octant, int level, Orders* orders) const {
    const Vec3<Int> step = quarter(level);
    const Int x = (octant & 1U) != 0 ? 1 : -1;
    const Int y = (octant & 2U) != 0 ? 1 : -1;
    const Int z = (octant & 4U) != 0 ? 1 : -1;
    orders->xy += x * step.y - y * step.x;
    orders->yz += y * step.z - z * step.y;
    orders->zx += z * step.x - x * step.z;
  }

  // The axes on which the ray leaves a cell (bit a = axis a), all of them when it crosses several of its upper
  // planes at once; `orders` are those of these planes.
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
    const Int x = (crossed & 1U) != 0 ? Q8::kOne : 0;
    const Int y = (crossed & 2U) != 0 ? Q8::kOne : 0;
    const Int z = (crossed & 4U) != 0 ? Q8::kOne : 0;
    orders->xy += x * d_.y - y * d_.x;
    orders->yz += y * d_.z - z * d_.y;
    orders->zx += z * d_.x - x * d_.z;
  }

  // The axis of the face by which the ray enters the box with its lowest corner at `corner`: the lower plane
  // crossed last, the lowest axis on a tie; -1 when the ray starts inside.
  int entered(const Vec3i& corner) const {
    int axis = -1;
    Int last = 0;
    for (int a = 0; a < 3; ++a) {
      const Int s = ray_.distance(a, corner[a]);
      if (s > 0 && (axis < 0 || s * d_[axis] > last * d_[a])) {
        axis = a;
        last = s;
      }
    }
    return axis;
  }

 private:
  // A pair of axes, and the octants of each of its four quadrants.
  struct Pair {
    uint32_t neither;  // below the middle on both axes
    uint32_t both;
    uint32_t first;  // above the middle on the first axis only
    uint32_t second;

    // From the octants above the middle on the two axes.
    Pair(uint32_t above_a, uint32_t above_b, unsigned flip) {
      const uint32_t a = mirrored_octants(above_a, flip);
      const uint32_t b = mirrored_octants(above_b, flip);
      neither = ~(a | b);
      both = a & b;
      first = a & ~b;
      second = b & ~a;
    }

    // Seen along the third axis the ray is a line over four squares, which has passed between the outer
    // corners. It meets a square when it passes between two opposite corners of it, and the orders there are
    // that of the middle plus or minus twice a step.
    //
    // An axis along which the ray does not move: its planes up to the origin were crossed before all others,
    // those ahead never are. `none` decides the tie of a plane just at the origin for that; all other orders
    // are multiples of the other direction component already.
    //
    // Of numbers below 1.5 * 2^31 only the signs are wanted, so the lowest bit is dropped to make them fit:
    // steps are multiples of 128, and halves rounded down compare with them as the whole does.
    uint32_t path(Int order, Int step_a, Int step_b, Int none_a, Int none_b) const {
      const Int before = (order - none_a) >> 1;
      const Int after = (-order - none_b) >> 1;
      return (neither & sign((before - step_b) & (after - step_a))) |
             (both & sign((before - step_a) & (after - step_b))) | (first & sign(before)) |
             (second & sign(after));
    }
    // All bits when negative, else none.
    static uint32_t sign(Int value) { return static_cast<uint32_t>(value >> (8 * sizeof(Int) - 1)); }
  };

  // A quarter of the side of a node of `level`, in 1/256 voxel, times the direction: half of what an order
  // changes by when a plane moves from a node's middle to its side.
  Vec3<Int> quarter(int level) const {
    const int shift = level + 6;
    return {d_.x << shift, d_.y << shift, d_.z << shift};
  }

  const MirroredRay& ray_;
  Vec3<Int> d_;     // direction
  Vec3<Int> none_;  // 1 where it is 0
  Pair xy_;
  Pair yz_;
  Pair zx_;
};

}  // namespace thimble

#endif
