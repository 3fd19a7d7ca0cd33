// The lit renderers that the library holds: one for each choice of the effects that trace rays of their own,
// spread over a few files to keep each quick to compile. Internal to src/.
#ifndef THIMBLE_SRC_LIT_INSTANCES_H
#define THIMBLE_SRC_LIT_INSTANCES_H

#include "thimble/lit_render.h"

namespace thimble::lit {

// In all of them; a test a ray where they are off.
inline constexpr EffectSet kFolded = kDirectLight | kEmission | kFog | kSky | kDepthCue;

// By the effects besides: without and with kShadows and kAmbientOcclusion.
template <EffectSet kBesides>
Status draw_instance(const Frame& frame, const Band& band, LitCounts* counts) {
  switch (frame.effects & (kShadows | kAmbientOcclusion)) {
    case kShadows:
      return draw<kBesides | kFolded | kShadows>(frame, band, counts);
    case kAmbientOcclusion:
      return draw<kBesides | kFolded | kAmbientOcclusion>(frame, band, counts);
    case kShadows | kAmbientOcclusion:
      return draw<kBesides | kFolded | kShadows | kAmbientOcclusion>(frame, band, counts);
    default:
      return draw<kBesides | kFolded>(frame, band, counts);
  }
}

// These without kMirror or with it.
Status draw_opaque(const Frame& frame, const Band& band, LitCounts* counts);
Status draw_clear(const Frame& frame, const Band& band, LitCounts* counts);
Status draw_wet(const Frame& frame, const Band& band, LitCounts* counts);
Status draw_wet_clear(const Frame& frame, const Band& band, LitCounts* counts);

}  // namespace thimble::lit

#endif
