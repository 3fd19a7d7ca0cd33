// UART, clock and framebuffer of the Raspberry Pi Zero (BCM2835 ARM Peripherals; the mailbox's property
// interface is that of the Raspberry Pi firmware).
#include "board.h"

#include <stdint.h>

#include "arm11/fence.h"
#include "registers.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

constexpr uint32_t kDevices = 0x20000000;
constexpr uint32_t kDevicesBytes = 0x01000000;

constexpr uint32_t kUartClockHz = 48000000;
constexpr uintptr_t kPinFunctions1 = 0x20200004;  // pins 10 to 19, three bits each
constexpr uint32_t kUartPins = 077U << 12;        // 14 and 15
constexpr uint32_t kUartFunction = 044U << 12;    // alternate function 0

constexpr uintptr_t kSystemTimerLow = 0x20003004;  // microseconds

constexpr uintptr_t kMailboxRead = 0x2000B880;
constexpr uintptr_t kMailboxStatus = 0x2000B898;
constexpr uint32_t kMailboxFull = 1U << 31;
constexpr uint32_t kMailboxEmpty = 1U << 30;
constexpr uintptr_t kMailboxWrite = 0x2000B8A0;
constexpr uint32_t kPropertyChannel = 8;
// The graphics processor sees the RAM, past its cache, from here on.
constexpr uint32_t kBusAlias = 0xC0000000;
constexpr uint32_t kBusMask = 0x3FFFFFFF;

constexpr uint32_t kWidth = static_cast<uint32_t>(board::kFacts.display.width_px);
constexpr uint32_t kHeight = static_cast<uint32_t>(board::kFacts.display.height_px);

// The framebuffer: 32 bits a pixel, red in the lowest byte; null where there is none.
uint32_t* pixels = nullptr;
uint32_t pitch_bytes = 0;

// A message of tags: tag, room for its values, 0, values.
constexpr uint32_t kDepthBits = 32;
constexpr uint32_t kOrderRgb = 1;
constexpr uint32_t kFramebufferWord = 23;
constexpr uint32_t kPitchWord = 28;
alignas(16) volatile uint32_t message[32];

bool ask_for_framebuffer() {
  // clang-format off
  constexpr uint32_t kQuestion[32] = {
      sizeof(message), 0,                  // bytes, request
      0x00048003, 8, 0, kWidth, kHeight,   // size on the screen
      0x00048004, 8, 0, kWidth, kHeight,   // size in memory
      0x00048005, 4, 0, kDepthBits,        // bits a pixel
      0x00048006, 4, 0, kOrderRgb,         // order of the colours
      0x00040001, 8, 0, 4096, 0,           // framebuffer: its alignment; answers with address and bytes
      0x00040008, 4, 0, 0,                 // bytes of a row
      0, 0, 0,                             // end
  };
  // clang-format on
  for (uint32_t i = 0; i < 32; ++i) {
    message[i] = kQuestion[i];
  }
  wait_for_clear(kMailboxStatus, kMailboxFull);
  const uint32_t address = static_cast<uint32_t>(reinterpret_cast<uintptr_t>(message));
  register32(kMailboxWrite) = address | kBusAlias | kPropertyChannel;
  // Other channels may answer first.
  for (int i = 0; i < 16; ++i) {
    if (!wait_for_clear(kMailboxStatus, kMailboxEmpty)) {
      return false;
    }
    if ((register32(kMailboxRead) & 15U) == kPropertyChannel) {
      return message[kFramebufferWord] != 0 && message[kPitchWord] != 0;
    }
  }
  return false;
}

void start_display() {
  if (!ask_for_framebuffer()) {
    return;
  }
  const uint32_t address = message[kFramebufferWord] & kBusMask;
  pitch_bytes = message[kPitchWord];
  pixels = reinterpret_cast<uint32_t*>(address);
  arm11::open_window(arm11::Window::kMemory, address, pitch_bytes * kHeight);
  for (uint32_t i = 0; i < pitch_bytes * kHeight / sizeof(uint32_t); ++i) {
    pixels[i] = 0;
  }
}

}  // namespace

void board::start() {
  arm11::open_window(arm11::Window::kDevice, kDevices, kDevicesBytes);
  register32(kPinFunctions1) = (register32(kPinFunctions1) & ~kUartPins) | kUartFunction;
  start_uart(kUartClockHz);
  start_display();
}

// Three words hold four pixels. A row is a whole number of words, and so are the bytes of the arena.
void board::flush(const Band& band) {
  if (pixels == nullptr) {
    return;
  }
  static_assert(kWidth % 4 == 0);
  constexpr uint32_t kColor = 0xFFFFFF;
  const uint8_t* from = band.pixels.data;
  for (int32_t row = 0; row < band.rows; ++row) {
    uint32_t* to = pixels + pitch_bytes / sizeof(uint32_t) * static_cast<uint32_t>(band.first_row + row);
    for (const uint32_t* const end = to + kWidth; to != end; to += 4) {
      uint32_t words[3];
      __builtin_memcpy(words, __builtin_assume_aligned(from, sizeof(uint32_t)), sizeof(words));
      to[0] = words[0] & kColor;
      to[1] = (words[0] >> 24 | words[1] << 8) & kColor;
      to[2] = (words[1] >> 16 | words[2] << 16) & kColor;
      to[3] = words[2] >> 8;
      from += sizeof(words);
    }
  }
}

// The system timer runs from power-on.
void board::start_clock() {}

uint32_t port::microseconds() {
  return register32(kSystemTimerLow);
}

// Under QEMU with `-icount shift=10` an instruction takes 1.024 microseconds. The product of the timer and
// 1000/1024 is taken in pieces that keep all bits; where the timer turns over, after 71 minutes, so does the
// count, early.
uint32_t port::instructions() {
  static_assert(board::kIcountShift == 10);
  const uint32_t now = microseconds();
  return (now >> 10) * 1000 + (((now & 1023U) * 1000) >> 10);
}

}  // namespace thimble
