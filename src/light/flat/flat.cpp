// Chooses the lit frames by bricks of a set, and holds those of distant lights alone.
#include "flat_frame.h"

namespace thimble::lit {

bool draws_flat(const Frame& frame, const BrickMap& map) {
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

template <>
Status draw_flat<0x001>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x001>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x003>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x003>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x00B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x00B>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x203>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x203>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x20B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x20B>(frame, map, suns, band, counts);
}

}  // namespace thimble::lit
