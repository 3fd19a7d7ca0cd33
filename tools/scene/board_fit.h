/// @file board_fit.h
/// What of a board is left for a scene: the one place that says so for every subcommand.
#ifndef THIMBLE_TOOLS_SCENE_BOARD_FIT_H
#define THIMBLE_TOOLS_SCENE_BOARD_FIT_H

#include <cstdint>

#include "boards/board_table.h"
#include "boards/effect_flash.h"
#include "thimble/light/render.h"
#include "thimble/picture/render.h"

namespace thimble::tools {

/// Flash kept for the program. What draws a baked scene takes at most 29 KiB at -Os on a Cortex-M0, whose
/// code is the largest (as one object a source; the linker drops what is not called); the rest is for
/// start-up, drivers and the application. One that also builds scenes on the chip wants 13 KiB more and has
/// to set a smaller limit (--memory).
inline constexpr std::uint32_t kCodeFlashBytes = 40 * 1024;
/// Rows of the band that the figures below are for; an application may choose another number.
inline constexpr std::int32_t kBoardBandRows = 8;

/// Flash kept for the program that draws with these effects: what they take as measured on a Cortex-M3
/// (boards/effect_flash.h), one by one or all together, whichever is less.
inline std::uint32_t code_flash_bytes(EffectSet effects) {
  if (effects == Effect::kNone) {
    return kCodeFlashBytes;
  }
  std::uint32_t bytes = kLitBaseFlashBytes;
  for (const EffectFlash& one : kEffectFlash) {
    bytes += (effects & one.effect) != 0 ? one.bytes : 0;
  }
  return kCodeFlashBytes + (bytes < kAllEffectsFlashBytes ? bytes : kAllEffectsFlashBytes);
}
/// Bytes of flash that a baked scene may take.
inline std::uint64_t scene_flash_bytes(const platform::BoardFacts& board, EffectSet effects = Effect::kNone) {
  const std::uint32_t code = code_flash_bytes(effects);
  return board.flash_bytes > code ? board.flash_bytes - code : 0;
}
/// Bytes of RAM that the stack leaves.
inline std::uint64_t free_ram_bytes(const platform::BoardFacts& board) {
  return board.ram_bytes > board.stack_bytes ? board.ram_bytes - board.stack_bytes : 0;
}
/// Bytes of a band of kBoardBandRows rows of the board's display.
inline std::uint64_t board_band_bytes(const platform::BoardFacts& board) {
  return band_bytes(board.format, board.width_px, kBoardBandRows);
}
/// RAM to draw a scene that lies in flash: camera, shading and counters (as large as on this machine; a
/// 32-bit chip takes less), one band, and the stack.
inline std::uint64_t drawing_ram_bytes(const platform::BoardFacts& board, EffectSet effects = Effect::kNone) {
  return lit_render_bytes(effects) + board_band_bytes(board) + board.stack_bytes;
}

/// "gray4", as board.cmake has it.
inline const char* format_name(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono1:
      return "mono1";
    case PixelFormat::kGray4:
      return "gray4";
    case PixelFormat::kGray8:
      return "gray8";
    case PixelFormat::kRgb565:
      return "rgb565";
    case PixelFormat::kRgb888:
      return "rgb888";
    case PixelFormat::kRgb565Be:
      return "rgb565_be";
    case PixelFormat::kBgr565:
      return "bgr565";
    case PixelFormat::kRgb444:
      return "rgb444";
    case PixelFormat::kMono1Pages:
      return "mono1_pages";
    case PixelFormat::kGray4Low:
      return "gray4_low";
    case PixelFormat::kGray2:
      return "gray2";
    case PixelFormat::kPaper3:
      return "paper3";
    case PixelFormat::kPaper7:
      return "paper7";
    case PixelFormat::kRgb332:
      return "rgb332";
  }
  return "unknown";
}

}  // namespace thimble::tools

#endif
