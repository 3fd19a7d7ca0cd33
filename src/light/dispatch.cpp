// The lit renderers that the library holds, 32 of them: one for each choice of the effects that trace rays of
// their own. The others are in all of them, and cost a test a ray where they are off.
#include "folded.h"
#include "thimble/light/render.h"

namespace thimble {
namespace lit {
namespace {

// With or without each of the effects that are left to choose.
template <EffectSet kChosen>
Status choose_surroundings(const Frame& frame, const Band& band, LitCounts* counts) {
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

// Not inlined: the frame of all renderers together would be larger than that of each.
template <EffectSet kChosen>
[[gnu::noinline]] Status choose_mirror(const Frame& frame, const Band& band, LitCounts* counts) {
  return (frame.effects & Effect::kMirror) != 0
             ? choose_surroundings<kChosen | Effect::kMirror>(frame, band, counts)
             : choose_surroundings<kChosen>(frame, band, counts);
}

template <EffectSet kChosen>
Status choose_clear(const Frame& frame, const Band& band, LitCounts* counts) {
  constexpr EffectSet kClear = Effect::kGlass | Effect::kMedia;
  return (frame.effects & kClear) != 0 ? choose_mirror<kChosen | kClear>(frame, band, counts)
                                       : choose_mirror<kChosen>(frame, band, counts);
}

}  // namespace
}  // namespace lit

Status render_lit_band(EffectSet effects, const CompactTree& tree, const Camera& camera,
                       const Shading& shading, const LitScene& scene, const Band& band, LitCounts* counts,
                       const LitOptions& options) {
  effects &= Effect::kAll;
  if (effects == Effect::kNone) {
    return lit::draw_plain(tree, camera, shading, band, counts, options);
  }
  const lit::Frame frame{tree, camera, shading, scene, options, effects};
  return (effects & Effect::kWater) != 0
             ? lit::choose_clear<lit::kFolded | Effect::kWater>(frame, band, counts)
             : lit::choose_clear<lit::kFolded>(frame, band, counts);
}

}  // namespace thimble
