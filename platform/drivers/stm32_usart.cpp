// The USART of STM32F1, F2 and F4 (reference manuals RM0041 and RM0090).
#include <stdint.h>

#include "board.h"
#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble::board {
namespace {

constexpr uintptr_t kSr = 0x00;  // status
constexpr uint32_t kSrReceived = 1U << 5;
constexpr uint32_t kSrSendEmpty = 1U << 7;
constexpr uintptr_t kDr = 0x04;                                // data
constexpr uintptr_t kBrr = 0x08;                               // clock / baud
constexpr uintptr_t kCr1 = 0x0C;                               // control
constexpr uint32_t kCr1Enable = 1U << 13 | 1U << 3 | 1U << 2;  // USART, send, receive

}  // namespace

void start_uart(uint32_t clock_hz) {
  register32(kUart + kBrr) = (clock_hz + kBaud / 2) / kBaud;
  register32(kUart + kCr1) = kCr1Enable;
}

void put(uint8_t byte) {
  wait_for_set(kUart + kSr, kSrSendEmpty);
  register32(kUart + kDr) = byte;
}

int get() {
  if ((register32(kUart + kSr) & kSrReceived) == 0) {
    return -1;
  }
  return static_cast<int>(register32(kUart + kDr) & 0xFFU);
}

}  // namespace thimble::board
