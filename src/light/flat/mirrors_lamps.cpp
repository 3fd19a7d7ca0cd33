// Lit frames by bricks with mirrors and lamps.
#include "flat_frame.h"

namespace thimble::lit {

template <>
Status draw_flat<0x1013>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x1013>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x101B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x101B>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x1213>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x1213>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x121B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x121B>(frame, map, suns, band, counts);
}

}  // namespace thimble::lit
