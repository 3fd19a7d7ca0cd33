// Hard shadows: whether something solid is between a spot and a light. Exact, since the ray starts on the
// face: the reference of the tests traces the same one.
#include "../arithmetic.h"
#include "../queries.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

namespace {

template <class AnyFrame>
[[gnu::always_inline]] inline bool arrives(AnyFrame& frame, const LightRay& light) {
  count_ray(frame, LitRayKind::kShadow);
  if (!light.is_point) {
    HitKind kind = HitKind::kMiss;
    uint32_t visits = 0;
    if (find_any(frame, light.ray, &kind, &visits) != Status::kOk) {
      return !AnyFrame::kIsAsked;  // refused; or not known yet, when nothing of the light is wanted
    }
    count_result(frame, LitRayKind::kShadow, kind, visits);
    return kind != HitKind::kHit;
  }
  Hit hit;
  find_before(
      frame, LitRayKind::kShadow, light.ray, [&] { return light.place; }, &hit);
  if constexpr (AnyFrame::kIsAsked) {
    if (!frame.is_answered()) {
      return false;
    }
  }
  return hit.kind != HitKind::kHit || spares_light(frame, light, hit);
}

}  // namespace

bool light_arrives(Frame& frame, const LightRay& light) {
  return arrives(frame, light);
}
bool light_arrives(AskedFrame& frame, const LightRay& light) {
  return arrives(frame, light);
}

}  // namespace thimble::lit
