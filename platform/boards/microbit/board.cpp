// UART and clock of the BBC micro:bit (nRF51822, nRF51 Series Reference Manual). The nRF51 has no SysTick: a
// timer of its own is the clock.
#include "board.h"

#include <stdint.h>

#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

// UART0. On the micro:bit pin 24 sends and pin 25 receives.
constexpr uintptr_t kUart = 0x40002000;
constexpr uintptr_t kStartReceive = kUart + 0x000;
constexpr uintptr_t kStartSend = kUart + 0x008;
constexpr uintptr_t kReceived = kUart + 0x108;
constexpr uintptr_t kSent = kUart + 0x11C;
constexpr uintptr_t kEnable = kUart + 0x500;
constexpr uint32_t kEnableUart = 4;
constexpr uintptr_t kSendPin = kUart + 0x50C;
constexpr uintptr_t kReceivePin = kUart + 0x514;
constexpr uintptr_t kReceiveData = kUart + 0x518;
constexpr uintptr_t kSendData = kUart + 0x51C;
constexpr uintptr_t kBaudRate = kUart + 0x524;
constexpr uint32_t kBaud115200 = 0x01D7E000;

// TIMER0: 32 bits, 16 MHz.
constexpr uintptr_t kTimer = 0x40008000;
constexpr uintptr_t kTimerStart = kTimer + 0x000;
constexpr uintptr_t kTimerCapture0 = kTimer + 0x040;
constexpr uintptr_t kTimerBits = kTimer + 0x508;
constexpr uint32_t kTimer32Bits = 3;
constexpr uintptr_t kTimerPrescaler = kTimer + 0x510;
constexpr uintptr_t kTimerCc0 = kTimer + 0x540;

// The high frequency clock: from the crystal, which the UART's baud rate wants.
constexpr uintptr_t kStartCrystal = 0x40000000;
constexpr uintptr_t kCrystalStarted = 0x40000100;

uint32_t ticks() {
  register32(kTimerCapture0) = 1;
  return register32(kTimerCc0);
}

// 1000 / 16 ns a tick, 2^shift ns an instruction under QEMU: 125 / 128 for shift 6.
constexpr uint32_t kInstructionFactor = 125;
constexpr uint32_t kInstructionShift = 1 + board::kIcountShift;
static_assert(board::kClockMhz == 16);

// What was counted until `counted_ticks`; the timer turns over after 268 s, so it is to be read once in that
// time.
uint32_t counted_ticks = 0;
uint32_t counted_instructions = 0;
uint32_t counted_microseconds = 0;

void count() {
  // Steps of 16 and 128 ticks: what is left over stays in the timer.
  constexpr uint32_t kStep = 1U << kInstructionShift;
  static_assert(kStep % board::kClockMhz == 0);
  const uint32_t steps = (ticks() - counted_ticks) >> kInstructionShift;
  counted_ticks += steps << kInstructionShift;
  counted_instructions += steps * kInstructionFactor;
  counted_microseconds += steps * (kStep / board::kClockMhz);
}

}  // namespace

void board::start() {
  register32(kStartCrystal) = 1;
  wait_for_set(kCrystalStarted, 1);
  register32(kSendPin) = 24;
  register32(kReceivePin) = 25;
  register32(kBaudRate) = kBaud115200;
  register32(kEnable) = kEnableUart;
  register32(kStartReceive) = 1;
  register32(kStartSend) = 1;
}

void board::put(uint8_t byte) {
  register32(kSent) = 0;
  register32(kSendData) = byte;
  wait_for_set(kSent, 1);
}

int board::get() {
  if (register32(kReceived) == 0) {
    return -1;
  }
  register32(kReceived) = 0;
  return static_cast<int>(register32(kReceiveData) & 0xFFU);
}

void board::start_clock() {
  register32(kTimerBits) = kTimer32Bits;
  register32(kTimerPrescaler) = 0;
  register32(kTimerStart) = 1;
}

uint32_t port::instructions() {
  count();
  return counted_instructions + (((ticks() - counted_ticks) * kInstructionFactor) >> kInstructionShift);
}

uint32_t port::microseconds() {
  count();
  return counted_microseconds + (ticks() - counted_ticks) / board::kClockMhz;
}

}  // namespace thimble
