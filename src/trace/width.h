// The one choice between 32 and 64 bits. Internal to src/.
#ifndef THIMBLE_SRC_TRACE_WIDTH_H
#define THIMBLE_SRC_TRACE_WIDTH_H

#include "thimble/base/status.h"
#include "thimble/trace/trace.h"

namespace thimble {

// Chips with 32-bit registers take the narrow path whenever they may.
inline constexpr bool kPrefers32 = sizeof(void*) <= 4;

// Chooses the arithmetic of a ray. `accepted` says whether 32 bits suffice for it; it is called only where
// that matters. kOutOfRange where 32 bits are wanted and do not suffice.
template <class Accepted>
[[gnu::always_inline]] inline Status choose_width(Width wanted, const Accepted& accepted, bool* narrow) {
  const bool must = wanted == Width::k32;
  *narrow = (must || (kPrefers32 && wanted == Width::kAuto)) && accepted();
  return must && !*narrow ? Status::kOutOfRange : Status::kOk;
}

}  // namespace thimble

#endif
