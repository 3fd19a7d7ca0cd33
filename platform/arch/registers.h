/// Registers of a chip, by address.
#pragma once

#include <stdint.h>

#include "board.h"

namespace thimble {

/// The 32-bit register at `address`.
inline volatile uint32_t& register32(uintptr_t address) {
  return *reinterpret_cast<volatile uint32_t*>(address);
}
inline void set_bits(uintptr_t address, uint32_t bits) {
  register32(address) = register32(address) | bits;
}
inline void clear_bits(uintptr_t address, uint32_t bits) {
  register32(address) = register32(address) & ~bits;
}

/// Waits, bounded, until one of `bits` is set, or until all of them are clear.
inline bool wait_for_set(uintptr_t address, uint32_t bits) {
  for (uint32_t i = 0; i < board::kPatience; ++i) {
    if ((register32(address) & bits) != 0) {
      return true;
    }
  }
  return false;
}
inline bool wait_for_clear(uintptr_t address, uint32_t bits) {
  for (uint32_t i = 0; i < board::kPatience; ++i) {
    if ((register32(address) & bits) == 0) {
      return true;
    }
  }
  return false;
}

}  // namespace thimble
