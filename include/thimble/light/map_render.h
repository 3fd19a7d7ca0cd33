/// @file map_render.h
/// The pictures of render.h for chips that draw frames: a compact tree with a brick map beside it.
///
/// The pixels are those of `render_lit_band` for the tree, bit for bit, whatever the set, camera, scene and band. Where
/// the light of a pixel is a function of the face that it shows and of the distant lights that reach it (a set that
/// `is_flat`, at most kMaxFlatSuns lights, all of them distant, a camera that `draws_fast`, no limit of visits),
/// the camera's rays and those to the lights go through the map, and a face's colour is looked up; everything else is
/// drawn by the tree. An image has the first way only when its set allows it.
///
/// Cost of the fast way: platform/README.md, "Light on a chip". Stack: tests/budgets/stack.csv.
#ifndef THIMBLE_LIGHT_MAP_RENDER_H
#define THIMBLE_LIGHT_MAP_RENDER_H

#include <stddef.h>
#include <stdint.h>

#include "../picture/brick_render.h"
#include "../tree/brick_map.h"
#include "render.h"
#include "sun_bricks.h"

namespace thimble {

/// Whether a set has the fast way: direct light alone, or with shadows and any of emission and sky.
constexpr bool is_flat(EffectSet effects) {
  constexpr EffectSet kSun = Effect::kDirectLight | Effect::kShadows;
  effects &= ~Effect::kEmitterLight;
  return effects == Effect::kDirectLight || (effects & ~(Effect::kEmission | Effect::kSky)) == kSun;
}
/// Lights that the fast way takes.
inline constexpr size_t kMaxFlatSuns = 2;

namespace lit {

/// Whether the fast way takes the frame, whose set `is_flat`.
bool draws_flat(const Frame& frame, const BrickMap& map);
/// Draws the band where `draws_flat`. `suns` is of the lights, in their order; may be empty. What does not belong to its
/// light is not looked at.
template <EffectSet kSet>
Status draw_flat(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                 LitCounts* counts);
// flat.cpp has these, as functions of their own: the stack of an image is added up from their call graph.
template <>
Status draw_flat<0x001>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts);
template <>
Status draw_flat<0x003>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts);
template <>
Status draw_flat<0x00B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts);
template <>
Status draw_flat<0x203>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts);
template <>
Status draw_flat<0x20B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts);

}  // namespace lit

/// As `render_lit_band` (render.h) with `map`, which belongs to `tree`. `suns` (may be empty) has what is proven of
/// each light of the scene, in their order. Of the counters those of nodes stay as they are for rays that read none.
/// Errors, with nothing drawn: those of render.h, and kDamaged when the map is another tree's.
template <EffectSet kEffects>
[[gnu::always_inline]] inline Status render_lit_band(const CompactTree& tree, const BrickMap& map,
                                                     const Camera& camera, const Shading& shading,
                                                     const LitScene& scene, Span<const SunBricks> suns,
                                                     const Band& band, LitCounts* counts = nullptr,
                                                     const LitOptions& options = {}) {
  if (!map.belongs_to(tree)) {
    return Status::kDamaged;
  }
  if constexpr (is_flat(kEffects)) {
    constexpr EffectSet kSet = kEffects & ~Effect::kEmitterLight;
    const lit::Frame frame{tree, camera, shading, scene, options, kSet};
    if (lit::draws_flat(frame, map)) {
      return lit::draw_flat<kSet>(frame, map, suns, band, counts);
    }
  }
  return render_lit_band<kEffects>(tree, camera, shading, scene, band, counts, options);
}

}  // namespace thimble

#endif
