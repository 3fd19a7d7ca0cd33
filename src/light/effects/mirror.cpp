// Metals: what they mirror takes on their colour, and less of it the flatter it comes in (Schlick). A rough
// one spreads what the camera sees in it over four rays.
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

void send_mirrored(Frame& frame, PendingRay* now, const Spot& spot, PendingRay* pending, size_t* count) {
  const Surface& metal = spot.surface;
  if (metal.kind != SurfaceKind::kMetal || metal.mirror == 0 || spot.inside ||
      now->bounces >= frame.scene.bounces) {
    return;
  }
  const int axis = spot.face.axis;
  const int32_t cosine = static_cast<int32_t>(cosine_q14(spot.arriving, axis));
  Weight mirrored;
  const uint32_t share = metal.mirror * 257U;  // 65535 = all
  for (int i = 0; i < 3; ++i) {
    const uint32_t reflected = fresnel_q16(cosine, channel_of(metal.albedo, i) * 257U);
    mirrored.c[i] = weighed(weighed(now->weight.c[i], reflected), share + share / 65535);
    now->weight.c[i] = weighed(now->weight.c[i], 65535 - share);
  }
  PendingRay out;
  out.bounces = static_cast<uint8_t>(now->bounces + 1);
  out.kind = LitRayKind::kMirrorRay;
  out.axis = static_cast<int8_t>(axis);
  const bool rough = metal.roughness != 0 && now->bounces == 0;
  for (int i = 0; i < (rough ? kRoughnessRays : 1); ++i) {
    out.ray = {spot.at, reflect(spot.arriving, axis)};
    out.weight = mirrored;
    if (rough) {
      Vec3i direction = shorten(roughen(unit_q14(out.ray.direction), metal.roughness, i));
      if (!leaves_face(direction, axis, spot.face.negative)) {
        direction = reflect(direction, axis);  // back from the face
      }
      out.ray.direction = direction;
      for (uint16_t& channel : out.weight.c) {
        channel = static_cast<uint16_t>(channel / kRoughnessRays);
      }
    }
    if (is_seen(out.weight) && leaves_face(out.ray.direction, axis, spot.face.negative)) {
      count_ray(frame, LitRayKind::kMirrorRay);
      pending[(*count)++] = out;
    }
  }
}

}  // namespace thimble::lit
