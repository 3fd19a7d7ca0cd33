/// @file quick_look.h
/// A look while the camera moves: what costs no rays of its own, about as bright as the finished picture.
#ifndef THIMBLE_TOOLS_SCENE_QUICK_LOOK_H
#define THIMBLE_TOOLS_SCENE_QUICK_LOOK_H

#include <cstdint>
#include <vector>

#include "scene/default_look.h"
#include "scene/tone_table.h"

namespace thimble::tools {

/// What of a look's effects is drawn then.
inline constexpr EffectSet kQuickEffects = Effect::kDirectLight | Effect::kEmission | Effect::kWater |
                                           Effect::kFog | Effect::kSky | Effect::kDepthCue;

/// The light of a face in the open, for pictures without shadows: what comes from everywhere, the suns by their
/// angles, and a share for lamps, wherever they hang. Where that is more than a face can have all get less, so that
/// faces stay apart.
void quick_light(const LitScene& scene, std::uint16_t (&face_light)[6]);

/// The tone that suits an exposure of finished pictures: shadows and corners, which are not in it, take an eighth of
/// a model's light away, and nothing of a sky's.
ToneTable quick_tone(const Look& look, std::uint32_t exposure_q8);

/// Colours with their tone, so that no pass over the picture gives it: exact for the brightest face.
struct QuickLook {
  std::uint16_t face_light[6];
  std::vector<Rgb8> palette;
};
QuickLook quick_look(const Look& look, const ToneTable& tone);

}  // namespace thimble::tools

#endif
