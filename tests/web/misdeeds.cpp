// What the page must catch: an application that does, as the next byte of its UART says, what no image may.
#include <stddef.h>
#include <stdint.h>

#include "port.h"

namespace thimble {
namespace {

// The compiler must believe that it ends and that every frame is needed.
[[gnu::noinline]] uint32_t overflow_stack(volatile const uint8_t* limit, uint32_t depth) {
  volatile uint8_t frame[64] = {};
  frame[depth % sizeof(frame)] = static_cast<uint8_t>(depth);
  if (*limit == 0) {
    return depth;
  }
  return overflow_stack(limit, depth + 1) + frame[(depth + 1) % sizeof(frame)];
}

void write(const volatile uint8_t* byte) {
  volatile uint8_t* const there = const_cast<volatile uint8_t*>(byte);
  *there = static_cast<uint8_t>(~*there);
}

}  // namespace
}  // namespace thimble

extern "C" [[clang::export_name("misdeeds")]] int thimble_misdeeds() {
  using namespace thimble;
  const Bytes ram = port::arena();
  const ConstBytes flash = port::scene();
  while (port::running(0)) {
    switch (port::read()) {
      case 'a':  // allowed: all of its RAM, and reading its flash
        for (uint8_t& byte : ram) {
          byte = static_cast<uint8_t>(&byte - ram.data + *flash.data);
        }
        break;
      case 'f':
        write(flash.data);
        break;
      case 'l':
        write(flash.end() - 1);
        break;
      case 'p':
        write(ram.end());
        break;
      case 'b':
        write(ram.data - 1);
        break;
      case 's':
        return static_cast<int>(overflow_stack(port::arena().data, 1));
      default:
        break;
    }
  }
  return 0;
}
