// Clocks, UART and buttons of the LM3S6965 evaluation board.
#include "board.h"

#include <stdint.h>

#include "lm3s6965.h"
#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble::board {
namespace {

constexpr uint32_t kArrowPins = 0xF;      // E0..E3
constexpr uint32_t kSelectPin = 1U << 1;  // F1
constexpr uint32_t kSelectShift = 3;      // from pin 1 to port::kSelect, bit 4

// Buttons seen released so far. A line that nobody drives reads as pressed; QEMU's do until their first
// event.
uint32_t released_once = 0;

void start_core_clock() {
  // Revision A2 has a PLL that wants 2.75 V in place of 2.5 (StellarisWare, programs of boards/ek-lm3s6965).
  if ((register32(lm3s6965::kDid0) & lm3s6965::kDid0Revision) == lm3s6965::kDid0RevisionA2) {
    register32(lm3s6965::kLdoControl) = lm3s6965::kLdo2750Mv;
  }
  // Onto the oscillator while the PLL settles, then onto it (data sheet, 6.1.4.2 "Initialization and
  // Configuration").
  set_bits(lm3s6965::kRcc, lm3s6965::kRccBypassPll);
  clear_bits(lm3s6965::kRcc, lm3s6965::kRccUseDivider);
  register32(lm3s6965::kRcc) = lm3s6965::kRcc50Mhz | lm3s6965::kRccBypassPll;
  wait_for_set(lm3s6965::kRis, lm3s6965::kRisPllLocked);
  register32(lm3s6965::kRcc) = lm3s6965::kRcc50Mhz;
}

void start_button_pins(uintptr_t port, uint32_t mask) {
  clear_bits(port + lm3s6965::kGpioDirection, mask);
  set_bits(port + lm3s6965::kGpioPullUp, mask);
  set_bits(port + lm3s6965::kGpioDigital, mask);
}

}  // namespace

void start() {
  start_core_clock();
  set_bits(lm3s6965::kRcgc1, lm3s6965::kRcgc1Uart0 | lm3s6965::kRcgc1Ssi0);
  register32(lm3s6965::kRcgc2) = lm3s6965::kRcgc2Ports;
  const uint32_t serial_pins = lm3s6965::kPinsUart0 | lm3s6965::kPinsSsi0;
  set_bits(lm3s6965::kPortA + lm3s6965::kGpioAlternate, serial_pins);
  set_bits(lm3s6965::kPortA + lm3s6965::kGpioDigital, serial_pins);
  start_uart(kClockMhz * 1000000);
  start_button_pins(lm3s6965::kPortE, kArrowPins);
  start_button_pins(lm3s6965::kPortF, kSelectPin);
  lm3s6965::start_display();
}

uint32_t buttons() {
  const uint32_t high = register32(lm3s6965::pins(lm3s6965::kPortE, kArrowPins)) |
                        register32(lm3s6965::pins(lm3s6965::kPortF, kSelectPin)) << kSelectShift;
  released_once |= high;
  return released_once & ~high;
}

}  // namespace thimble::board
