// Hard shadows: whether something solid is between a spot and a light. Exact, since the ray starts on the
// face: the reference of the tests traces the same one.
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

bool light_arrives(Frame& frame, const LightRay& light) {
  count_ray(frame, LitRayKind::kShadow);
  if (!light.is_point) {
    HitKind kind = HitKind::kMiss;
    uint32_t visits = 0;
    if (any_hit(frame.tree, light.ray, &kind, &visits, {frame.options.max_visits, Width::kAuto}) !=
        Status::kOk) {
      return true;
    }
    count_result(frame, LitRayKind::kShadow, kind, visits);
    return kind != HitKind::kHit;
  }
  Hit hit;
  find_solid(frame, LitRayKind::kShadow, light.ray, &hit);
  return hit.kind != HitKind::kHit || spares_light(frame, light, hit);
}

}  // namespace thimble::lit
