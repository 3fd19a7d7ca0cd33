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

BoardFacts board_for(const BoardFacts& board, const char* app) {
  BoardFacts result = board;
  for (const AppStack& own : board.app_stacks) {
    if (own.app != nullptr && strcmp(own.app, app) == 0) {
      result.stack_bytes = own.bytes;
    }
  }
  return result;
}

}  // namespace thimble::platform
