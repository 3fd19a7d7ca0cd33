// The second core (port.h): the boot ROM holds it until the first sends it six words (RP2040 Datasheet, 2.8.2), then it
// waits for shares of a frame. No interrupt goes to it. Both cores see one memory, without caches.
#if defined(THIMBLE_CORES)
#include <stddef.h>
#include <stdint.h>

#include "port.h"
#include "registers.h"
#include "rp2040.h"

extern "C" {
[[noreturn]] void thimble_second_core();
extern const uint32_t thimble_image_vectors[];
}

namespace thimble {
namespace {

// What was written before is there for the other core; what follows is read after this.
void order_memory() {
  asm volatile("dmb" ::: "memory");
}

// For as long as it takes: the other core is at work, or has nothing to say yet.
uint32_t receive() {
  while ((register32(rp2040::kSioFifoStatus) & rp2040::kSioFifoFilled) == 0) {
  }
  order_memory();
  return register32(rp2040::kSioFifoRead);
}

void send(uint32_t word) {
  order_memory();
  wait_for_set(rp2040::kSioFifoStatus, rp2040::kSioFifoRoom);
  register32(rp2040::kSioFifoWrite) = word;
  asm volatile("sev");  // the ROM sleeps
}

uint32_t word_of(const void* pointer) {
  return static_cast<uint32_t>(reinterpret_cast<uintptr_t>(pointer));
}

// Whether the ROM of the other core repeats the word.
bool is_repeated(uint32_t word) {
  if (word == 0) {
    while ((register32(rp2040::kSioFifoStatus) & rp2040::kSioFifoFilled) != 0) {
      static_cast<void>(static_cast<uint32_t>(register32(rp2040::kSioFifoRead)));
    }
  }
  send(word);
  return wait_for_set(rp2040::kSioFifoStatus, rp2040::kSioFifoFilled) &&
         register32(rp2040::kSioFifoRead) == word;
}

}  // namespace

bool port::start_core(const Bytes& stack) {
  for (uint8_t& byte : stack) {
    byte = kStackPaint;
  }
  // Through a reset, so that the ROM has it, whatever ran there before us. Its first word is read with what else is there.
  set_bits(rp2040::kPsmForceOff, rp2040::kPsmCore1);
  wait_for_set(rp2040::kPsmForceOff, rp2040::kPsmCore1);
  clear_bits(rp2040::kPsmForceOff, rp2040::kPsmCore1);
  wait_for_set(rp2040::kSioFifoStatus, rp2040::kSioFifoFilled);
  const uint32_t top = word_of(stack.data + stack.size) & ~uint32_t{7};
  const auto entry = static_cast<uint32_t>(reinterpret_cast<uintptr_t>(&thimble_second_core));
  const uint32_t words[] = {0, 0, 1, word_of(thimble_image_vectors), top, entry};
  constexpr size_t kWords = sizeof words / sizeof words[0];
  // From the beginning where it repeats another one: a protocol was begun before.
  size_t repeated = 0;
  for (int tries = 0; tries < 64 && repeated < kWords; ++tries) {
    repeated = is_repeated(words[repeated]) ? repeated + 1 : 0;
  }
  return repeated == kWords;
}

void port::begin_share(void (*share)(void*), void* argument) {
  send(static_cast<uint32_t>(reinterpret_cast<uintptr_t>(share)));
  send(word_of(argument));
}

void port::await_share() {
  receive();
}

void port::lock() {
  while (register32(rp2040::kSioLock) == 0) {
  }
  order_memory();
}

void port::unlock() {
  order_memory();
  register32(rp2040::kSioLock) = 0;
}

}  // namespace thimble

void thimble_second_core() {
  for (;;) {
    const auto share = reinterpret_cast<void (*)(void*)>(static_cast<uintptr_t>(thimble::receive()));
    share(reinterpret_cast<void*>(static_cast<uintptr_t>(thimble::receive())));
    thimble::send(1);
  }
}
#endif
