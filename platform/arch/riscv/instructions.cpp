// The core counts its instructions itself. Under QEMU with `-icount shift=S` the counter moves by 2^S an
// instruction; the boards here have S = 0, so that the same code is right on a chip.
#include <stdint.h>

#include "thimble_board_facts.h"

namespace thimble::port {

uint32_t instructions() {
  static_assert(board::kIcountShift == 0);
  uint32_t count = 0;
  asm volatile("csrr %0, minstret" : "=r"(count));
  return count;
}

}  // namespace thimble::port
