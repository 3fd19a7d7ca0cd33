/// Where the rays of neighbouring pixels can first meet something, found once for all of them.
#pragma once

#include <stdint.h>

#include "thimble/picture/camera.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// Some pixels of a picture.
struct PixelBox {
  int32_t x0, y0, x1, y1;
};

/// A plane before which none of some rays meets anything.
struct FirstPlane {
  int axis = 0;
  int32_t sign =
      0;           ///< of the rays' directions along the axis; 0: they may meet something wherever they begin
  int32_t at = 0;  ///< the plane's coordinate times the sign
  bool is_clear = false;  ///< none of the rays meets anything at all

  /// Where a ray crosses the plane, or its origin if that lies behind.
  RayPoint on(const Ray& ray) const {
    const int32_t way = at * Q8::kOne - sign * ray.origin[axis].raw;
    return sign == 0 || way <= 0 ? RayPoint{0, 1} : RayPoint{way, Q8::kOne * sign * ray.direction[axis]};
  }
};

/// Looks from a camera into the world of a map.
class Beams {
 public:
  Beams(const Camera& camera, const RayMap& map);

  /// Looks along the rays of some pixels, in steps of 16 voxels, or where something is of 4. `more` was found for these
  /// pixels and others.
  FirstPlane first_plane(const PixelBox& pixels, const FirstPlane& more = {}) const;

 private:
  using Vec3d = Vec3<double>;

  const RayMap& map_;
  bool is_perspective_;
  Vec3d eye_;        // in voxels
  Vec3d direction_;  // parallel
  Vec3d base_;       // Camera::Affine
  Vec3d step_x_;
  Vec3d step_y_;
};

}  // namespace thimble::wide
