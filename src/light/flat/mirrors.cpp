// Lit frames by bricks with mirrors.
#include "flat_frame.h"

namespace thimble::lit {

template <>
Status draw_flat<0x013>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x013>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x01B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x01B>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x213>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x213>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x21B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x21B>(frame, map, suns, band, counts);
}

}  // namespace thimble::lit
