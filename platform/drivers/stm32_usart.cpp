#include "drivers/stm32_usart.h"

#include "registers.h"

namespace thimble::stm32_usart {
namespace {

constexpr uintptr_t kSr = 0x00;  // status
constexpr uint32_t kSrReceived = 1U << 5;
constexpr uint32_t kSrSendEmpty = 1U << 7;
constexpr uintptr_t kDr = 0x04;                                // data
constexpr uintptr_t kBrr = 0x08;                               // clock / baud
constexpr uintptr_t kCr1 = 0x0C;                               // control
constexpr uint32_t kCr1Enable = 1U << 13 | 1U << 3 | 1U << 2;  // USART, send, receive

}  // namespace

void start(uintptr_t base, uint32_t clock_hz, uint32_t baud) {
  register32(base + kBrr) = (clock_hz + baud / 2) / baud;
  register32(base + kCr1) = kCr1Enable;
}

void put(uintptr_t base, uint8_t byte) {
  wait_for_set(base + kSr, kSrSendEmpty);
  register32(base + kDr) = byte;
}

int get(uintptr_t base) {
  if ((register32(base + kSr) & kSrReceived) == 0) {
    return -1;
  }
  return static_cast<int>(register32(base + kDr) & 0xFFU);
}

}  // namespace thimble::stm32_usart
