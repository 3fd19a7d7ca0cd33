// The contract of port.h, from what the board supplies.
#include "port.h"

#include "board.h"
#include "common/layout.h"
#include "thimble_board_facts.h"

namespace thimble::port {

const Facts& facts() {
  // The linker knows the size of the stack, so this is no constant of the compiler; but no code either.
  static const Facts kFacts = {board::kFacts.name,
                               board::kFacts.ram_bytes,
                               board::kFacts.flash_bytes,
                               static_cast<uint32_t>(reinterpret_cast<uintptr_t>(thimble_stack_bytes)),
                               board::kFacts.display,
                               board::kFacts.visits_a_second,
                               board::kFacts.map_rays_a_second,
                               board::kFacts.hold_fps,
                               board::kFacts.core_mhz};
  return kFacts;
}

Bytes arena() {
  return {thimble_arena_start, static_cast<size_t>(thimble_arena_end - thimble_arena_start)};
}

#ifdef THIMBLE_BAND_BUFFERS
void begin_flush(const Band& band) {
  if (!band.pixels.empty()) {
    board::begin_flush(band);  // a display holds what it was sent
  }
}

void await_flush() {
  board::await_flush();
}

void flush(const Band& band) {
  if (!band.pixels.empty()) {
    board::begin_flush(band);
    board::await_flush();
  }
}
#else
void flush(const Band& band) {
  if (!band.pixels.empty()) {
    board::flush(band);  // a display holds what it was sent
  }
}
#endif

#ifdef THIMBLE_FLUSHES_AGAIN
void flush_again(const Band& band) {
  board::flush_again(band);
}
#endif

uint32_t buttons() {
  return board::buttons();
}

int read() {
  return board::get();
}

void write(ConstBytes bytes) {
  for (const uint8_t byte : bytes) {
    board::put(byte);
  }
}

bool running(uint32_t frames) {
  return board::kFrames == 0 || frames < board::kFrames;
}

uint32_t stack_high_water() {
  const uint8_t* byte = thimble_stack_bottom;
  while (byte < thimble_stack_top && *byte == kStackPaint) {
    ++byte;
  }
  return static_cast<uint32_t>(thimble_stack_top - byte);
}

}  // namespace thimble::port
