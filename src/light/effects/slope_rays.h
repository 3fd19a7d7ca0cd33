// Where rays from a slope begin and which way they may go. Internal to the effects.
#ifndef THIMBLE_SRC_LIGHT_EFFECTS_SLOPE_RAYS_H
#define THIMBLE_SRC_LIGHT_EFFECTS_SLOPE_RAYS_H

#include <stdint.h>

#include "thimble/base/vec.h"

namespace thimble::lit {

/// How far from the face of a slope rays start, in 1/256 voxel: above its steps. The corners of a plane's voxels
/// lie within the root of 3 of one another along its normal, and most within this.
inline constexpr int32_t kSlopeRise = 3 * Q8::kOne / 2;

/// A ray that starts on the face all the same leaves it at 1/128 at least.
constexpr Vec3i turned_from(Vec3i direction, int axis, bool upwards) {
  constexpr int32_t kLeast = 128;
  if (upwards ? direction[axis] < kLeast : direction[axis] > -kLeast) {
    direction[axis] = upwards ? kLeast : -kLeast;
  }
  return direction;
}

}  // namespace thimble::lit

#endif
