/// An application's bands, by turns: one is drawn while the other is on its way to the display, where the port sends so
/// (port::band_buffers()). Elsewhere there is one band, and nothing of turns is in the image.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "port.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"

namespace thimble::apps {

inline const port::Display& display() {
  return port::facts().display;
}

/// Rows in a band, where the arena holds as many.
inline constexpr int32_t kBandRows = 8;

/// Bytes of all bands, of which one takes `band_bytes`.
inline size_t all_bands(size_t band_bytes) {
  return band_bytes * static_cast<size_t>(port::band_buffers());
}

struct Bands {
  Bytes memory;         ///< of all of them
  int32_t rows = 0;     ///< in one
  bool second = false;  ///< of them is next

  /// What one takes for that many rows.
  static size_t bytes_for(int32_t rows) { return band_bytes(display().format, display().width_px, rows); }

  /// Takes their memory, for so many rows or those of the display; false where the arena does not hold it.
  bool take(Arena* arena, int32_t most_rows = kBandRows) {
    rows = display().height_px < most_rows ? display().height_px : most_rows;
    memory = arena->take(all_bands(bytes_for(rows)));
    return !memory.empty();
  }

  /// The picture's rows from `y` on, as many as there are before `end`, in the band that nobody reads.
  Band next(int32_t y, int32_t end) const {
    const int32_t count = end - y < rows ? end - y : rows;
    const size_t begin = port::band_buffers() > 1 && second ? memory.size / 2 : 0;
    return {memory.subspan(begin, bytes_for(count)), display().format, 0, y, count};
  }

  /// Begins to send a band that was drawn there; the other one is next.
  void send(const Band& band) {
    port::begin_flush(band);
    if (port::band_buffers() > 1) {
      second = !second;
    }
  }
};

}  // namespace thimble::apps
