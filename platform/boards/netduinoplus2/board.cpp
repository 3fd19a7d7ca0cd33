// Clock and UART of the Netduino Plus 2 (STM32F405RG, reference manual RM0090): USART6, which sends on PC6 (header D1)
// and receives on PC7 (D0). Of USART1's pins PA9 is on no header, and PA10 is the LED (MicroPython,
// ports/stm32/boards/NETDUINO_PLUS_2/pins.csv).
#include "board.h"

#include <stdint.h>

#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble::board {
namespace {

constexpr uint32_t kUsart6ClockHz = 84000000;  // APB2

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
constexpr uint32_t kAhb1PortC = 1U << 2;
constexpr uintptr_t kRccApb2Enable = 0x40023844;
constexpr uint32_t kApb2Usart6 = 1U << 5;

// Port C: two bits of mode and four of alternate function a pin.
constexpr uintptr_t kPortCMode = 0x40020800;
constexpr uint32_t kModePins = 0xFU << 12;  // PC6, PC7
constexpr uint32_t kModeAlternate = 0xAU << 12;
constexpr uintptr_t kPortCAlternateLow = 0x40020820;
constexpr uint32_t kAlternatePins = 0xFFU << 24;
constexpr uint32_t kAlternateUsart6 = 0x88U << 24;  // AF8

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
  set_bits(kRccAhb1Enable, kAhb1PortC);
  set_bits(kRccApb2Enable, kApb2Usart6);
  register32(kPortCMode) = (register32(kPortCMode) & ~kModePins) | kModeAlternate;
  register32(kPortCAlternateLow) = (register32(kPortCAlternateLow) & ~kAlternatePins) | kAlternateUsart6;
  start_uart(kUsart6ClockHz);
}

}  // namespace thimble::board
