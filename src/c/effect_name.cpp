#include "thimble/light/scene.h"
#include "thimble/thimble_c.h"

namespace thimble {

static_assert(THIMBLE_EFFECT_DIRECT_LIGHT == Effect::kDirectLight &&
              THIMBLE_EFFECT_SHADOWS == Effect::kShadows &&
              THIMBLE_EFFECT_AMBIENT_OCCLUSION == Effect::kAmbientOcclusion &&
              THIMBLE_EFFECT_EMISSION == Effect::kEmission && THIMBLE_EFFECT_MIRROR == Effect::kMirror &&
              THIMBLE_EFFECT_GLASS == Effect::kGlass && THIMBLE_EFFECT_MEDIA == Effect::kMedia &&
              THIMBLE_EFFECT_WATER == Effect::kWater && THIMBLE_EFFECT_FOG == Effect::kFog &&
              THIMBLE_EFFECT_SKY == Effect::kSky && THIMBLE_EFFECT_DEPTH_CUE == Effect::kDepthCue &&
              THIMBLE_EFFECT_SMOOTH_NORMALS == Effect::kSmoothNormals &&
              THIMBLE_EFFECT_EMITTER_LIGHT == Effect::kEmitterLight &&
              THIMBLE_EFFECT_EDGES == Effect::kEdges && THIMBLE_EFFECT_RIPPLES == Effect::kRipples);
static_assert(Effect::kCount == 15, "enum thimble_effects lacks an effect");

}  // namespace thimble

extern "C" const char* thimble_effect_name(uint32_t effect) {
  return thimble::effect_name(effect);
}
