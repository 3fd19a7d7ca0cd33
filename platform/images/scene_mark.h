/// What a program that takes its scene from the flash behind it says of itself (README.md): read by the program, and by
/// `thimble image` in the program's bytes.
#pragma once

#include <stdint.h>

namespace thimble::platform {

/// 48 bytes, little-endian as all boards are.
struct SceneMark {
  char magic[8];           ///< kSceneMarkMagic
  uint32_t baked_version;  ///< kBakedVersion (thimble/bake/baked_scene.h)
  uint32_t effects;        ///< scenes that `lies_within` these are drawn; an EffectSet
  uint32_t place;          ///< address of the scene: the first erase block behind the program
  uint32_t end;            ///< of the flash
  char board[24];
};
static_assert(sizeof(SceneMark) == 48);

inline constexpr char kSceneMarkMagic[9] = "THIMSCN1";

}  // namespace thimble::platform
