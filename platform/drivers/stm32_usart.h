/// The USART of STM32F1, F2 and F4 (reference manuals RM0041 and RM0090).
#pragma once

#include <stdint.h>

namespace thimble::stm32_usart {

/// 8 bits, no parity, one stop bit. Pins and the module's clock are the board's work.
void start(uintptr_t base, uint32_t clock_hz, uint32_t baud);
void put(uintptr_t base, uint8_t byte);
int get(uintptr_t base);

}  // namespace thimble::stm32_usart
