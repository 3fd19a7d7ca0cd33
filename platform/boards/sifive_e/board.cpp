// UART and clock of an E31 core as in the FE310 (SiFive FE310-G000 Manual).
#include "board.h"

#include <stdint.h>

#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

constexpr uint32_t kCrystalHz = 16000000;

// Clocks: the crystal, past the PLL.
constexpr uintptr_t kCrystal = 0x10008004;
constexpr uint32_t kCrystalEnable = 1U << 30;
constexpr uint32_t kCrystalReady = 1U << 31;
constexpr uintptr_t kPll = 0x10008008;
constexpr uint32_t kPllSelect = 1U << 16;
constexpr uint32_t kPllFromCrystal = 1U << 17;
constexpr uint32_t kPllBypass = 1U << 18;

// Pins 16 and 17 belong to the UART.
constexpr uintptr_t kPinFunctionEnable = 0x10012038;
constexpr uint32_t kUartPins = 3U << 16;

constexpr uintptr_t kSendData = 0x10013000;
constexpr uint32_t kSendFull = 1U << 31;
constexpr uintptr_t kReceiveData = 0x10013004;
constexpr uint32_t kReceiveEmpty = 1U << 31;
constexpr uintptr_t kSendControl = 0x10013008;
constexpr uintptr_t kReceiveControl = 0x1001300C;
constexpr uint32_t kEnable = 1U << 0;
constexpr uintptr_t kDivider = 0x10013018;  // clock / baud - 1

}  // namespace

void board::start() {
  set_bits(kCrystal, kCrystalEnable);
  if (wait_for_set(kCrystal, kCrystalReady)) {
    register32(kPll) = kPllSelect | kPllFromCrystal | kPllBypass;
  }
  set_bits(kPinFunctionEnable, kUartPins);
  register32(kDivider) = kCrystalHz / kBaud - 1;
  register32(kSendControl) = kEnable;
  register32(kReceiveControl) = kEnable;
}

void board::put(uint8_t byte) {
  wait_for_clear(kSendData, kSendFull);
  register32(kSendData) = byte;
}

int board::get() {
  const uint32_t data = register32(kReceiveData);
  return (data & kReceiveEmpty) != 0 ? -1 : static_cast<int>(data & 0xFFU);
}

// Both counters run from reset on.
void board::start_clock() {}

uint32_t port::microseconds() {
  // Cycles of 16 MHz. Under QEMU with -icount an instruction is a cycle. Not mtime, which counts 32,768 Hz in the FE310
  // and 10 MHz in QEMU.
  static_assert(board::kClockMhz == 16);
  uint32_t high = 0;
  uint32_t low = 0;
  uint32_t again = 0;
  asm volatile(
      "1: csrr %0, mcycleh\n"
      "csrr %1, mcycle\n"
      "csrr %2, mcycleh\n"
      "bne %0, %2, 1b\n"
      : "=&r"(high), "=&r"(low), "=&r"(again));
  return high << 28 | low >> 4;
}

}  // namespace thimble
