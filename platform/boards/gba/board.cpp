// Display, keys, timers and serial port of the Game Boy Advance.
#include "board.h"

#include <stdint.h>

#include "gba.h"
#include "thimble_board_facts.h"

namespace thimble {
namespace {

using gba::register16;

constexpr uint32_t kPixels = static_cast<uint32_t>(board::kFacts.display.width_px) *
                             static_cast<uint32_t>(board::kFacts.display.height_px);

struct Key {
  uint16_t bit;
  port::Button button;
};
constexpr Key kKeyTable[] = {{gba::kKeyUp, port::kUp},
                             {gba::kKeyDown, port::kDown},
                             {gba::kKeyLeft, port::kLeft},
                             {gba::kKeyRight, port::kRight},
                             {gba::kKeyA, port::kSelect}};

// Cycles since the clock was started. Timer 0 may turn over between the reads; then what is above it changes.
uint64_t cycles() {
  for (;;) {
    const uint32_t high = register16(gba::timer_count(2));
    const uint32_t middle = register16(gba::timer_count(1));
    const uint32_t low = register16(gba::timer_count(0));
    if (middle == register16(gba::timer_count(1)) && high == register16(gba::timer_count(2))) {
      return static_cast<uint64_t>(high) << 32 | middle << 16 | low;
    }
  }
}

}  // namespace

void board::start() {
  register16(gba::kInterruptsOn) = 0;
  register16(gba::kWaits) = gba::kWaits3And1;
  register16(gba::kSerialMode) = 0;
  register16(gba::kSerialControl) = gba::kSerialUart;
  register16(gba::kSerialControl) = gba::kSerialUart | gba::kSerial115200 | gba::kSerial8Bits |
                                    gba::kSerialFifo | gba::kSerialSends | gba::kSerialReceives;
  register16(gba::kDisplayControl) = gba::kForcedBlank;
  volatile uint32_t* const picture = reinterpret_cast<volatile uint32_t*>(gba::kPicture);
  for (uint32_t i = 0; i < kPixels / 2; ++i) {
    picture[i] = 0;
  }
  register16(gba::kDisplayControl) = gba::kMode3 | gba::kBackground2;
}

// Bounded: nobody may be at the other end of the cable.
void board::put(uint8_t byte) {
  for (uint32_t i = 0; i < kPatience && (register16(gba::kSerialControl) & gba::kSerialSendFull) != 0; ++i) {
  }
  register16(gba::kSerialData) = byte;
}

int board::get() {
  if ((register16(gba::kSerialControl) & gba::kSerialReceiveEmpty) != 0) {
    return -1;
  }
  return static_cast<int>(register16(gba::kSerialData) & 0xFFU);
}

// Two pixels at a time lose the lowest bit of green: bbbbbggg gggrrrrr becomes 0bbbbbgg gggrrrrr. Eight words are loaded
// and stored by one instruction each, so a row is a multiple of 16 pixels; bands are aligned as words.
#define THIMBLE_SHOWN(r) \
  "and r12, " #r ", %[red]\n and " #r ", %[others], " #r ", lsr #1\n orr " #r ", " #r ", r12\n"

[[gnu::hot]] void board::flush(const Band& band) {
  static_assert(kFacts.display.width_px % 16 == 0);
  const size_t row_bytes = static_cast<size_t>(kFacts.display.width_px) * 2;
  uintptr_t to = gba::kPicture + static_cast<size_t>(band.first_row) * row_bytes;
  const uint8_t* from = band.pixels.data;
  const uint8_t* const end = from + static_cast<size_t>(band.rows) * row_bytes;
  asm volatile(
      "b 2f\n"
      // clang-format off
      "1: ldmia %[from]!, {r4-r11}\n"
      THIMBLE_SHOWN(r4) THIMBLE_SHOWN(r5) THIMBLE_SHOWN(r6) THIMBLE_SHOWN(r7)
      THIMBLE_SHOWN(r8) THIMBLE_SHOWN(r9) THIMBLE_SHOWN(r10) THIMBLE_SHOWN(r11)
      // clang-format on
      "stmia %[to]!, {r4-r11}\n"
      "2: cmp %[from], %[end]\n"
      "blo 1b\n"
      : [from] "+r"(from), [to] "+r"(to)
      : [end] "r"(end), [red] "r"(0x001F001F), [others] "r"(0x7FE07FE0)
      : "r4", "r5", "r6", "r7", "r8", "r9", "r10", "r11", "r12", "cc", "memory");
}

// Within the display, where no bit is lost any more.
[[gnu::hot]] void board::flush_again(const Band& band) {
  constexpr size_t kRowBytes = static_cast<size_t>(kFacts.display.width_px) * 2;
  uintptr_t to = gba::kPicture + static_cast<size_t>(band.first_row) * kRowBytes;
  uintptr_t from = to - kRowBytes;
  const uintptr_t end = to;
  asm volatile(
      "1: ldmia %[from]!, {r4-r11}\n"
      "stmia %[to]!, {r4-r11}\n"
      "cmp %[from], %[end]\n"
      "blo 1b\n"
      : [from] "+&r"(from), [to] "+&r"(to)
      : [end] "r"(end)
      : "r4", "r5", "r6", "r7", "r8", "r9", "r10", "r11", "cc", "memory");
}

uint32_t board::buttons() {
  const uint32_t up = register16(gba::kKeys);
  uint32_t down = 0;
  for (const Key& key : kKeyTable) {
    if ((up & key.bit) == 0) {
      down |= key.button;
    }
  }
  return down;
}

// The topmost first, so that none misses a turn.
void board::start_clock() {
  for (uint32_t timer = 3; timer-- > 0;) {
    register16(gba::timer_control(timer)) = 0;
    register16(gba::timer_count(timer)) = 0;
    register16(gba::timer_control(timer)) = gba::kTimerOn | (timer == 0 ? 0 : gba::kTimerCountsTurns);
  }
}

// The core's clock is 2^24 Hz.
uint32_t port::microseconds() {
  return static_cast<uint32_t>(cycles() * 15625 >> 18);
}

// Cycles: the core does not count instructions, and on this bus they differ by a factor of ten.
uint32_t port::instructions() {
  return static_cast<uint32_t>(cycles());
}

}  // namespace thimble
