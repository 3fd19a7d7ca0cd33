// The paper's depth cue: what is farther away is darker.
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

void cue_depth(const Frame& frame, const Meeting& meeting, Weight* weight) {
  if (!meeting.found) {
    return;
  }
  Shading depth;
  depth.near_q8 = frame.shading.near_q8;
  depth.far_q8 = frame.shading.far_q8;
  Hit hit = meeting.hit;  // of a boundary of water only t is set
  hit.kind = HitKind::kHit;
  const uint32_t brightness = shade(hit, Ray{}, frame.camera, depth).r;
  for (uint16_t& channel : weight->c) {
    channel = static_cast<uint16_t>(channel * brightness / 255);
  }
}

}  // namespace thimble::lit
