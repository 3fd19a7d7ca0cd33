/// What the demonstration takes of a board's flash beside the scene, so that a scene which will not fit is refused before
/// anything is compiled: as linked by Debian 12's gcc 12.2, in KiB, rounded up; of
/// lm3s6965evb, microbit, stm32vldiscovery and gba. The others' light is estimated from theirs, what they take without from
/// tests/budgets/firmware.csv. tests/boards/scenes.sh holds it.
#pragma once

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
    {"lm3s6965evb", 98, 126, 100},
    {"microbit", 116, 149, 120},
    {"mps2-an500", 108, 149, 105},
    {"netduinoplus2", 98, 126, 105},
    {"pico", 130, 176, 120},
    {"pico-lcd-2", 130, 176, 120},
    {"pico-oled", 115, 146, 120},
    {"raspi0", 252, 358, 170},
    {"sifive_e", 119, 154, 130},
    {"stm32vldiscovery", 88, 115, 100},
};
/// What the demonstration takes more to show light by the tree than effect_flash.h has, on a Cortex-M3.
inline constexpr uint32_t kTreeLightBytes = 7 << 9;
/// What the map's way takes more where points send rays of their own, on a Cortex-M3.
inline constexpr uint32_t kMapOcclusionBytes = 6 << 10;
inline constexpr uint32_t kMapMirrorBytes = 10 << 10;
inline constexpr uint32_t kMapWaterBytes = 13 << 10;
// clang-format on

}  // namespace thimble
