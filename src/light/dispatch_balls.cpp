// The same 32 renderers as in dispatch.cpp, with balls.
#include "dispatch.h"
#include "thimble/light/render.h"

namespace thimble {

Status render_lit_band(EffectSet effects, const CompactTree& tree, const DrawnBalls& drawn,
                       const Camera& camera, const Shading& shading, const LitScene& scene, const Band& band,
                       LitCounts* counts, const LitOptions& options) {
  effects &= Effect::kAll;
  if (effects == Effect::kNone) {
    return lit::draw_plain(tree, camera, shading, band, counts, options);
  }
  const Status status = lit::check_balls(drawn, tree.level());
  if (status != Status::kOk) {
    return status;
  }
  return lit::choose_renderer(lit::BallFrame({tree, camera, shading, scene, options, effects}, drawn), band,
                              counts);
}

}  // namespace thimble
