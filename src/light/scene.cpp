#include "thimble/light/scene.h"

#include "../base/bits.h"

namespace thimble {
namespace {

constexpr const char* kNames[Effect::kCount] = {
    "direct-light",  "shadows",   "ambient-occlusion",
    "emission",      "mirror",    "glass",
    "media",         "water",     "fog",
    "sky",           "depth-cue", "smooth-normals",
    "emitter-light", "edges",     "ripples",
};

}  // namespace

const char* effect_name(EffectSet effect) {
  if (effect == 0 || (effect & (effect - 1)) != 0 || effect > Effect::kAll) {
    return "";
  }
  return kNames[bits::lowest_bit(effect)];
}

EffectSet effects_of(const LitScene& scene, const bool (*used)[256]) {
  EffectSet set = Effect::kNone;
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
        set |= surface.mirror != 0 && scene.bounces != 0 ? Effect::kMirror : Effect::kNone;
        break;
      case SurfaceKind::kGlass:
        set |= Effect::kGlass;
        break;
      case SurfaceKind::kEmit:
        set |= surface.emission_q8 != 0 ? Effect::kEmission : Effect::kNone;
        break;
      case SurfaceKind::kMedia:
        set |= Effect::kMedia;
        break;
    }
  }
  bool shines = false;
  for (const Light& light : scene.lights) {
    shines = shines || light.color_q8[0] != 0 || light.color_q8[1] != 0 || light.color_q8[2] != 0;
  }
  set |= shines ? Effect::kDirectLight : Effect::kNone;
  set |= shines && scene.has_shadows ? Effect::kShadows : Effect::kNone;
  set |= scene.occlusion.rays != 0 && scene.occlusion.strength != 0 && scene.occlusion.reach != 0
             ? Effect::kAmbientOcclusion
             : Effect::kNone;
  set |= scene.has_water && scene.water.width > 0 && scene.water.depth > 0 && scene.water.highest_q8 > 0
             ? Effect::kWater
             : Effect::kNone;
  set |= scene.fog.density_q16 != 0 ? Effect::kFog : Effect::kNone;
  set |= scene.has_sky ? Effect::kSky : Effect::kNone;
  set |= scene.has_depth_cue ? Effect::kDepthCue : Effect::kNone;
  return set;
}

}  // namespace thimble
