/// Registers of the LM3S6965 that this board uses (Stellaris LM3S6965 data sheet).
#pragma once

#include <stdint.h>

namespace thimble::lm3s6965 {

// System control: what revision of the chip it is, its voltage, clocks.
inline constexpr uintptr_t kDid0 = 0x400FE000;
inline constexpr uint32_t kDid0Revision = 0xFFFF;
inline constexpr uint32_t kDid0RevisionA2 = 0x0002;
inline constexpr uintptr_t kLdoControl = 0x400FE034;
inline constexpr uint32_t kLdo2750Mv = 0x1B;
inline constexpr uintptr_t kRis = 0x400FE050;  ///< raw interrupt status
inline constexpr uint32_t kRisPllLocked = 1U << 6;
inline constexpr uintptr_t kRcc = 0x400FE060;  ///< run-mode clock configuration
inline constexpr uint32_t kRccBypassPll = 1U << 11;
inline constexpr uint32_t kRccUseDivider = 1U << 22;
/// Main oscillator with its crystal of 8 MHz, PLL on; 200 MHz / 4 once it is used.
inline constexpr uint32_t kRcc50Mhz = 3U << 23 | kRccUseDivider | 0xEU << 6 | 1U << 1;
inline constexpr uintptr_t kRcgc1 = 0x400FE104;  ///< run-mode clock gating 1
inline constexpr uint32_t kRcgc1Uart0 = 1U << 0;
inline constexpr uint32_t kRcgc1Ssi0 = 1U << 4;
inline constexpr uintptr_t kRcgc2 = 0x400FE108;  ///< run-mode clock gating 2
inline constexpr uint32_t kRcgc2Ports = 0x7F;    ///< GPIO A to G

// GPIO. The data register is a window of 256 words: the address's bits 9..2 are the mask of pins that an
// access touches.
inline constexpr uintptr_t kPortA = 0x40004000;  ///< UART0, SSI0
inline constexpr uintptr_t kPortC = 0x40006000;  ///< C7: data or command to the display
inline constexpr uintptr_t kPortD = 0x40007000;  ///< D0: display selected (or the SD card)
inline constexpr uintptr_t kPortE = 0x40024000;  ///< E0..E3: up, down, left, right; low when pressed
inline constexpr uintptr_t kPortF = 0x40025000;  ///< F1: select; low when pressed
inline constexpr uintptr_t kGpioDirection = 0x400;
inline constexpr uintptr_t kGpioAlternate = 0x420;
inline constexpr uintptr_t kGpioPullUp = 0x510;
inline constexpr uintptr_t kGpioDigital = 0x51C;
constexpr uintptr_t pins(uintptr_t port, uint32_t mask) {
  return port + (mask << 2);
}
inline constexpr uint32_t kPinsUart0 = 3U << 0;   ///< A0, A1
inline constexpr uint32_t kPinsSsi0 = 0xFU << 2;  ///< A2 to A5

// Synchronous serial interface 0, which leads to the display.
inline constexpr uintptr_t kSsiCr0 = 0x40008000;  ///< format
inline constexpr uint32_t kSsiCr08Bits = 7;
inline constexpr uintptr_t kSsiCr1 = 0x40008004;
inline constexpr uint32_t kSsiCr1Enable = 1U << 1;
inline constexpr uintptr_t kSsiDr = 0x40008008;  ///< data
inline constexpr uintptr_t kSsiSr = 0x4000800C;  ///< status
inline constexpr uint32_t kSsiSrSendEmpty = 1U << 0;
inline constexpr uint32_t kSsiSrBusy = 1U << 4;
inline constexpr uint32_t kSsiQueue = 8;           ///< bytes in the queue of each direction
inline constexpr uintptr_t kSsiCpsr = 0x40008010;  ///< clock divider, even

/// oled.cpp: after the ports have their clocks.
void start_display();

}  // namespace thimble::lm3s6965
