// Direct light: from which side, how bright, how far. Lambert's cosine law.
#include "../arithmetic.h"

namespace thimble::lit {

bool light_ray(const Light& light, const Spot& spot, LightRay* ray) {
  const int axis = spot.face.axis;
  if (!aim_at(light, spot.at, ray) || !leaves_face(ray->ray.direction, axis, spot.face.negative)) {
    return false;
  }
  uint32_t share_q16 = UINT16_MAX;
  uint32_t cosine = 0;
  if (light.is_point) {
    const int32_t distance =
        distance_q8(ray->ray.direction, ray->place.t_numerator, ray->place.t_denominator, axis, &cosine);
    share_q16 = falloff_q16(static_cast<uint32_t>(distance), light.reach);
  } else {
    cosine = cosine_q14(ray->ray.direction, axis);
  }
  return set_brightness(light, (share_q16 * cosine) >> 14, ray);
}

void add_light(const LightRay& ray, Color* light) {
  for (int i = 0; i < 3; ++i) {
    light->c[i] += ray.brightness[i];  // at most 100 of 2^20
  }
}

}  // namespace thimble::lit
