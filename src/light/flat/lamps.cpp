// Lit frames by bricks with lamps.
#include "flat_frame.h"

namespace thimble::lit {

template <>
Status draw_flat<0x1003>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x1003>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x100B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x100B>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x1203>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x1203>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x120B>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x120B>(frame, map, suns, band, counts);
}

}  // namespace thimble::lit
