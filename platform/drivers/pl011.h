/// Arm's PL011 UART (PrimeCell UART Technical Reference Manual): Stellaris, Raspberry Pi.
#pragma once

#include <stdint.h>

namespace thimble::pl011 {

/// 8 bits, no parity, one stop bit, FIFOs on. Pins and the module's clock are the board's work.
void start(uintptr_t base, uint32_t clock_hz, uint32_t baud);
void put(uintptr_t base, uint8_t byte);
int get(uintptr_t base);

}  // namespace thimble::pl011
