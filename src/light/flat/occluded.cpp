// Lit frames by bricks with occlusion.
#include "flat_frame.h"

namespace thimble::lit {

template <>
Status draw_flat<0x007>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x007>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x00F>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x00F>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x207>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x207>(frame, map, suns, band, counts);
}
template <>
Status draw_flat<0x20F>(const Frame& frame, const BrickMap& map, Span<const SunBricks> suns, const Band& band,
                        LitCounts* counts) {
  return draw_faces<0x20F>(frame, map, suns, band, counts);
}

}  // namespace thimble::lit
