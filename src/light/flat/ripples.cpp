// Lit frames by bricks with water that has ripples.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_RIPPLES(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
