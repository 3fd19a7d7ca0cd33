// Lit frames by bricks with occlusion.
#include "flat_frame.h"

namespace thimble::lit {

THIMBLE_FLAT_OCCLUDED(THIMBLE_DRAW_FLAT)

}  // namespace thimble::lit
