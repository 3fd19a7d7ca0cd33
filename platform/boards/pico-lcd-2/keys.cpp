// The Pico-LCD-2 (Waveshare's wiki): four keys, KEY0 to KEY3.
#include "rp2040.h"

namespace thimble {

Span<const rp2040::Key> rp2040::keys() {
  static constexpr Key kKeys[] = {{15, port::kUp}, {17, port::kDown}, {2, port::kLeft}, {3, port::kRight}};
  return Span<const Key>(kKeys);
}

}  // namespace thimble
