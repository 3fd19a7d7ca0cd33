/// What a kind of core takes for the work of frames by the brick map that the host counts (counted/counted.h), by which `thimble
/// boards` says what a frame of a scene takes on a board: from the demonstration's there (BOARD_FRAME_INSTRUCTIONS) on, that
/// much for each block of code more and each ray more that hits. As fits what tests/budgets/scene_frames.csv has best; the
/// ARM7's, in cycles, which was not measured with other scenes, are the Cortex-M0's, as the demonstration's are to its.
#pragma once

#include <stdint.h>

namespace thimble {

struct FrameCost {
  const char* cpu;            ///< BOARD_CPU
  uint32_t block_hundredths;  ///< instructions
  uint32_t hit;
};
inline constexpr FrameCost kFrameCosts[] = {
    {"arm1176jz-s", 666, 8}, {"arm7tdmi", 851, 190}, {"cortex-m0", 608, 136}, {"cortex-m0plus", 608, 136},
    {"cortex-m3", 400, 40},  {"cortex-m4", 400, 40}, {"cortex-m7", 426, 44},  {"rv32imac", 374, 96},
};

}  // namespace thimble
