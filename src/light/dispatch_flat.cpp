// Lit frames through the map by a set that is known only when the program runs.
#include "thimble/light/map_render.h"

namespace thimble {

namespace lit {
namespace {

Status draw_flat_set(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                     LitCounts* counts) {
  switch (frame.effects) {
    case 0x001:
      return draw_flat<0x001>(frame, map, suns, band, counts);
    case 0x003:
      return draw_flat<0x003>(frame, map, suns, band, counts);
    case 0x007:
      return draw_flat<0x007>(frame, map, suns, band, counts);
    case 0x00B:
      return draw_flat<0x00B>(frame, map, suns, band, counts);
    case 0x00F:
      return draw_flat<0x00F>(frame, map, suns, band, counts);
    case 0x203:
      return draw_flat<0x203>(frame, map, suns, band, counts);
    case 0x207:
      return draw_flat<0x207>(frame, map, suns, band, counts);
    case 0x20B:
      return draw_flat<0x20B>(frame, map, suns, band, counts);
    case 0x20F:
      return draw_flat<0x20F>(frame, map, suns, band, counts);
    case 0x1003:
      return draw_flat<0x1003>(frame, map, suns, band, counts);
    case 0x1007:
      return draw_flat<0x1007>(frame, map, suns, band, counts);
    case 0x100B:
      return draw_flat<0x100B>(frame, map, suns, band, counts);
    case 0x100F:
      return draw_flat<0x100F>(frame, map, suns, band, counts);
    case 0x1203:
      return draw_flat<0x1203>(frame, map, suns, band, counts);
    case 0x1207:
      return draw_flat<0x1207>(frame, map, suns, band, counts);
    case 0x120B:
      return draw_flat<0x120B>(frame, map, suns, band, counts);
    case 0x120F:
      return draw_flat<0x120F>(frame, map, suns, band, counts);
    case 0x013:
      return draw_flat<0x013>(frame, map, suns, band, counts);
    case 0x01B:
      return draw_flat<0x01B>(frame, map, suns, band, counts);
    case 0x213:
      return draw_flat<0x213>(frame, map, suns, band, counts);
    case 0x21B:
      return draw_flat<0x21B>(frame, map, suns, band, counts);
    case 0x017:
      return draw_flat<0x017>(frame, map, suns, band, counts);
    case 0x01F:
      return draw_flat<0x01F>(frame, map, suns, band, counts);
    case 0x217:
      return draw_flat<0x217>(frame, map, suns, band, counts);
    case 0x21F:
      return draw_flat<0x21F>(frame, map, suns, band, counts);
    case 0x1013:
      return draw_flat<0x1013>(frame, map, suns, band, counts);
    case 0x101B:
      return draw_flat<0x101B>(frame, map, suns, band, counts);
    case 0x1213:
      return draw_flat<0x1213>(frame, map, suns, band, counts);
    case 0x121B:
      return draw_flat<0x121B>(frame, map, suns, band, counts);
    case 0x1017:
      return draw_flat<0x1017>(frame, map, suns, band, counts);
    case 0x101F:
      return draw_flat<0x101F>(frame, map, suns, band, counts);
    case 0x1217:
      return draw_flat<0x1217>(frame, map, suns, band, counts);
    case 0x121F:
      return draw_flat<0x121F>(frame, map, suns, band, counts);
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
      set |= light.is_point && (effects & Effect::kShadows) != 0 ? lit::kLamps : Effect::kNone;
    }
    const lit::Frame frame{tree, camera, shading, scene, options, set};
    if (lit::draws_flat(frame, map)) {
      return lit::draw_flat_set(frame, map, suns, band, counts);
    }
  }
  return render_lit_band(effects, tree, camera, shading, scene, band, counts, options);
}

}  // namespace thimble
