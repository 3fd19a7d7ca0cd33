#include "drivers/pl011.h"

#include "registers.h"

namespace thimble::pl011 {
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

void start(uintptr_t base, uint32_t clock_hz, uint32_t baud) {
  wait_for_clear(base + kFr, kFrBusy);
  register32(base + kCr) = 0;
  const uint32_t divisor = (clock_hz * 4 + baud / 2) / baud;  // clock / (16 baud), in 1/64
  register32(base + kIbrd) = divisor >> 6;
  register32(base + kFbrd) = divisor & 63U;
  register32(base + kLcrh) = kLcrhFifo | kLcrh8Bits;
  register32(base + kCr) = kCrEnable;
}

void put(uintptr_t base, uint8_t byte) {
  wait_for_clear(base + kFr, kFrSendFull);
  register32(base + kDr) = byte;
}

int get(uintptr_t base) {
  if ((register32(base + kFr) & kFrReceiveEmpty) != 0) {
    return -1;
  }
  return static_cast<int>(register32(base + kDr) & 0xFFU);
}

}  // namespace thimble::pl011
