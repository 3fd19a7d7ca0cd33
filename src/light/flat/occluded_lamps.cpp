// Lit frames by bricks with occlusion and lamps.
#include "flat_frame.h"

namespace thimble::lit {

template <>
Status draw_flat<0x1007>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x1007>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x100F>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x100F>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x1207>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x1207>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x120F>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns,
                         const Band& band, LitCounts* counts) {
  return draw_faces<0x120F>(frame, map, suns, band, counts);
}

}  // namespace thimble::lit
