// What a metal makes of a ray that meets it. Internal to src/.
#ifndef THIMBLE_SRC_LIGHT_METAL_H
#define THIMBLE_SRC_LIGHT_METAL_H

#include "arithmetic.h"
#include "thimble/light/detail/pixel.h"
#include "thimble/light/host/optics.h"

namespace thimble::lit {

/// Whether it mirrors any light.
constexpr bool is_mirror(const Surface& metal) {
  return metal.kind == SurfaceKind::kMetal && metal.mirror != 0;
}

/// Divides a ray's weight into what the metal mirrors and what it shows of itself. `cosine`: of the ray, Q14.
[[gnu::always_inline]] inline void divide_weight(const Surface& metal, int32_t cosine, Weight* own,
                                                 Weight* mirrored) {
  const uint32_t share = metal.mirror * 257U;  // 65535 = all
  for (int i = 0; i < 3; ++i) {
    const uint32_t reflected = fresnel_q16(cosine, channel_of(metal.albedo, i) * 257U);
    mirrored->c[i] = weighed(weighed(own->c[i], reflected), share + share / 65535);
    own->c[i] = weighed(own->c[i], 65535 - share);
  }
}

/// The direction of ray `number` of a rough metal, of what a smooth one would mirror at a face of `axis`.
[[gnu::always_inline]] inline Vec3i spread(const Vec3i& mirrored, const Surface& metal, int axis,
                                           bool towards_smaller, int number) {
  Vec3i direction = shorten(roughen(unit_q14(mirrored), metal.roughness, number));
  if (!leaves_face(direction, axis, towards_smaller)) {
    direction = reflect(direction, axis);  // back from the face
  }
  return direction;
}

}  // namespace thimble::lit

#endif
