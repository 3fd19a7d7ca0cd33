// When a ray crosses the planes of the voxel lattice: the arithmetic of tracing, in two widths that give the
// same answers. Internal to src/. DESIGN.md, "Tracing", derives the bounds.
//
// Both work on a mirrored ray, whose direction has no negative component: the axes with a negative one are
// reflected in the middle of the world, which turns the half-open rule for them around as it must (a ray that
// starts on a face and leaves downwards starts in the voxel below).
//
//   begin   clips to the box of what is occupied; false when the ray never spends a positive length in it
//   enter   the current node is now the one at `corner` with a side of 2^level
//   descend the current node is now its child `octant`, with a side of 2^level
//   octant  the child in which the ray goes on from the present crossing
//   leave   goes on to the crossing at which the ray leaves child `octant`; returns the axes crossed (bit a =
//   axis
//           a), all of them when several are crossed at the same t; 0 when that lies outside the box
//   entered the lowest axis whose plane at `corner` is the present crossing; -1 for t = 0
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

  // `extent` is the world's side on each axis.
  MirroredRay(const Ray& ray, const Vec3i& extent, const VoxelBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool negative = ray.direction[axis] < 0;
      const int32_t side = extent[axis];
      direction[axis] = negative ? -ray.direction[axis] : ray.direction[axis];
      origin_q8[axis] = negative ? side * Q8::kOne - ray.origin[axis].raw : ray.origin[axis].raw;
      box_min[axis] = negative ? side - box.max[axis] : box.min[axis];
      box_max[axis] = negative ? side - box.min[axis] : box.max[axis];
      if (negative) {
        flip |= 1U << axis;
      }
    }
  }
};

// 64 bits: every t is multiplied by 256 times the product of the direction's non-zero components, which makes
// it an integer, linear in the plane's number:
//   T_x(i) = (256 i - origin_x) * direction_y * direction_z
// |256 i - origin| <= 5 * 2^20 and directions are below 2^20, so |T| < 5 * 2^60 < 2^63.
// An axis with direction 0 gets the factor kNever instead: planes at or behind the origin have T <= 0, planes
// ahead have T >= kNever, later than every crossing of the others (at most 5 * 2^20 * 2^20); inside the box
// |256 i - origin| <= 2^20, so |T| <= 6 * 2^60 < 2^63.
class Crossings64 {
 public:
  explicit Crossings64(const MirroredRay& ray) : ray_(ray) {}

  bool begin() {
    const Vec3i& d = ray_.direction;
    const int64_t dx = d.x != 0 ? d.x : 1;
    const int64_t dy = d.y != 0 ? d.y : 1;
    const int64_t dz = d.z != 0 ? d.z : 1;
    const Vec3<int64_t> factor{d.x != 0 ? dy * dz : kNever, d.y != 0 ? dx * dz : kNever,
                               d.z != 0 ? dx * dy : kNever};
    now_ = 0;
    end_ = INT64_MAX;
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t low = int64_t{ray_.box_min[axis]} * Q8::kOne - ray_.origin_q8[axis];
      const int64_t high = int64_t{ray_.box_max[axis]} * Q8::kOne - ray_.origin_q8[axis];
      if (high <= 0 || (d[axis] == 0 && low > 0)) {
        return false;
      }
      slope_[axis] = factor[axis] * Q8::kOne;
      const int64_t in = low * factor[axis];
      const int64_t out = high * factor[axis];
      if (in > now_) {
        now_ = in;
      }
      if (out < end_) {
        end_ = out;
      }
      // In a zero axis the product with a far origin is not needed: the origin is inside the box there.
      offset_[axis] = in - int64_t{ray_.box_min[axis]} * slope_[axis];
    }
    return now_ < end_;
  }

  void enter(const Vec3i& corner, int level) {
    upper_.x = plane(0, corner.x + (int32_t{1} << level));
    upper_.y = plane(1, corner.y + (int32_t{1} << level));
    upper_.z = plane(2, corner.z + (int32_t{1} << level));
    split(level);
  }
  void descend(unsigned octant, const Vec3i&, int level) {
    if ((octant & 1U) == 0) {
      upper_.x = middle_.x;
    }
    if ((octant & 2U) == 0) {
      upper_.y = middle_.y;
    }
    if ((octant & 4U) == 0) {
      upper_.z = middle_.z;
    }
    split(level);
  }
  unsigned octant(const Vec3i&, int) const {
    return static_cast<unsigned>(middle_.x <= now_) | static_cast<unsigned>(middle_.y <= now_) << 1 |
           static_cast<unsigned>(middle_.z <= now_) << 2;
  }
  unsigned leave(unsigned octant, const Vec3i&, int) {
    const int64_t x = (octant & 1U) != 0 ? upper_.x : middle_.x;
    const int64_t y = (octant & 2U) != 0 ? upper_.y : middle_.y;
    const int64_t z = (octant & 4U) != 0 ? upper_.z : middle_.z;
    const int64_t xy = x < y ? x : y;
    now_ = xy < z ? xy : z;
    if (now_ >= end_) {
      return 0;
    }
    return static_cast<unsigned>(x == now_) | static_cast<unsigned>(y == now_) << 1 |
           static_cast<unsigned>(z == now_) << 2;
  }
  int entered(const Vec3i& corner) const {
    if (now_ == 0) {
      return -1;
    }
    return plane(0, corner.x) == now_ ? 0 : plane(1, corner.y) == now_ ? 1 : 2;
  }

 private:
  static constexpr int64_t kNever = int64_t{6} << 40;

  int64_t plane(int axis, int32_t number) const { return offset_[axis] + number * slope_[axis]; }
  void split(int level) {
    middle_.x = level > 0 ? upper_.x - (slope_.x << (level - 1)) : upper_.x;
    middle_.y = level > 0 ? upper_.y - (slope_.y << (level - 1)) : upper_.y;
    middle_.z = level > 0 ? upper_.z - (slope_.z << (level - 1)) : upper_.z;
  }

  const MirroredRay& ray_;
  Vec3<int64_t> offset_;  // T of the plane 0
  Vec3<int64_t> slope_;   // T from one plane to the next
  Vec3<int64_t> upper_;   // T of the current node's upper planes
  Vec3<int64_t> middle_;  // T of the planes that halve it
  int64_t now_ = 0;       // T of the present crossing
  int64_t end_ = 0;       // T at which the ray leaves the box
};

// 32 bits: the present crossing is the fraction num_ / den_ (in voxels times 256), and two crossings are
// compared by cross multiplication. All factors are distances to planes of the world (R) and direction
// components (D); `accepts_32` has made sure that R * D < 2^31.
class Crossings32 {
 public:
  explicit Crossings32(const MirroredRay& ray) : ray_(ray) {}

  bool begin() {
    const Vec3i& d = ray_.direction;
    num_ = 0;
    den_ = 1;
    end_num_ = 1;
    end_den_ = 0;  // never
    for (int axis = 0; axis < 3; ++axis) {
      const int32_t low = distance(axis, ray_.box_min[axis]);
      const int32_t high = distance(axis, ray_.box_max[axis]);
      if (high <= 0 || (d[axis] == 0 && low > 0)) {
        return false;
      }
      if (low > 0 && low * den_ > num_ * d[axis]) {
        num_ = low;
        den_ = d[axis];
      }
      if (d[axis] != 0 && high * end_den_ < end_num_ * d[axis]) {
        end_num_ = high;
        end_den_ = d[axis];
      }
    }
    passed();
    return before_end();
  }

  void enter(const Vec3i&, int) {}
  void descend(unsigned, const Vec3i&, int) {}
  unsigned octant(const Vec3i& corner, int level) const {
    const int32_t half = int32_t{1} << (level - 1);
    return static_cast<unsigned>(distance(0, corner.x + half) * den_ <= passed_.x) |
           static_cast<unsigned>(distance(1, corner.y + half) * den_ <= passed_.y) << 1 |
           static_cast<unsigned>(distance(2, corner.z + half) * den_ <= passed_.z) << 2;
  }
  unsigned leave(unsigned octant, const Vec3i& corner, int level) {
    const Vec3i& d = ray_.direction;
    const int shift = level > 0 ? level - 1 : 0;
    const int32_t x = distance(0, corner.x + (int32_t{1} << (shift + static_cast<int>(octant & 1U))));
    const int32_t y = distance(1, corner.y + (int32_t{1} << (shift + static_cast<int>((octant >> 1) & 1U))));
    const int32_t z = distance(2, corner.z + (int32_t{1} << (shift + static_cast<int>((octant >> 2) & 1U))));
    // x / d.x against y / d.y, then the earlier one against z / d.z. All distances are positive, so an axis
    // with direction 0 loses every comparison against one without.
    const int32_t xy = x * d.y - y * d.x;
    unsigned crossed = xy < 0 ? 1U : xy > 0 ? 2U : 3U;
    num_ = xy <= 0 ? x : y;
    den_ = xy <= 0 ? d.x : d.y;
    const int32_t with_z = num_ * d.z - z * den_;
    if (with_z >= 0) {
      crossed = with_z > 0 ? 4U : crossed | 4U;
      num_ = z;
      den_ = d.z;
    }
    if (!before_end()) {
      return 0;
    }
    passed();
    return crossed;
  }
  int entered(const Vec3i& corner) const {
    if (num_ == 0) {
      return -1;
    }
    for (int axis = 0; axis < 2; ++axis) {
      if (ray_.direction[axis] != 0 && distance(axis, corner[axis]) * den_ == passed_[axis]) {
        return axis;
      }
    }
    return 2;
  }

 private:
  int32_t distance(int axis, int32_t number) const { return number * Q8::kOne - ray_.origin_q8[axis]; }
  void passed() { passed_ = {num_ * ray_.direction.x, num_ * ray_.direction.y, num_ * ray_.direction.z}; }

  // The ray ends where the 64-bit path ends it, so that both visit the same nodes.
  bool before_end() const { return num_ * end_den_ < end_num_ * den_; }

  const MirroredRay& ray_;
  Vec3i passed_;     // num_ * direction: a plane at distance s is behind when s * den_ <= passed_
  int32_t num_ = 0;  // distance to the plane of the present crossing; 0 at the origin
  int32_t den_ = 1;  // direction component of that plane's axis
  // The same for the plane through which the ray leaves the box.
  int32_t end_num_ = 1;
  int32_t end_den_ = 0;
};

}  // namespace thimble

#endif
