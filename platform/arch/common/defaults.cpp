// What stands in for what a board leaves out.
#include "board.h"

namespace thimble::board {

[[gnu::weak]] void flush(const Band& /*band*/) {}

[[gnu::weak]] uint32_t buttons() {
  return 0;
}

}  // namespace thimble::board
