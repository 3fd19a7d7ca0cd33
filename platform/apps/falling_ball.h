/// Balls that fall through the air of a scene, in integers, without being part of its tree, which is in flash
/// (thimble/light/render.h says how they are drawn).
#pragma once

#include <stdint.h>

#include "thimble/base/vec.h"
#include "thimble/light/render.h"

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

/// As it is drawn.
constexpr Ball drawn_ball(const FallingBall& ball, const BallSize& size) {
  Ball drawn;
  drawn.center = ball.center;
  drawn.half_q8 = ball.is_there ? size.half_q8 : 0;
  drawn.bottom_q8 = 0;
  drawn.top_q8 = ball.center.z + size.half_q8;
  drawn.surface.albedo = {250, 92, 64};
  return drawn;
}

}  // namespace thimble::apps
