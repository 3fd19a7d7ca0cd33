#include "instances.h"

namespace thimble {
namespace lit {

Status draw_opaque(const Frame& frame, const Band& band, LitCounts* counts) {
  return (frame.effects & Effect::kMirror) != 0 ? draw_instance<Effect::kMirror>(frame, band, counts)
                                                : draw_instance<Effect::kNone>(frame, band, counts);
}

}  // namespace lit

Status render_lit_band(EffectSet effects, const CompactTree& tree, const Camera& camera,
                       const Shading& shading, const LitScene& scene, const Band& band, LitCounts* counts,
                       const LitOptions& options) {
  effects &= Effect::kAll;
  if (effects == Effect::kNone) {
    return lit::draw_plain(tree, camera, shading, band, counts, options);
  }
  const lit::Frame frame{tree, camera, shading, scene, options, effects};
  const bool clear = (effects & (Effect::kGlass | Effect::kMedia)) != 0;
  if ((effects & Effect::kWater) != 0) {
    return clear ? lit::draw_wet_clear(frame, band, counts) : lit::draw_wet(frame, band, counts);
  }
  return clear ? lit::draw_clear(frame, band, counts) : lit::draw_opaque(frame, band, counts);
}

}  // namespace thimble
