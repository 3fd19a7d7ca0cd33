// Lit frames by bricks with mirrors.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_MIRRORS(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
