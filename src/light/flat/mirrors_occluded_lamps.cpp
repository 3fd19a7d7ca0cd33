// Lit frames by bricks with mirrors, occlusion and lamps.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_MIRRORS_OCCLUDED_LAMPS(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
