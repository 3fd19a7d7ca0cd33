// Chooses the lit frames by bricks of a set, and holds those of distant lights alone.
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

THIMBLE_FLAT_SUNS(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
