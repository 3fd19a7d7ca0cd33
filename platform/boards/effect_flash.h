/// What each effect takes of the flash of a firmware image, measured by linking: lm3s6965evb (Cortex-M3),
/// with the compiler flags of every image, code and constants. Written by
/// `sh tests/boards/effects.sh --write`, and held to the byte by `make test-boards`, with Debian 12's
/// gcc-arm-none-eabi 12.2.
///
/// An image that draws with `render_lit_band<SET>` takes, beyond the one that calls `render_band`,
///
///     kLitBaseFlashBytes + the bytes of each effect in SET
///
/// or less, since effects share parts: all of them take kAllEffectsFlashBytes. An effect that SET does not
/// name takes nothing; with Effect::kNone the image is the other one, byte for byte (the same test compares
/// them).
#pragma once

#include <stdint.h>

#include "thimble/light/scene.h"

namespace thimble {

/// The loop of a lit picture with no effect in it, its dither and what opens the lighting of a baked scene.
inline constexpr uint32_t kLitBaseFlashBytes = 1868;

struct EffectFlash {
  EffectSet effect;  ///< one
  /// The image with this effect alone less the one with the base alone. Effect::kShadows, which need
  /// Effect::kDirectLight: with both, less the one with Effect::kDirectLight. Effect::kEmitterLight: with
  /// these two, less the one with them; Effect::kRipples: with Effect::kWater, less the one with it.
  uint32_t bytes;
};
// clang-format off
inline constexpr EffectFlash kEffectFlash[] = {
    {Effect::kDirectLight, 1968},
    {Effect::kShadows, 456},
    {Effect::kAmbientOcclusion, 592},
    {Effect::kEmission, 88},
    {Effect::kMirror, 1828},
    {Effect::kGlass, 15764},
    {Effect::kMedia, 11204},
    {Effect::kWater, 11144},
    {Effect::kFog, 1228},
    {Effect::kSky, 776},
    {Effect::kDepthCue, 660},
    {Effect::kSmoothNormals, 5680},
    {Effect::kEmitterLight, 4},
    {Effect::kEdges, 1724},
    {Effect::kRipples, 1368},
};
// clang-format on

/// All of them together, the base included: what the most general image takes beyond one without light.
inline constexpr uint32_t kAllEffectsFlashBytes = 39656;

}  // namespace thimble
