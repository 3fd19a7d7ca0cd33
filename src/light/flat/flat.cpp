// Chooses the lit frames by bricks of a set, and holds their specialisations.
#include "../../tree/deep_map.h"
#include "flat_frame.h"

namespace thimble::lit {

bool draws_flat(const Frame& frame, const BrickMap& map) {
  if constexpr (kDeepWorlds) {
    if (DeepMap::is_deep(map.level())) {
      return false;
    }
  }
  if (frame.options.max_visits != UINT32_MAX || !draws_fast(map, frame.camera)) {
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
#ifdef THIMBLE_FLAT_SUNS_ALONE  // the image sends no others, and compiles sooner
THIMBLE_FLAT_SUNS(THIMBLE_DRAW_FLAT)
#else
THIMBLE_FLAT_SETS(THIMBLE_DRAW_FLAT)
#endif

}  // namespace thimble::lit
