#include "lit_instances.h"

namespace thimble {
namespace lit {

Status draw_opaque(const Frame& frame, const Band& band, LitCounts* counts) {
  return (frame.effects & kMirror) != 0 ? draw_instance<kMirror>(frame, band, counts)
                                        : draw_instance<kNoEffects>(frame, band, counts);
}

}  // namespace lit

Status render_lit_band(EffectSet effects, const CompactTree& tree, const Camera& camera,
                       const Shading& shading, const LitScene& scene, const Band& band, LitCounts* counts,
                       const LitOptions& options) {
  effects &= kAllEffects;
  if (effects == kNoEffects) {
    return lit::draw_plain(tree, camera, shading, band, counts, options);
  }
  const lit::Frame frame{tree, camera, shading, scene, options, effects};
  const bool clear = (effects & (kGlass | kMedia)) != 0;
  if ((effects & kWater) != 0) {
    return clear ? lit::draw_wet_clear(frame, band, counts) : lit::draw_wet(frame, band, counts);
  }
  return clear ? lit::draw_clear(frame, band, counts) : lit::draw_opaque(frame, band, counts);
}

}  // namespace thimble
