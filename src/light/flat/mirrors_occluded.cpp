// Lit frames by bricks with mirrors and occlusion.
#include "flat_frame.h"

namespace thimble::lit {

template <>
Status draw_flat<0x017>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x017>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x01F>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x01F>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x217>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x217>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x21F>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x21F>(frame, map, suns, band, counts);
}

}  // namespace thimble::lit
