// UART and clock of an E31 core as in the FE310 (SiFive FE310-G000 Manual).
#include "board.h"

#include <stdint.h>

#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

constexpr uint32_t kBaud = 115200;
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

// Time: mtime of the core local interruptor, 64 bits. 10 MHz under QEMU; the FE310 drives it with 32768 Hz.
constexpr uintptr_t kMtimeLow = 0x0200BFF8;
constexpr uintptr_t kMtimeHigh = 0x0200BFFC;

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
  // The division's remainder of the high word, 6 of 2^32 a step, is carried along; no 64-bit division.
  static_assert(board::kClockMhz == 10);
  uint32_t high = register32(kMtimeHigh);
  uint32_t low = register32(kMtimeLow);
  if (register32(kMtimeHigh) != high) {
    high = register32(kMtimeHigh);
    low = register32(kMtimeLow);
  }
  const uint32_t rest = high % 10;
  // (rest * 2^32 + low) / 10, with 2^32 = 429496729 * 10 + 6. `high / 10` whole turns vanish modulo 2^32.
  return rest * 429496729U + low / 10 + (rest * 6 + low % 10) / 10;
}

}  // namespace thimble
