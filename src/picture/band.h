// What every renderer asks of a band before it draws. Internal to src/.
#ifndef THIMBLE_SRC_PICTURE_BAND_H
#define THIMBLE_SRC_PICTURE_BAND_H

#include <stddef.h>

#include "thimble/base/status.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"

namespace thimble {

/// The errors of `render_band`; `stride` gets the bytes from row to row.
Status check_band(const Camera& camera, int level, const Band& band, size_t* stride);

}  // namespace thimble

#endif
