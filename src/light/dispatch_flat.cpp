// Lit frames through the map by a set that is known only when the program runs.
#include "thimble/light/map_render.h"

namespace thimble {

namespace lit {
namespace {

Status draw_flat_set(Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                     LitCounts* counts) {
  switch (flat_specialisation(frame.effects)) {
#define THIMBLE_CASE(set) \
  case set:               \
    return draw_flat<set>(frame, map, suns, band, counts);
    THIMBLE_FLAT_SETS(THIMBLE_CASE)
#undef THIMBLE_CASE
    default:
      return Status::kBadArgument;
  }
}

}  // namespace
}  // namespace lit

Status render_lit_band(EffectSet effects, const CompactTree& tree, const BrickMap& map, const Camera& camera,
                       const Shading& shading, const LitScene& scene, Span<const SunBricks> suns,
                       const Band& band, LitCounts* counts, const LitOptions& options) {
  if (!map.belongs_to(tree)) {
    return Status::kDamaged;
  }
  effects &= Effect::kAll;
  if (is_flat(effects)) {
    EffectSet set = effects & ~lit::kLamps;
    for (const Light& light : scene.lights) {
      set |= light.is_point && takes_lamps(effects) ? lit::kLamps : Effect::kNone;
    }
    lit::Frame frame{tree, camera, shading, scene, options, set};
    if (lit::draws_flat(frame, map)) {
      return lit::draw_flat_set(frame, map, suns, band, counts);
    }
  }
  return render_lit_band(effects, tree, camera, shading, scene, band, counts, options);
}

}  // namespace thimble
