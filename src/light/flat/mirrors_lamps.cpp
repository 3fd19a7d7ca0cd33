// Lit frames by bricks with mirrors and lamps.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_MIRRORS_LAMPS(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
