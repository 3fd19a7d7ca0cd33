// Clock and UART of the STM32VLDISCOVERY (STM32F100RB, reference manual RM0041): USART1 on PA9 and PA10.
#include "board.h"

#include <stdint.h>

#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble::board {
namespace {

// Reset and clock control.
constexpr uintptr_t kRccCr = 0x40021000;
constexpr uint32_t kCrPllOn = 1U << 24;
constexpr uint32_t kCrPllReady = 1U << 25;
constexpr uintptr_t kRccCfgr = 0x40021004;
constexpr uint32_t kCfgrPllTimes6 = 4U << 18;  // of half the internal 8 MHz: 24 MHz
constexpr uint32_t kCfgrUsePll = 2U << 0;
constexpr uintptr_t kRccApb2Enable = 0x40021018;
constexpr uint32_t kApb2PortA = 1U << 2;
constexpr uint32_t kApb2Usart1 = 1U << 14;

// Port A, pins 8 to 15: four bits each.
constexpr uintptr_t kPortACrh = 0x40010804;
constexpr uint32_t kPinsMask = 0xFFU << 4;   // PA9, PA10
constexpr uint32_t kPinsUsart = 0x4BU << 4;  // PA9: alternate function, push-pull; PA10: input

}  // namespace

void start() {
  register32(kRccCfgr) = kCfgrPllTimes6;
  set_bits(kRccCr, kCrPllOn);
  if (wait_for_set(kRccCr, kCrPllReady)) {
    set_bits(kRccCfgr, kCfgrUsePll);
  }
  set_bits(kRccApb2Enable, kApb2PortA | kApb2Usart1);
  register32(kPortACrh) = (register32(kPortACrh) & ~kPinsMask) | kPinsUsart;
  start_uart(kClockMhz * 1000000);
}

}  // namespace thimble::board
