// The lit renderers that the library holds: one for each choice of the effects that trace rays of their own,
// spread over a few files to keep each quick to compile. Internal to src/.
#ifndef THIMBLE_SRC_LIGHT_INSTANCES_H
#define THIMBLE_SRC_LIGHT_INSTANCES_H

#include "thimble/light/render.h"

namespace thimble::lit {

// In all of them; a test a ray where they are off.
inline constexpr EffectSet kFolded =
    Effect::kDirectLight | Effect::kEmission | Effect::kFog | Effect::kSky | Effect::kDepthCue;

// By the effects besides: without and with Effect::kShadows and Effect::kAmbientOcclusion.
template <EffectSet kBesides>
Status draw_instance(const Frame& frame, const Band& band, LitCounts* counts) {
  switch (frame.effects & (Effect::kShadows | Effect::kAmbientOcclusion)) {
    case Effect::kShadows:
      return draw<kBesides | kFolded | Effect::kShadows>(frame, band, counts);
    case Effect::kAmbientOcclusion:
      return draw<kBesides | kFolded | Effect::kAmbientOcclusion>(frame, band, counts);
    case Effect::kShadows | Effect::kAmbientOcclusion:
      return draw<kBesides | kFolded | Effect::kShadows | Effect::kAmbientOcclusion>(frame, band, counts);
    default:
      return draw<kBesides | kFolded>(frame, band, counts);
  }
}

// These without Effect::kMirror or with it.
Status draw_opaque(const Frame& frame, const Band& band, LitCounts* counts);
Status draw_clear(const Frame& frame, const Band& band, LitCounts* counts);
Status draw_wet(const Frame& frame, const Band& band, LitCounts* counts);
Status draw_wet_clear(const Frame& frame, const Band& band, LitCounts* counts);

}  // namespace thimble::lit

#endif
