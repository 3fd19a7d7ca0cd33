#include "lit_instances.h"

namespace thimble::lit {

Status draw_clear(const Frame& frame, const Band& band, LitCounts* counts) {
  return (frame.effects & kMirror) != 0 ? draw_instance<kMirror | kGlass | kMedia>(frame, band, counts)
                                        : draw_instance<kGlass | kMedia>(frame, band, counts);
}

}  // namespace thimble::lit
