// The lit renderers that the library holds, 32 of them (dispatch.h).
#include "dispatch.h"
#include "thimble/light/render.h"

namespace thimble {

Status render_lit_band(EffectSet effects, const CompactTree& tree, const Camera& camera,
                       const Shading& shading, const LitScene& scene, const Band& band, LitCounts* counts,
                       const LitOptions& options) {
  effects &= Effect::kAll;
  if (effects == Effect::kNone) {
    return lit::draw_plain(tree, camera, shading, band, counts, options);
  }
  return lit::choose_renderer(lit::Frame{tree, camera, shading, scene, options, effects}, band, counts);
}

}  // namespace thimble
