/// What every board is, for programs on the host: the one table, made from platform/boards/*/board.cmake.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/picture/pixel.h"

namespace thimble::platform {

/// How a display looks: white on black, dark on light, or pixels as they are.
enum class Screen : uint8_t { kNone, kOled, kLcd, kPlain };

/// What an application keeps for the stack where that is not the board's usual.
struct AppStack {
  const char* app = nullptr;
  uint32_t bytes = 0;
};

struct BoardFacts {
  const char* name;
  const char* title;
  const char* cpu;
  uint32_t ram_bytes;
  uint32_t flash_bytes;
  uint32_t stack_bytes;  ///< part of the RAM that is kept for the stack
  Screen screen;
  PixelFormat format;
  int32_t width_px;
  int32_t height_px;
  int32_t buttons;
  uint32_t visits_a_second;    ///< port::Facts::visits_a_second
  uint32_t map_rays_a_second;  ///< port::Facts::map_rays_a_second
  uint32_t core_mhz;
  uint32_t frame_instructions;  ///< of the demonstration, the median of its golden frames (bench)
  int32_t band_buffers;         ///< port::band_buffers()
  int32_t cores;                ///< port::cores()
  int32_t most_map_level;       ///< of worlds whose brick maps it takes
  AppStack app_stacks[5];       ///< those that there are, then empty ones
  uint32_t uf2_family;          ///< of files that are dragged onto its drive; 0: it takes none
  const char* image_ending;     ///< of files of its emulators' own ("gba"), or ""
};

/// All boards, by name in alphabetical order.
Span<const BoardFacts> boards();
/// The board of that name, or null.
const BoardFacts* find_board(const char* name);

/// The board as it is for an application: with that one's own `stack_bytes`.
BoardFacts board_for(const BoardFacts& board, const char* app);

}  // namespace thimble::platform
