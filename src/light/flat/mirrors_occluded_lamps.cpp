// Lit frames by bricks with mirrors, occlusion and lamps.
#include "flat_frame.h"

namespace thimble::lit {

template <>
Status draw_flat<0x1017>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x1017>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x101F>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x101F>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x1217>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x1217>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x121F>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x121F>(frame, map, suns, band, counts);
}

}  // namespace thimble::lit
