// Picks the renderer for a set of effects that is known only now: one for each choice of those that trace rays of their
// own. Internal to src/.
#pragma once

#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

/// Compiled into each of them: effects that trace no rays of their own, and cost a test a ray where they are off.
inline constexpr EffectSet kAlwaysCompiled = Effect::kDirectLight | Effect::kEmission | Effect::kFog |
                                             Effect::kSky | Effect::kDepthCue | Effect::kSmoothNormals |
                                             Effect::kEdges | Effect::kRipples;

/// With or without each of the effects that are left to choose. Not inlined: the frame of all renderers together would be
/// larger than that of each.
template <EffectSet kChosen, EffectSet kEffect, EffectSet... kLeft, class AnyFrame>
[[gnu::noinline]] Status draw_chosen(const AnyFrame& frame, const Band& band, LitCounts* counts) {
  constexpr EffectSet kWith = kChosen | kEffect;
  const bool is_on = (frame.effects & kEffect) != 0;
  if constexpr (sizeof...(kLeft) == 0) {
    return is_on ? draw<kWith>(frame, band, counts) : draw<kChosen>(frame, band, counts);
  } else {
    return is_on ? draw_chosen<kWith, kLeft...>(frame, band, counts)
                 : draw_chosen<kChosen, kLeft...>(frame, band, counts);
  }
}

template <class AnyFrame>
Status choose_renderer(const AnyFrame& frame, const Band& band, LitCounts* counts) {
  return draw_chosen<kAlwaysCompiled, Effect::kWater, Effect::kGlass | Effect::kMedia, Effect::kMirror,
                     Effect::kShadows, Effect::kAmbientOcclusion>(frame, band, counts);
}

}  // namespace thimble::lit
