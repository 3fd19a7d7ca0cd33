// Four keys on a breadboard, from GP10 to GP13 to ground.
#include "rp2040.h"

namespace thimble {

Span<const rp2040::Key> rp2040::keys() {
  static constexpr Key kKeys[] = {{10, port::kUp}, {11, port::kDown}, {12, port::kLeft}, {13, port::kRight}};
  return Span<const Key>(kKeys);
}

}  // namespace thimble
