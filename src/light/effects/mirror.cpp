// Metals: what they mirror takes on their colour, and less of it the flatter it comes in (Schlick). A rough
// one spreads what the camera sees in it over four rays.
#include "../arithmetic.h"

namespace thimble::lit {

void send_mirrored(Frame& frame, PendingRay* now, const Spot& spot, PendingRay* pending, size_t* count) {
  const Surface& metal = spot.surface;
  if (!is_mirror(metal) || spot.inside || now->bounces >= frame.scene.bounces) {
    return;
  }
  const int axis = spot.face.axis;
  Weight mirrored;
  divide_weight(metal, static_cast<int32_t>(cosine_q14(spot.arriving, axis)), &now->weight, &mirrored);
  PendingRay out;
  out.bounces = static_cast<uint8_t>(now->bounces + 1);
  out.kind = LitRayKind::kMirrorRay;
  out.axis = static_cast<int8_t>(axis);
  const bool rough = metal.roughness != 0 && now->bounces == 0;
  for (int i = 0; i < (rough ? kRoughnessRays : 1); ++i) {
    out.ray = {spot.at, reflect(spot.arriving, axis)};
    out.weight = mirrored;
    if (rough) {
      out.ray.direction = spread(out.ray.direction, metal, axis, spot.face.negative, i);
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
