#include "handle.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/scene.h"

namespace thimble::c_face {

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

extern "C" const char* thimble_effect_name(uint32_t effect) {
  return effect_name(effect);
}

extern "C" int32_t thimble_scene_light(const thimble_scene_t* scene, thimble_light_t* light) {
  const BakedScene* const from = held<BakedScene>(scene);
  if (from == nullptr || !stands(light)) {
    return number(Status::kBadArgument);
  }
  BakedLighting opened;
  const Status status =
      BakedLighting::open(from->section(SectionKind::kLighting), from->tree().level(), &opened);
  return hold(status, opened, light);
}

extern "C" uint32_t thimble_light_effects(const thimble_light_t* light) {
  const BakedLighting* const from = held<BakedLighting>(light);
  return from == nullptr ? 0 : from->effects;
}

extern "C" uint32_t thimble_light_lamps(const thimble_light_t* light) {
  const BakedLighting* const from = held<BakedLighting>(light);
  return from == nullptr ? 0 : static_cast<uint32_t>(from->scene.lights.size);
}

extern "C" int32_t thimble_light_lamp(const thimble_light_t* light, uint32_t index, thimble_lamp_t* lamp) {
  const BakedLighting* const from = held<BakedLighting>(light);
  if (from == nullptr || lamp == nullptr) {
    return number(Status::kBadArgument);
  }
  if (index >= from->scene.lights.size) {
    return number(Status::kOutOfRange);
  }
  const Light& one = from->scene.lights[index];
  lamp->is_point = one.is_point ? 1 : 0;
  lamp->place = to_c(Vec3i(one.place));
  for (int channel = 0; channel < 3; ++channel) {
    lamp->color_q8[channel] = one.color_q8[channel];
  }
  lamp->reach = one.reach;
  return number(Status::kOk);
}

}  // namespace thimble::c_face
