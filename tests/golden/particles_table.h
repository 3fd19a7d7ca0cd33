/// The golden states of the application `particles`: what it says as its second line on every board, `steps
/// 400 crc XXXXXXXX`. Tests on the host and of the firmware share it. A change of how balls move is a change
/// of this table.
#pragma once

#include <stdint.h>

namespace thimble::golden {

/// One world: apps::particles_config for the display's size and what the RAM leaves (apps/particles_world.h).
struct ParticlesState {
  int32_t width;
  int32_t height;
  uint32_t count;
  uint32_t crc32;  ///< of the state after apps::kToldSteps steps
};

inline constexpr ParticlesState kParticlesStates[] = {
    {128, 64, 160, 0xC395A8C1},   // lm3s6965evb, microbit, netduinoplus2, pico-oled, sifive_e
    {128, 64, 96, 0x0B51EDC5},    // stm32vldiscovery, 8 KiB of RAM
    {320, 240, 110, 0xBAEC228D},  // mps2-an500, pico-lcd-2
    {640, 480, 443, 0xC2852175},  // raspi0
    {240, 240, 83, 0xCD63AD04},   // pico
    {240, 160, 55, 0x0FE3DA14},   // gba
};

}  // namespace thimble::golden
