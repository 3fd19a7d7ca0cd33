/// @file render.h
/// Lit pictures: light, shadows, mirrors, glass, water, air. Only what the set of effects names is in the
/// code, in the state of a ray, and in the time.
///
/// The set is a constant when compiling. `render_lit_band<Effect::kDirectLight | Effect::kShadows>` is a
/// renderer that has never heard of glass: the linker finds nothing of it to keep. With `Effect::kNone` it is
/// `render_band`. A program that learns of its scene only when it runs calls the function with the set as an
/// argument, which picks one of the renderers that the library holds (dispatch.cpp: 32, by the effects that
/// trace rays; a firmware image that does not call it has none of them).
///
/// A pixel is a function of tree, camera, shading, scene and set alone, in integers: bands of any height, in
/// any order, on any machine give the same picture. `Shading::mode` is not looked at (a lit picture shows
/// colours); its palette serves materials that `LitScene::surfaces` does not reach, its `face_light` scenes
/// without Effect::kDirectLight, its near and far planes Effect::kDepthCue.
///
/// What is computed
///   - a face has  albedo * (ambient * occlusion + sum of the lights that reach it) + emission;
///   - a secondary ray starts on the face (secondary_ray.h) and is traced by the law of ray.h: shadows have
///     no acne and no leaks, and the reference of the tests traces the same rays;
///   - a mirror or a clear boundary splits the ray in at most two, four at the first rough metal; what weighs
///     less than 1/256 is dropped; after `LitScene::bounces` a metal shows its plain lit colour, and a clear
///     boundary lets the ray go straight on;
///   - what is clear on both sides with one index, and all media, are passed by the very same ray; where
///     there is water, by one that begins anew on the face, to 1/256 voxel.
#ifndef THIMBLE_LIGHT_RENDER_H
#define THIMBLE_LIGHT_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "../base/status.h"
#include "../picture/camera.h"
#include "../picture/render.h"
#include "../picture/shading.h"
#include "../tree/compact_tree.h"
#include "detail/pixel.h"
#include "scene.h"

namespace thimble {

/// What a renderer for `effects` keeps: scene, camera, shading, counters, and the rays of a pixel that are
/// still to be followed, which are on the stack. No effect, no byte for it.
constexpr size_t lit_render_bytes(EffectSet effects) {
  if (effects == Effect::kNone) {
    return render_bytes();
  }
  return sizeof(Camera) + sizeof(Shading) + sizeof(LitScene) + sizeof(LitCounts) +
         lit::pending_rays(effects) * sizeof(lit::PendingRay);
}

/// Draws the band with exactly the effects of the set. `counts` (may be null) is added to.
/// Errors, with nothing drawn: those of `render_band`; kOutOfRange for more than kMaxLights lights or
/// kMaxSurfaces surfaces.
/// Inlined always: with Effect::kNone and no counts it is the call of `render_band`, to the byte.
template <EffectSet kEffects>
[[gnu::always_inline]] inline Status render_lit_band(const CompactTree& tree, const Camera& camera,
                                                     const Shading& shading, const LitScene& scene,
                                                     const Band& band, LitCounts* counts = nullptr,
                                                     const LitOptions& options = {}) {
  if constexpr (kEffects == Effect::kNone) {
    if (counts == nullptr) {
      return render_band(tree, camera, shading, band, nullptr, {options.max_visits, Width::kAuto});
    }
    return lit::draw_plain(tree, camera, shading, band, counts, options);
  } else {
    return lit::draw<kEffects>({tree, camera, shading, scene, options, kEffects}, band, counts);
  }
}

/// The same with a set that is known only now: code with exactly these effects where they trace rays
/// (Effect::kMedia counts as Effect::kGlass there); Effect::kDirectLight, Effect::kEmission, Effect::kFog,
/// Effect::kSky and Effect::kDepthCue cost one test each a ray where the set does not name them.
Status render_lit_band(EffectSet effects, const CompactTree& tree, const Camera& camera,
                       const Shading& shading, const LitScene& scene, const Band& band,
                       LitCounts* counts = nullptr, const LitOptions& options = {});

}  // namespace thimble

#endif
