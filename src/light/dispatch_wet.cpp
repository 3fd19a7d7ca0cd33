#include "instances.h"

namespace thimble::lit {

Status draw_wet(const Frame& frame, const Band& band, LitCounts* counts) {
  return (frame.effects & Effect::kMirror) != 0
             ? draw_instance<Effect::kMirror | Effect::kWater>(frame, band, counts)
             : draw_instance<Effect::kWater>(frame, band, counts);
}

}  // namespace thimble::lit
