#include "lit_instances.h"

namespace thimble::lit {

Status draw_wet(const Frame& frame, const Band& band, LitCounts* counts) {
  return (frame.effects & kMirror) != 0 ? draw_instance<kMirror | kWater>(frame, band, counts)
                                        : draw_instance<kWater>(frame, band, counts);
}

}  // namespace thimble::lit
