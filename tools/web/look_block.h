/// What bake.wasm says of a scene's look from one camera, and scene.wasm draws by: this block, and behind it the
/// lighting section (src/FORMAT.md) of the look's own lights. Both modules lay it out alike.
#pragma once

#include <stdint.h>

#include "scene/backdrop.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/scene.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

struct LookBlock {
  SceneCamera camera;  ///< as the command frames it, to the last bit of a ray
  uint32_t lighting_bytes = 0;
  EffectSet effects = Effect::kNone;        ///< at rest
  EffectSet quick_effects = Effect::kNone;  ///< while the camera moves; none: voxels in quick colours
  int32_t across = 1;                       ///< samples a pixel at rest are its square
  uint32_t colors = 0;
  ToneTable quick_tone;  ///< with quick effects
  ShadeMode quick_mode = ShadeMode::kColor;
  bool is_stars = false;  ///< bake.wasm draws what is at rest
  bool has_backdrop = true;
  uint16_t quick_light[6] = {};
  Background background;
  Ground ground;
  Rgb8 palette[256];
  Rgb8 quick_palette[256];
};

/// Beside an exposure that the page hands on: a pixel of the picture at rest has one sample.
inline constexpr uint32_t kOneSample = 1U << 16;

/// The scene's own camera, or in its place one from there to there, in 1/256 voxel; the width of a parallel view is
/// `zoom` / 256 of its own.
struct WebCamera {
  int32_t eye[3];
  int32_t target[3];
  int32_t zoom;
  int32_t is_own;

  SceneCamera of(const SceneCamera& own) const {
    SceneCamera at = own;
    if (is_own == 0) {
      at.eye = {Q8::from_raw(eye[0]), Q8::from_raw(eye[1]), Q8::from_raw(eye[2])};
      at.target = {Q8::from_raw(target[0]), Q8::from_raw(target[1]), Q8::from_raw(target[2])};
      at.forward = {};
      at.up = {};
      at.span = Q14::from_raw(static_cast<int32_t>(int64_t{at.span.raw} * zoom >> 8));
    }
    return at;
  }
};

}  // namespace thimble::tools
