// Lit frames by bricks with lamps.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_LAMPS(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
