#include "thimble/lit_scene.h"

#include "bits.h"

namespace thimble {
namespace {

constexpr const char* kNames[kEffectCount] = {
    "direct-light", "shadows", "ambient-occlusion", "emission", "mirror", "glass", "media", "water",
    "fog",          "sky",     "depth-cue",
};

}  // namespace

const char* effect_name(EffectSet effect) {
  if (effect == 0 || (effect & (effect - 1)) != 0 || effect > kAllEffects) {
    return "";
  }
  return kNames[bits::lowest_bit(effect)];
}

EffectSet effects_of(const LitScene& scene, const bool (*used)[256]) {
  EffectSet set = kNoEffects;
  const size_t surfaces = scene.surfaces.size < kMaxSurfaces ? scene.surfaces.size : kMaxSurfaces;
  for (size_t material = 0; material < surfaces; ++material) {
    if (used != nullptr && !(*used)[material]) {
      continue;
    }
    const Surface& surface = scene.surfaces[material];
    switch (surface.kind) {
      case SurfaceKind::kDiffuse:
        break;
      case SurfaceKind::kMetal:
        set |= surface.mirror != 0 && scene.bounces != 0 ? kMirror : kNoEffects;
        break;
      case SurfaceKind::kGlass:
        set |= kGlass;
        break;
      case SurfaceKind::kEmit:
        set |= surface.emission_q8 != 0 ? kEmission : kNoEffects;
        break;
      case SurfaceKind::kMedia:
        set |= kMedia;
        break;
    }
  }
  bool shines = false;
  for (const Light& light : scene.lights) {
    shines = shines || light.color_q8[0] != 0 || light.color_q8[1] != 0 || light.color_q8[2] != 0;
  }
  set |= shines ? kDirectLight : kNoEffects;
  set |= shines && scene.has_shadows ? kShadows : kNoEffects;
  set |= scene.occlusion.rays != 0 && scene.occlusion.strength != 0 && scene.occlusion.reach != 0
             ? kAmbientOcclusion
             : kNoEffects;
  set |= scene.has_water && scene.water.width > 0 && scene.water.depth > 0 && scene.water.highest_q8 > 0
             ? kWater
             : kNoEffects;
  set |= scene.fog.density_q16 != 0 ? kFog : kNoEffects;
  set |= scene.has_sky ? kSky : kNoEffects;
  set |= scene.has_depth_cue ? kDepthCue : kNoEffects;
  return set;
}

}  // namespace thimble
