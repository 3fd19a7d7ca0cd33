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
  const bool rough = is_spread(metal, *now, &mirrored);
  for (int i = 0; i < (rough ? kRoughnessRays : 1); ++i) {
    Ray ray{spot.at, reflect(spot.arriving, axis)};
    if (rough) {
      ray.direction = spread(ray.direction, metal, axis, spot.face.negative, i);
    }
    if (leaves_face(ray.direction, axis, spot.face.negative)) {
      send(frame, *now, LitRayKind::kMirrorRay, axis, ray, mirrored, pending, count);
    }
  }
}

}  // namespace thimble::lit
