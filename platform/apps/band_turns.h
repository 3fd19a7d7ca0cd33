/// @file band_turns.h
/// Bands by turns: one is drawn while the other is on its way to the display, where the port sends so
/// (port::band_buffers()). Elsewhere there is one band, and nothing of this is in the image.
///
/// An application keeps the bytes of all bands, and a flag: whether the second one is next.
#ifndef THIMBLE_PLATFORM_APPS_BAND_TURNS_H
#define THIMBLE_PLATFORM_APPS_BAND_TURNS_H

#include <stddef.h>

#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"

namespace thimble::apps {

/// Bytes of all bands, of which one takes `band_bytes`.
inline size_t all_bands(size_t band_bytes) {
  return band_bytes * static_cast<size_t>(port::band_buffers());
}

/// The first `size` bytes of the band that nobody reads.
inline Bytes next_band(const Bytes& bands, bool second, size_t size) {
  return bands.subspan(port::band_buffers() > 1 && second ? bands.size / 2 : 0, size);
}

/// Begins to send a band that was drawn there; the other one is next.
inline void send_band(const Band& band, bool* second) {
  port::begin_flush(band);
  if (port::band_buffers() > 1) {
    *second = !*second;
  }
}

}  // namespace thimble::apps

#endif
