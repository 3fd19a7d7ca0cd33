// The Pico-LCD-1.3 (Waveshare's wiki): a joystick and four keys, of which A is the joystick's press, too.
#include "rp2040.h"

namespace thimble {

Span<const rp2040::Key> rp2040::keys() {
  static constexpr Key kKeys[] = {{2, port::kUp},     {18, port::kDown},  {16, port::kLeft},
                                  {20, port::kRight}, {3, port::kSelect}, {15, port::kSelect}};
  return Span<const Key>(kKeys);
}

}  // namespace thimble
