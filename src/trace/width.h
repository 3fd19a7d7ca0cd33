// The one choice between 32 and 64 bits. Internal to src/.
#pragma once

#include "thimble/base/status.h"
#include "thimble/trace/ray.h"

namespace thimble {

// Chips with 32-bit registers take the narrow path whenever they may.
inline constexpr bool kPrefers32 = sizeof(void*) <= 4;

// Chooses the arithmetic of a ray. `accepted` says whether 32 bits suffice for it; it is called only where
// that matters. False where 32 bits are wanted and do not suffice.
template <class Accepted>
[[gnu::always_inline]] inline bool choose_width(Width wanted, bool* narrow, const Accepted& accepted) {
  if (wanted == Width::k64 || (wanted == Width::kAuto && !kPrefers32)) {
    *narrow = false;
    return true;
  }
  *narrow = accepted();
  return *narrow || wanted == Width::kAuto;
}

}  // namespace thimble
