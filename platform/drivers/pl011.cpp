// Arm's PL011 UART (PrimeCell UART Technical Reference Manual): Stellaris, Raspberry Pi.
#include <stdint.h>

#include "board.h"
#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble::board {
namespace {

constexpr uintptr_t kDr = 0x00;  // data
constexpr uintptr_t kFr = 0x18;  // flags
constexpr uint32_t kFrBusy = 1U << 3;
constexpr uint32_t kFrReceiveEmpty = 1U << 4;
constexpr uint32_t kFrSendFull = 1U << 5;
constexpr uintptr_t kIbrd = 0x24;  // baud rate divisor, whole
constexpr uintptr_t kFbrd = 0x28;  // and 1/64
constexpr uintptr_t kLcrh = 0x2C;  // line control
constexpr uint32_t kLcrhFifo = 1U << 4;
constexpr uint32_t kLcrh8Bits = 3U << 5;
constexpr uintptr_t kCr = 0x30;                              // control
constexpr uint32_t kCrEnable = 1U << 0 | 1U << 8 | 1U << 9;  // UART, send, receive

}  // namespace

void start_uart(uint32_t clock_hz) {
  wait_for_clear(kUart + kFr, kFrBusy);
  register32(kUart + kCr) = 0;
  const uint32_t divisor = (clock_hz * 4 + kBaud / 2) / kBaud;  // clock / (16 baud), in 1/64
  register32(kUart + kIbrd) = divisor >> 6;
  register32(kUart + kFbrd) = divisor & 63U;
  register32(kUart + kLcrh) = kLcrhFifo | kLcrh8Bits;
  register32(kUart + kCr) = kCrEnable;
}

void put(uint8_t byte) {
  wait_for_clear(kUart + kFr, kFrSendFull);
  register32(kUart + kDr) = byte;
}

int get() {
  if ((register32(kUart + kFr) & kFrReceiveEmpty) != 0) {
    return -1;
  }
  return static_cast<int>(register32(kUart + kDr) & 0xFFU);
}

}  // namespace thimble::board
