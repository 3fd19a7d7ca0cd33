/// @file falling_ball.h
/// Small balls of voxels that fall through the air of a scene, in integers, without being part of its tree.
///
/// A ball is the union of three boxes, a cube without its edges, at any place in 1/256 voxel. A ray meets it
/// by the rule of ray.h (a positive length, no epsilon). It is drawn over the scene where nothing of it,
/// solid or water, is met before: so it has no shadow, and mirrors, glass and water do not show it. The tree
/// is in flash and cannot take voxels; a tree of its own for each frame would cost more than the picture.
#ifndef THIMBLE_PLATFORM_APPS_FALLING_BALL_H
#define THIMBLE_PLATFORM_APPS_FALLING_BALL_H

#include <stdint.h>

#include "apps/dirty_bands.h"
#include "thimble/base/vec.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"
#include "thimble/trace/secondary_ray.h"

namespace thimble::apps {

struct FallingBall {
  bool is_there = false;
  bool is_wet = false;  ///< it has met the surface
  Vec3i center;         ///< 1/256 voxel
  int32_t speed = 0;    ///< downwards, 1/256 voxel a frame
};

/// Half the side of a ball, its weight in what falls, and the way it falls: by the size of the world.
struct BallSize {
  int32_t half_q8 = 0;
  int32_t gravity_q8 = 0;  ///< a frame and frame
  int32_t height_q8 = 0;   ///< above the surface, where it begins
  int32_t mass_q8 = 0;     ///< in voxels of water: of a stone, twice its volume
};
constexpr BallSize ball_size(int level) {
  // 2 voxels of 64.
  const int32_t half = int32_t{8} << level;
  const int32_t side_q4 = half >> 3;  // (2 half) in 1/16 voxel
  // Beyond worlds of 2^9 the water takes no more.
  const int64_t mass = int64_t{side_q4} * side_q4 * side_q4 >> 3;
  return {half, (int32_t{5} << level) >> 4, int32_t{80} << level,
          mass > (int32_t{1} << 20) ? int32_t{1} << 20 : static_cast<int32_t>(mass)};
}

constexpr BoxQ8 box_of(const FallingBall& ball, const BallSize& size) {
  const int32_t half = size.half_q8;
  return {{ball.center.x - half, ball.center.y - half, ball.center.z - half},
          {ball.center.x + half, ball.center.y + half, ball.center.z + half}};
}

/// Where a ray enters something: t = distance / (256 * speed), the axis of the face.
struct BallHit {
  int32_t distance = 0;
  int32_t speed = 1;
  int axis = -1;
};

/// Whether the ray, from outside, spends a positive length in the box, and where it enters it. Distances are
/// below 2^23 and speeds below 2^20, so products are below 2^43.
inline bool enter_box(const Ray& ray, const BoxQ8& box, BallHit* hit) {
  int32_t in = -1;
  int32_t in_speed = 1;
  int32_t out = 0;
  int32_t out_speed = 0;  // 0: not known yet
  int axis_in = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t along = ray.direction[axis];
    const int32_t from = ray.origin[axis].raw;
    if (along == 0) {
      if (from < box.low[axis] || from >= box.high[axis]) {
        return false;
      }
      continue;
    }
    const int32_t speed = along < 0 ? -along : along;
    const int32_t near = along > 0 ? box.low[axis] - from : from - box.high[axis];
    const int32_t far = along > 0 ? box.high[axis] - from : from - box.low[axis];
    if (int64_t{near} * in_speed > int64_t{in} * speed) {
      in = near;
      in_speed = speed;
      axis_in = axis;
    }
    if (out_speed == 0 || int64_t{far} * out_speed < int64_t{out} * speed) {
      out = far;
      out_speed = speed;
    }
  }
  if (axis_in < 0 || in < 0 || int64_t{in} * out_speed >= int64_t{out} * in_speed) {
    return false;
  }
  *hit = {in, in_speed, axis_in};
  return true;
}

/// The same with a ball.
inline bool enter_ball(const Ray& ray, const FallingBall& ball, const BallSize& size, BallHit* hit) {
  const BoxQ8 whole = box_of(ball, size);
  BallHit first;
  if (!enter_box(ray, whole, &first)) {
    return false;
  }
  bool found = false;
  for (int axis = 0; axis < 3; ++axis) {
    // Half as thick along one axis.
    BoxQ8 box = whole;
    box.low[axis] += size.half_q8 / 2;
    box.high[axis] -= size.half_q8 / 2;
    if (enter_box(ray, box, &first) &&
        (!found || int64_t{first.distance} * hit->speed < int64_t{hit->distance} * first.speed)) {
      *hit = first;
      found = true;
    }
  }
  return found;
}

/// Whether the ball is met before another point of the same ray.
inline bool is_before(const BallHit& ball, int32_t t_numerator, int32_t t_denominator) {
  return int64_t{ball.distance} * t_denominator < int64_t{t_numerator} * 256 * ball.speed;
}

/// Its colour by the face that is seen.
constexpr Rgb8 falling_ball_color(const Ray& ray, const BallHit& hit, const Shading& shading) {
  const uint32_t light = shading.face_light[2 * hit.axis + (ray.direction[hit.axis] > 0 ? 0 : 1)];
  const auto lit = [light](uint32_t channel) {
    const uint32_t value = channel * light >> 8;
    return static_cast<uint8_t>(value > 255 ? 255 : value);
  };
  return {lit(250), lit(92), lit(64)};
}

}  // namespace thimble::apps

#endif
