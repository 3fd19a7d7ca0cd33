// Picks the renderer for a set of effects that is known only now: one for each choice of those that trace rays of their
// own. Internal to src/.
#pragma once

#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

/// Compiled into each of them: effects that trace no rays of their own, and cost a test a ray where they are off.
inline constexpr EffectSet kAlwaysCompiled = Effect::kDirectLight | Effect::kEmission | Effect::kFog |
                                             Effect::kSky | Effect::kDepthCue | Effect::kSmoothNormals |
                                             Effect::kEdges | Effect::kRipples;

/// With or without each of the effects that are left to choose.
template <EffectSet kChosen, class AnyFrame>
Status choose_surroundings(const AnyFrame& frame, const Band& band, LitCounts* counts) {
  switch (frame.effects & (Effect::kShadows | Effect::kAmbientOcclusion)) {
    case Effect::kShadows:
      return draw<kChosen | Effect::kShadows>(frame, band, counts);
    case Effect::kAmbientOcclusion:
      return draw<kChosen | Effect::kAmbientOcclusion>(frame, band, counts);
    case Effect::kShadows | Effect::kAmbientOcclusion:
      return draw<kChosen | Effect::kShadows | Effect::kAmbientOcclusion>(frame, band, counts);
    default:
      return draw<kChosen>(frame, band, counts);
  }
}

/// Not inlined: the frame of all renderers together would be larger than that of each.
template <EffectSet kChosen, class AnyFrame>
[[gnu::noinline]] Status choose_mirror(const AnyFrame& frame, const Band& band, LitCounts* counts) {
  return (frame.effects & Effect::kMirror) != 0
             ? choose_surroundings<kChosen | Effect::kMirror>(frame, band, counts)
             : choose_surroundings<kChosen>(frame, band, counts);
}

template <EffectSet kChosen, class AnyFrame>
Status choose_clear(const AnyFrame& frame, const Band& band, LitCounts* counts) {
  constexpr EffectSet kClear = Effect::kGlass | Effect::kMedia;
  return (frame.effects & kClear) != 0 ? choose_mirror<kChosen | kClear>(frame, band, counts)
                                       : choose_mirror<kChosen>(frame, band, counts);
}

template <class AnyFrame>
Status choose_renderer(const AnyFrame& frame, const Band& band, LitCounts* counts) {
  return (frame.effects & Effect::kWater) != 0
             ? choose_clear<kAlwaysCompiled | Effect::kWater>(frame, band, counts)
             : choose_clear<kAlwaysCompiled>(frame, band, counts);
}

}  // namespace thimble::lit
