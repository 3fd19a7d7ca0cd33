// What many rays of one camera have in common, and whether certainly all of them miss a box. Internal to
// src/.
#pragma once

#include <stdint.h>

#include "../base/ranges.h"
#include "../base/wide_arithmetic.h"
#include "thimble/base/vec.h"
#include "thimble/picture/camera.h"
#include "thimble/trace/ray.h"

namespace thimble {

// For each axis the least and greatest origin and direction. Both are affine in the pixel and rounded
// monotonically, so the two ends of a row, and the four corners of a rectangle, are the extremes.
struct RayRange {
  Vec3i origin_low;
  Vec3i origin_high;
  Vec3i direction_low;
  Vec3i direction_high;

  explicit RayRange(const Ray& first) {
    for (int axis = 0; axis < 3; ++axis) {
      origin_low[axis] = first.origin[axis].raw;
      direction_low[axis] = first.direction[axis];
    }
    origin_high = origin_low;
    direction_high = direction_low;
  }
  RayRange(const Ray& first, const Ray& last) : RayRange(first) { add(last); }

  void add(const Ray& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      widen(ray.origin[axis].raw, &origin_low[axis], &origin_high[axis]);
      widen(ray.direction[axis], &direction_low[axis], &direction_high[axis]);
    }
  }

 private:
  static void widen(int32_t value, int32_t* low, int32_t* high) {
    *low = value < *low ? value : *low;
    *high = value > *high ? value : *high;
  }
};

// The ray of a corner of the picture: bit 0 the right ones, bit 1 the lower ones.
inline Ray corner_ray(const Camera& camera, unsigned corner) {
  return camera.ray((corner & 1U) != 0 ? camera.width_px() - 1 : 0,
                    (corner & 2U) != 0 ? camera.height_px() - 1 : 0);
}

// Whether certainly none of the rays meets `box`: on some axis all start beyond it and none turns to it, or
// the soonest that any enters it on one axis is later than the last that any leaves it on another. Times are
// fractions of a distance (below 2^24) and a direction (below 2^20), compared by cross multiplication.
inline bool all_miss(const RayRange& rays, const VoxelBox& box) {
  if (box.empty()) {
    return true;
  }
  int32_t enter_num = 0;
  int32_t enter_den = 1;
  int32_t leave_num = 1;
  int32_t leave_den = 0;  // never
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t low = box.low[axis] * Q8::kOne;
    const int32_t high = box.high[axis] * Q8::kOne;
    int32_t before = low - rays.origin_high[axis];   // rays that go up have at least so far to go
    int32_t through = high - rays.origin_low[axis];  // and at most so far
    int32_t slowest = rays.direction_low[axis];
    int32_t fastest = rays.direction_high[axis];
    if (fastest < 0) {  // all go down: the same, mirrored
      before = rays.origin_low[axis] - high;
      through = rays.origin_high[axis] - low;
      slowest = -rays.direction_high[axis];
      fastest = -rays.direction_low[axis];
    } else if (slowest <= 0) {  // both ways, or along: nothing is known of leaving
      const int32_t above = rays.origin_low[axis] - high;
      if (above > before) {
        before = above;
        fastest = -slowest;
      }
      slowest = 0;
    }
    if (before > 0) {
      if (fastest == 0) {
        return true;
      }
      THIMBLE_NOTE(Range::kAllMiss, Exact(enter_num) * Exact(fastest));
      THIMBLE_NOTE(Range::kAllMiss, Exact(before) * Exact(enter_den));
      if (is_product_less(enter_num, fastest, before, enter_den)) {
        enter_num = before;
        enter_den = fastest;
      }
    }
    if (slowest > 0) {
      if (through <= 0) {
        return true;
      }
      THIMBLE_NOTE(Range::kAllMiss, Exact(through) * Exact(leave_den));
      THIMBLE_NOTE(Range::kAllMiss, Exact(leave_num) * Exact(slowest));
      if (is_product_less(through, leave_den, leave_num, slowest)) {
        leave_num = through;
        leave_den = slowest;
      }
    }
  }
  THIMBLE_NOTE(Range::kAllMiss, Exact(enter_num) * Exact(leave_den));
  THIMBLE_NOTE(Range::kAllMiss, Exact(leave_num) * Exact(enter_den));
  return !is_product_less(enter_num, leave_den, leave_num, enter_den);
}

}  // namespace thimble
