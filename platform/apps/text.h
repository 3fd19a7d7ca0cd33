/// Words and numbers over the port's UART, without printf: about a kilobyte of flash, 24 bytes of stack.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "port.h"

namespace thimble::apps {

/// Sends `text` up to its final zero.
inline void put(const char* text) {
  size_t length = 0;
  while (text[length] != '\0') {
    ++length;
  }
  port::write({reinterpret_cast<const uint8_t*>(text), length});
}

/// Sends a number in decimal, by subtracting powers of ten: no division of 64 bits.
inline void put(uint64_t number) {
  struct Powers {
    uint64_t of[19] = {};
    constexpr Powers() {
      uint64_t power = 10;
      for (int i = 18; i >= 0; --i, power *= 10) {
        of[i] = power;
      }
    }
  };
  static constexpr Powers kPowers;
  uint8_t digits[20];
  size_t count = 0;
  for (const uint64_t power : kPowers.of) {
    uint8_t digit = '0';
    for (; number >= power; number -= power) {
      ++digit;
    }
    if (digit != '0' || count != 0) {
      digits[count++] = digit;
    }
  }
  digits[count++] = static_cast<uint8_t>('0' + static_cast<uint8_t>(number));
  port::write({digits, count});
}

/// A number that is sent in eight hexadecimal digits, as CRC-32s are written.
struct Hex {
  uint32_t number;
};
inline void put(Hex hex) {
  uint8_t digits[8];
  for (uint32_t i = 0; i < 8; ++i) {
    const uint32_t nibble = hex.number >> (28 - 4 * i) & 15U;
    digits[i] = static_cast<uint8_t>(nibble + (nibble < 10 ? '0' : 'a' - 10));
  }
  port::write({digits, 8});
}

/// Sends several of these, one after the other.
template <class First, class Second, class... Rest>
[[gnu::always_inline]] inline void put(const First& first, const Second& second, const Rest&... rest) {
  put(first);
  put(second);
  (put(rest), ...);
}

/// Sends `thousandths` / 1000 with a point and `places` digits behind it (1 .. 3), cut off.
inline void put_thousandths(uint32_t thousandths, int places) {
  put(uint64_t{thousandths / 1000}, ".");
  uint32_t unit = 100;
  for (int i = 0; i < places; ++i, unit /= 10) {
    put(uint64_t{thousandths / unit % 10});
  }
}

/// Says why an application cannot run; its exit status.
inline int refuse(const char* why) {
  put("error: ", why, "\n");
  return 1;
}

}  // namespace thimble::apps
