// Where a shading begins. Internal to src/c.
#ifndef THIMBLE_SRC_C_SHADING_H
#define THIMBLE_SRC_C_SHADING_H

#include "thimble/base/memory.h"
#include "thimble/picture/shading.h"
#include "thimble/thimble_c.h"

namespace thimble::c_face {

/// The core's default with that mode and palette.
void tell_default_shading(ShadeMode mode, Span<const Rgb8> palette, thimble_shading_t* to);

}  // namespace thimble::c_face

#endif
