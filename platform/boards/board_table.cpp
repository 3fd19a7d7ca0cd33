#include "boards/board_table.h"

#include <string.h>

namespace thimble::platform {
namespace {

constexpr BoardFacts kBoards[] = {
#include "thimble_boards.inc"
};

}  // namespace

Span<const BoardFacts> boards() {
  return Span<const BoardFacts>(kBoards);
}

const BoardFacts* find_board(const char* name) {
  for (const BoardFacts& board : kBoards) {
    if (strcmp(board.name, name) == 0) {
      return &board;
    }
  }
  return nullptr;
}

}  // namespace thimble::platform
