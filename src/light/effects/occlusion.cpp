// Ambient occlusion: how much of the hemisphere above a face is open. A fixed pattern of rays; what is met
// darkens the less the farther away it is, so that no edge of a layer shows.
#include "../arithmetic.h"
#include "../queries.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {
namespace {

template <class AnyFrame>
void occlude_face(AnyFrame& frame, const Spot& spot, Color* light) {
  const Occlusion& occlusion = frame.scene.occlusion;
  const int rays = occlusion_rays(occlusion);
  if (rays == 0 || occlusion.reach == 0) {
    return;
  }
  uint32_t open = 0;
  for (int i = 0; i < rays; ++i) {
    const Ray ray{spot.at, occlusion_direction(i, spot.face.axis, spot.face.negative)};
    count_ray(frame, LitRayKind::kOcclusion);
    Hit hit;
    find_before(
        frame, LitRayKind::kOcclusion, ray,
        [&] {
          return RayPoint{occlusion.reach, kOcclusionLength};
        },
        &hit);
    uint32_t share = kOpenShare;
    if (is_opaque(frame, hit)) {
      // A face is only entered along its axis; inside a voxel t is 0, whatever it is divided by.
      const uint32_t along = hit.axis < 0 ? 0 : magnitude_32(ray.direction[hit.axis]);
      const uint32_t component = along == 0 ? 1 : along;
      share = share_of_way(occlusion, static_cast<uint32_t>(hit.t_numerator), component);
    }
    open += share;
  }
  darken(occlusion, open, rays, light);
}

}  // namespace

void occlude(Frame& frame, const Spot& spot, Color* light) {
  occlude_face(frame, spot, light);
}
void occlude(AskedFrame& frame, const Spot& spot, Color* light) {
  occlude_face(frame, spot, light);
}
void occlude(BallFrame& frame, const Spot& spot, Color* light) {
  occlude_face(frame, spot, light);
}

}  // namespace thimble::lit
