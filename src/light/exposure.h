// From a colour of any brightness to one that a display has. Internal to src/.
#pragma once

#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

// What is brighter than white: half way between cutting channels off, which turns orange into yellow, and
// keeping their ratio, which makes a lamp look like paint.
inline void expose(const Color& color, uint32_t (*channel)[3]) {
  uint32_t most = kWhite;
  for (const uint32_t one : color.c) {
    most = one > most ? one : most;
  }
  most = most < kMaxChannel ? most : kMaxChannel;
  for (int i = 0; i < 3; ++i) {
    const uint32_t one = color.c[i] < kMaxChannel ? color.c[i] : kMaxChannel;
    const uint32_t cut = one < kWhite ? one : kWhite;
    (*channel)[i] = most == kWhite ? cut : (cut + one * kWhite / most) / 2;  // 16 bits by 14
  }
}

// The channels in 8 bits, rounded to the nearest.
inline Rgb8 in_8_bits(const uint32_t (&channel)[3]) {
  return {static_cast<uint8_t>((channel[0] + kLevel / 2) / kLevel),
          static_cast<uint8_t>((channel[1] + kLevel / 2) / kLevel),
          static_cast<uint8_t>((channel[2] + kLevel / 2) / kLevel)};
}

}  // namespace thimble::lit
