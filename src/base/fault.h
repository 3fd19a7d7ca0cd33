/// @file fault.h
/// How what looks at bytes says what is wrong with them.
#ifndef THIMBLE_SRC_BASE_FAULT_H
#define THIMBLE_SRC_BASE_FAULT_H

#include <stdint.h>

namespace thimble {

/// `text`, having put `where` it applies to `place` (may be null).
inline const char* fault(uint32_t* place, uint32_t where, const char* text) {
  if (place != nullptr) {
    *place = where;
  }
  return text;
}

}  // namespace thimble

#endif
