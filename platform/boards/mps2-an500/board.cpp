// The UART of Arm's MPS2 board (CMSDK APB UART, Cortex-M System Design Kit Technical Reference Manual).
#include "board.h"

#include <stdint.h>

#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble::board {
namespace {

constexpr uintptr_t kUartData = 0x40004000;
constexpr uintptr_t kUartState = 0x40004004;
constexpr uint32_t kStateSendFull = 1U << 0;
constexpr uint32_t kStateReceived = 1U << 1;
constexpr uintptr_t kUartControl = 0x40004008;
constexpr uint32_t kControlEnable = 1U << 0 | 1U << 1;  // send, receive
constexpr uintptr_t kUartDivider = 0x40004010;          // clock / baud, at least 16

}  // namespace

void start() {
  register32(kUartDivider) = kClockMhz * 1000000 / kBaud;
  register32(kUartControl) = kControlEnable;
}

void put(uint8_t byte) {
  wait_for_clear(kUartState, kStateSendFull);
  register32(kUartData) = byte;
}

int get() {
  if ((register32(kUartState) & kStateReceived) == 0) {
    return -1;
  }
  return static_cast<int>(register32(kUartData) & 0xFFU);
}

}  // namespace thimble::board
