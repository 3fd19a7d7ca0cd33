// Lit frames by bricks with water.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_WATER(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
