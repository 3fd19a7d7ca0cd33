// Lit frames by bricks with mirrors and occlusion.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_MIRRORS_OCCLUDED(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
