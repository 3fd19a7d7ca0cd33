#include "kinds.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/scene.h"

namespace thimble::c_face {

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
