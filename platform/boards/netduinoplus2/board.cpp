// Clock and UART of the Netduino Plus 2 (STM32F405RG, reference manual RM0090): USART1 on PA9 and PA10.
#include "board.h"

#include <stdint.h>

#include "drivers/stm32_usart.h"
#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble::board {
namespace {

constexpr uint32_t kBaud = 115200;
constexpr uintptr_t kUsart1 = 0x40011000;
constexpr uint32_t kUsart1ClockHz = 84000000;  // APB2

// Flash interface.
constexpr uintptr_t kFlashAcr = 0x40023C00;
constexpr uint32_t kFlash5WaitsAndCaches = 5U << 0 | 7U << 8;

// Reset and clock control.
constexpr uintptr_t kRccCr = 0x40023800;
constexpr uint32_t kCrPllOn = 1U << 24;
constexpr uint32_t kCrPllReady = 1U << 25;
constexpr uintptr_t kRccPllCfgr = 0x40023804;
constexpr uint32_t kPll168Mhz = 16U << 0 | 336U << 6 | 0U << 16 | 7U << 24;  // internal 16 MHz / 16 * 336 / 2
constexpr uintptr_t kRccCfgr = 0x40023808;
constexpr uint32_t kCfgrApbDividers = 5U << 10 | 4U << 13;  // APB1 / 4, APB2 / 2
constexpr uint32_t kCfgrUsePll = 2U << 0;
constexpr uintptr_t kRccAhb1Enable = 0x40023830;
constexpr uint32_t kAhb1PortA = 1U << 0;
constexpr uintptr_t kRccApb2Enable = 0x40023844;
constexpr uint32_t kApb2Usart1 = 1U << 4;

// Port A.
constexpr uintptr_t kPortAMode = 0x40020000;
constexpr uint32_t kModePins = 0xFU << 18;  // PA9, PA10
constexpr uint32_t kModeAlternate = 0xAU << 18;
constexpr uintptr_t kPortAAlternateHigh = 0x40020024;
constexpr uint32_t kAlternatePins = 0xFFU << 4;
constexpr uint32_t kAlternateUsart1 = 0x77U << 4;

void start_core_clock() {
  register32(kFlashAcr) = kFlash5WaitsAndCaches;
  register32(kRccPllCfgr) = kPll168Mhz;
  set_bits(kRccCr, kCrPllOn);
  if (wait_for_set(kRccCr, kCrPllReady)) {
    set_bits(kRccCfgr, kCfgrApbDividers);
    set_bits(kRccCfgr, kCfgrUsePll);
  }
}

}  // namespace

void start() {
  start_core_clock();
  set_bits(kRccAhb1Enable, kAhb1PortA);
  set_bits(kRccApb2Enable, kApb2Usart1);
  register32(kPortAMode) = (register32(kPortAMode) & ~kModePins) | kModeAlternate;
  register32(kPortAAlternateHigh) = (register32(kPortAAlternateHigh) & ~kAlternatePins) | kAlternateUsart1;
  stm32_usart::start(kUsart1, kUsart1ClockHz, kBaud);
}

void put(uint8_t byte) {
  stm32_usart::put(kUsart1, byte);
}

int get() {
  return stm32_usart::get(kUsart1);
}

}  // namespace thimble::board
