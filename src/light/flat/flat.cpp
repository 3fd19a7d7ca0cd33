// Chooses the lit frames by bricks of a set, and holds their specialisations.
#include "../../tree/deep_map.h"
#include "flat_frame.h"

namespace thimble::lit {

bool draws_flat(const Frame& frame, const BrickMap& map) {
  // Notes of pixels in water have no bits for voxels of level 9 and 10.
  const bool is_wide = DeepMap::is_deep(map.level()) && (frame.effects & Effect::kWater) != 0;
  if (is_wide || frame.options.max_visits != UINT32_MAX || !draws_fast(map, frame.camera)) {
    return false;
  }
  size_t suns = 0;
  for (const Light& light : frame.scene.lights) {
    if (light.is_point && (frame.effects & kLamps) == 0) {
      return false;
    }
    suns += light.is_point ? 0 : 1;
  }
  return suns <= kMaxFlatSuns;
}

#define THIMBLE_DRAW_FLAT(set) \
  template Status draw_flat<set>(Frame&, const BrickMap&, Span<const SunBricks>, const Band&, LitCounts*);
#if defined(THIMBLE_FLAT_WITHIN)  // render_lit_band_within<THIMBLE_FLAT_WITHIN> (map_render.h)
THIMBLE_DRAW_FLAT(kFlatWithin<THIMBLE_FLAT_WITHIN>)
THIMBLE_DRAW_FLAT(kFlatWithin<THIMBLE_FLAT_WITHIN> | kLamps)
#if (THIMBLE_FLAT_WITHIN & 0x80) != 0
THIMBLE_DRAW_FLAT(0x428B)
#endif
// A firmware image draws by the set of its scene, and compiles sooner without the others.
#elif defined(THIMBLE_FLAT_EFFECTS)
THIMBLE_FLAT_SUNS(THIMBLE_DRAW_FLAT)
#if (THIMBLE_FLAT_EFFECTS & 0x94) != 0 || THIMBLE_FLAT_LAMPS != 0
constexpr EffectSet kMoving = THIMBLE_FLAT_EFFECTS & ~(Effect::kEdges | kLamps);
constexpr EffectSet kLit =
    kMoving | (THIMBLE_FLAT_LAMPS != 0 && takes_lamps(kMoving) ? kLamps : Effect::kNone);
constexpr bool kSendsRays =
    (kLit & (Effect::kAmbientOcclusion | Effect::kMirror | Effect::kWater | kLamps)) != 0;
THIMBLE_DRAW_FLAT(is_flat(kLit) && kSendsRays ? flat_specialisation(kLit) : 0x013)
#endif
#else
THIMBLE_FLAT_SETS(THIMBLE_DRAW_FLAT)
#endif

}  // namespace thimble::lit
