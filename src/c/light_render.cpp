// Lit bands for C. A C program cannot choose a renderer by a template's argument, so it does when this file
// is compiled: with THIMBLE_C_EFFECTS=SET it holds the renderer for that set, without, those of all.
#include "picture.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"

namespace thimble::c_face {
namespace {

#ifdef THIMBLE_C_EFFECTS
// These decide how rays are followed, and are compiled in or not. The others are tested at each ray.
constexpr EffectSet kTraced = Effect::kShadows | Effect::kAmbientOcclusion | Effect::kMirror |
                              Effect::kGlass | Effect::kMedia | Effect::kWater;
constexpr EffectSet kSet = THIMBLE_C_EFFECTS;
static_assert((kSet & ~Effect::kAll) == 0, "THIMBLE_C_EFFECTS names an effect that does not exist");

Status draw_lit(EffectSet effects, const CompactTree& tree, const Camera& camera, const Shading& shading,
                const LitScene& scene, const Band& band) {
  if constexpr (kSet == Effect::kNone) {
    return effects == kSet ? render_lit_band<kSet>(tree, camera, shading, scene, band) : Status::kOutOfRange;
  } else {
    if (effects == 0 || (effects & ~kSet) != 0 || ((effects ^ kSet) & kTraced) != 0) {
      return Status::kOutOfRange;
    }
    return lit::draw<kSet>({tree, camera, shading, scene, LitOptions{}, effects}, band, nullptr);
  }
}
#else
Status draw_lit(EffectSet effects, const CompactTree& tree, const Camera& camera, const Shading& shading,
                const LitScene& scene, const Band& band) {
  return render_lit_band(effects, tree, camera, shading, scene, band);
}
#endif

}  // namespace

extern "C" int32_t thimble_scene_render_lit(const thimble_scene_t* scene, const thimble_light_t* light,
                                            uint32_t effects, const thimble_camera_t* camera,
                                            const thimble_shading_t* shading, const thimble_band_t* band) {
  const BakedScene* const from = held<BakedScene>(scene);
  const BakedLighting* const opened = held<BakedLighting>(light);
  if (from == nullptr || opened == nullptr) {
    return number(Status::kBadArgument);
  }
  return draw_band(camera, shading, band, [&](const Camera& view, const Shading& look, const Band& rows) {
    return draw_lit(effects & Effect::kAll, from->tree(), view, look, opened->scene, rows);
  });
}

}  // namespace thimble::c_face
