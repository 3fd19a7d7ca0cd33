#include "common/say.h"

#include "board.h"

namespace thimble {

void say(const char* text) {
  for (; *text != '\0'; ++text) {
    board::put(static_cast<uint8_t>(*text));
  }
}

void say_decimal(uint32_t value) {
  bool has_begun = false;
  for (uint32_t unit = 1000000000; unit != 0; unit /= 10) {
    const uint32_t digit = value / unit % 10;
    if (digit != 0 || has_begun || unit == 1) {
      board::put(static_cast<uint8_t>('0' + digit));
      has_begun = true;
    }
  }
}

void say_hex(uint32_t value) {
  say("0x");
  for (int shift = 28; shift >= 0; shift -= 4) {
    board::put(static_cast<uint8_t>("0123456789abcdef"[(value >> shift) & 15U]));
  }
}

}  // namespace thimble
