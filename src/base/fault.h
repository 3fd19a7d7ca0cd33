/// What looks at bytes: their checksum, and how to say what is wrong with them.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"

namespace thimble {

/// Of `size` bytes but for the word at `place`, which holds it.
inline uint32_t checksum_around(const uint8_t* base, size_t size, uint32_t place) {
  return crc32({base + place + 4, size - place - 4}, crc32({base, place}));
}

/// `text`, having put `where` it applies to `place` (may be null).
inline const char* fault(uint32_t* place, uint32_t where, const char* text) {
  if (place != nullptr) {
    *place = where;
  }
  return text;
}

}  // namespace thimble
