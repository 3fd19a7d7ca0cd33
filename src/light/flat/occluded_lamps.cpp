// Lit frames by bricks with occlusion and lamps.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_OCCLUDED_LAMPS(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
