/// What of a board is left for a scene: the one place that says so for every subcommand.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "boards/board_table.h"
#include "boards/effect_flash.h"
#include "boards/program_flash.h"
#include "thimble/light/map_render.h"
#include "thimble/light/render.h"
#include "thimble/picture/render.h"

namespace thimble::tools {

/// Rows of the band that the figures below are for; an application may choose another number.
inline constexpr std::int32_t kBoardBandRows = 8;

/// What these effects take of the flash on a Cortex-M3: one by one or all together, whichever is less.
inline std::uint32_t effect_flash_bytes(EffectSet effects) {
  if (effects == Effect::kNone) {
    return 0;
  }
  std::uint32_t bytes = kLitBaseFlashBytes;
  for (const EffectFlash& one : kEffectFlash) {
    bytes += (effects & one.effect) != 0 ? one.bytes : 0;
  }
  return bytes < kAllEffectsFlashBytes ? bytes : kAllEffectsFlashBytes;
}
/// Flash that the demonstration takes beside a scene with these effects (boards/program_flash.h). A board without a row there
/// counts as the largest.
inline std::uint32_t code_flash_bytes(const platform::BoardFacts& board, EffectSet effects = Effect::kNone) {
  constexpr EffectSet kSun = Effect::kDirectLight | Effect::kShadows;
  ProgramFlash program{};
  for (const ProgramFlash& one : kProgramFlash) {
    if (std::strcmp(one.board, board.name) == 0) {
      program = one;
      break;
    }
    program.plain_kib = std::max(program.plain_kib, one.plain_kib);
    program.sun_kib = std::max(program.sun_kib, one.sun_kib);
    program.effect_percent = std::max(program.effect_percent, one.effect_percent);
  }
  const auto scaled = [&](std::uint32_t bytes) { return bytes / 100 * program.effect_percent; };
  // Boards with less stack draw water by the tree (platform/frames.cmake).
  constexpr std::uint32_t kWetStackBytes = 4096;
  const bool is_wet = (effects & Effect::kWater) != 0;
  const EffectSet moving = effects & ~Effect::kEdges;
  if (!is_flat(moving) || (is_wet && board.stack_bytes < kWetStackBytes)) {
    const std::uint32_t light = effects == Effect::kNone ? 0 : effect_flash_bytes(effects) + kTreeLightBytes;
    return program.plain_kib * 1024 + scaled(light);
  }
  std::uint32_t more = effect_flash_bytes(effects | kSun) - effect_flash_bytes(kSun);
  more += (effects & Effect::kAmbientOcclusion) != 0 ? kMapOcclusionBytes : 0;
  more += (effects & Effect::kMirror) != 0 ? kMapMirrorBytes : 0;
  more += is_wet ? kMapWaterBytes : 0;
  return program.sun_kib * 1024 + scaled(more);
}
/// Bytes of flash that a baked scene may take beside the demonstration.
inline std::uint64_t scene_flash_bytes(const platform::BoardFacts& board, EffectSet effects = Effect::kNone) {
  const std::uint32_t code = code_flash_bytes(board, effects);
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
  constexpr std::array kNames{"mono1",     "gray4",  "gray8",  "rgb565",      "rgb888",
                              "rgb565_be", "bgr565", "rgb444", "mono1_pages", "gray4_low",
                              "gray2",     "paper3", "paper7", "rgb332"};  // in their order
  static_assert(kNames.size() == static_cast<std::size_t>(PixelFormat::kRgb332) + 1);
  return kNames[static_cast<std::size_t>(format)];
}

}  // namespace thimble::tools
