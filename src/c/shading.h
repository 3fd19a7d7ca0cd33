// Where a shading begins. Internal to src/c.
#pragma once

#include "thimble/base/memory.h"
#include "thimble/picture/shading.h"
#include "thimble/thimble_c.h"

namespace thimble::c_face {

/// The core's default with that mode and palette.
void tell_default_shading(ShadeMode mode, Span<const Rgb8> palette, thimble_shading_t* to);

}  // namespace thimble::c_face
