// What goes over the wires to a panel, a line each on the UART: `w MS` a wait, `i BYTES` a transfer over I2C, `c BYTES` and
// `d BYTES` over SPI with D/C low and high. A wait of 20 ms stands between frames, so it ends the program; one of 1000 says
// that something went wrong.
#pragma once

#include <stddef.h>
#include <stdint.h>

extern "C" int putchar(int character);
extern "C" [[noreturn]] void exit(int status);

namespace wires {

inline void tell(char what, const uint8_t* bytes, size_t count) {
  putchar(what);
  putchar(' ');
  for (size_t i = 0; i < count; ++i) {
    putchar("0123456789abcdef"[bytes[i] >> 4]);
    putchar("0123456789abcdef"[bytes[i] & 15]);
  }
  putchar('\n');
}
inline void wait(uint32_t ms) {
  if (ms == 20 || ms == 1000) {
    exit(ms == 20 ? 0 : 1);
  }
  const uint8_t bytes[] = {static_cast<uint8_t>(ms)};
  tell('w', bytes, 1);
}

}  // namespace wires
