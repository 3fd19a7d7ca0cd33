// What the boundaries of glass, water and ripples share: how light is split at a bent surface, and where the rays that
// leave it begin. Internal to the effects.
#pragma once

#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

/// How far from the face of a slope rays start, in 1/256 voxel: above its steps. The corners of a plane's voxels
/// lie within the root of 3 of one another along its normal, and most within this.
inline constexpr int32_t kSlopeRise = 3 * Q8::kOne / 2;

/// A ray that starts on the face all the same leaves it at 1/128 at least: what a bend turns the wrong way through the
/// flat face runs along it.
constexpr Vec3i turned_from(Vec3i direction, int axis, bool upwards) {
  constexpr int32_t kLeast = 128;
  if (upwards ? direction[axis] < kLeast : direction[axis] > -kLeast) {
    direction[axis] = upwards ? kLeast : -kLeast;
  }
  return direction;
}

/// What becomes of light at a boundary: two directions and the share that is reflected (kOneQ16: all of it).
struct Split {
  Vec3i reflected;
  Vec3i refracted;
  uint32_t back = kOneQ16;
};
/// At a unit normal, bent, which a ray of direction `unit` meets from index `here` to `there`.
inline Split split_at(const Vec3i& unit, const Vec3i& normal, uint32_t here, uint32_t there) {
  Split split;
  split.reflected = shorten(reflect(unit, normal));
  if (refract(unit, normal, eta_q12(here, there), &split.refracted)) {
    split.back = fresnel_q16(dot_q14(here < there ? unit : split.refracted, normal), r0_q16(here, there));
  }
  return split;
}

/// A point on the surface of the water that lies in the next column moves up or down to that one's top, to the side of the
/// surface on which its ray belongs: what a step of a wave reflects runs towards it, and a point rounded to 1/256 voxel
/// may lie on a column's edge.
inline Vec3Q8 beside_surface(const WaterSurface& water, Vec3Q8 at, const Vec3i& direction, bool in_water) {
  const Vec3i voxel = starting_voxel({at, direction});
  const int32_t x = voxel.x - water.corner.x;
  const int32_t y = voxel.y - water.corner.y;
  if (x >= 0 && y >= 0 && x < water.width && y < water.depth && water.height_q16(x, y) >= 0) {
    const int32_t top = water.corner.z * Q8::kOne + water.height_q8(x, y);
    if (in_water ? at.z.raw > top : at.z.raw < top) {
      at.z = Q8::from_raw(top);
    }
  }
  return at;
}

/// Sends a share of a ray's light, where it can be seen.
inline void send_share(Frame& frame, const PendingRay& from, LitRayKind kind, int8_t axis, const Ray& ray,
                       uint32_t share_q16, PendingRay* pending, size_t* count) {
  Weight weight;
  for (int i = 0; i < 3; ++i) {
    weight.c[i] = weighed(from.weight.c[i], share_q16);
  }
  send(frame, from, kind, axis, ray, weight, pending, count);
}

}  // namespace thimble::lit
