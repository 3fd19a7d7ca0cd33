/// @file program_flash.h
/// What the demonstration takes of a board's flash beside the scene, so that a scene which will not fit is refused before
/// anything is compiled: as linked by Debian 12's gcc 12.2, in KiB, rounded up. tests/boards/scenes.sh holds it.
#ifndef THIMBLE_PLATFORM_BOARDS_PROGRAM_FLASH_H
#define THIMBLE_PLATFORM_BOARDS_PROGRAM_FLASH_H

#include <stdint.h>

namespace thimble {

struct ProgramFlash {
  const char* board;
  uint32_t plain_kib;       ///< without light
  uint32_t sun_kib;         ///< with direct light and shadows, by the brick map and by the tree
  uint32_t effect_percent;  ///< of what an effect takes on a Cortex-M3 (effect_flash.h)
};
// clang-format off
inline constexpr ProgramFlash kProgramFlash[] = {
    {"gba", 106, 151, 125},
    {"lm3s6965evb", 99, 125, 100},
    {"microbit", 116, 149, 120},
    {"mps2-an500", 108, 158, 105},
    {"netduinoplus2", 98, 125, 105},
    {"pico", 126, 176, 120},
    {"pico-lcd-2", 126, 176, 120},
    {"raspi0", 226, 311, 170},
    {"sifive_e", 119, 154, 130},
    {"stm32vldiscovery", 87, 114, 100},
};
/// What the map's way takes more where points send rays of their own, on a Cortex-M3.
inline constexpr uint32_t kMapOcclusionBytes = 6 << 10;
inline constexpr uint32_t kMapMirrorBytes = 10 << 10;
inline constexpr uint32_t kMapWaterBytes = 13 << 10;
// clang-format on

}  // namespace thimble

#endif
