// Direct light: from which side, how bright, how far. Lambert's cosine law.
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {
namespace {

// Bits of a direction to a light: what the 32-bit tracer takes in worlds of up to 64, seen from within.
constexpr int kLightBits = 15;

// Brightness of a point light at a distance: 1 / (1 + d / reach)^2, 2^16 = 1.
uint32_t falloff_q16(uint32_t distance, uint32_t reach) {
  if (reach == 0) {
    return 0;
  }
  const uint32_t ratio_q8 = 256 + distance / reach;
  return ratio_q8 > UINT16_MAX ? 0 : UINT32_MAX / (ratio_q8 * ratio_q8);
}

}  // namespace

bool light_ray(const Light& light, const Spot& spot, LightRay* ray) {
  uint32_t share_q16 = UINT16_MAX;
  ray->is_point = light.is_point;
  if (light.is_point) {
    const Vec3Q8 place{Q8::from_raw(light.place.x), Q8::from_raw(light.place.y), Q8::from_raw(light.place.z)};
    if (!ray_towards(spot.at, place, kLightBits, &ray->ray, &ray->place)) {
      return false;
    }
  } else {
    ray->ray = {spot.at, shorten(light.place)};
  }
  const int axis = spot.face.axis;
  if (!leaves_face(ray->ray.direction, axis, spot.face.negative)) {
    return false;
  }
  uint32_t cosine = 0;
  if (light.is_point) {
    const int32_t distance =
        distance_q8(ray->ray.direction, ray->place.t_numerator, ray->place.t_denominator, axis, &cosine);
    share_q16 = falloff_q16(static_cast<uint32_t>(distance), light.reach);
  } else {
    cosine = cosine_q14(ray->ray.direction, axis);
  }
  share_q16 = (share_q16 * cosine) >> 14;
  bool shines = false;
  for (int i = 0; i < 3; ++i) {
    ray->brightness[i] = (light.color_q8[i] * share_q16 + 2048) >> 12;  // 16 bits by 16
    shines = shines || ray->brightness[i] != 0;
  }
  return shines;
}

void add_light(const LightRay& ray, Color* light) {
  for (int i = 0; i < 3; ++i) {
    light->c[i] += ray.brightness[i];  // at most 100 of 2^20
  }
}

}  // namespace thimble::lit
