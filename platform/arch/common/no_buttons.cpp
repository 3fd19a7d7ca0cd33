#include "board.h"

namespace thimble::board {

uint32_t buttons() {
  return 0;
}

}  // namespace thimble::board
