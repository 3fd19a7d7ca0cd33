#include "common/say.h"

#include "board.h"

namespace thimble {

void say(const char* text) {
  for (; *text != '\0'; ++text) {
    board::put(static_cast<uint8_t>(*text));
  }
}

void say_hex(uint32_t value) {
  say("0x");
  for (int shift = 28; shift >= 0; shift -= 4) {
    board::put(static_cast<uint8_t>("0123456789abcdef"[(value >> shift) & 15U]));
  }
}

}  // namespace thimble
