#include "scene/lit_setup.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace thimble::tools {

EffectSet expected_effects(const SceneSource& source, const LitDescription& lit, const EffectChoice& choice,
                           UsedMaterials* used) {
  UsedMaterials all;
  std::fill(std::begin(all.is), std::end(all.is), true);
  *used = all;
  const EffectSet most = chosen_effects(lit, all, choice);
  if (most == Effect::kNone || most == chosen_effects(lit, {}, choice)) {
    return most;
  }
  *used = used_materials(source);
  return chosen_effects(lit, *used, choice);
}

LitScene lit_scene_for(const LitDescription& lit, const UsedMaterials& used, EffectSet effects) {
  LitScene scene = lit.drawn(effects);
  if ((effects & Effect::kDirectLight) == 0) {
    scene.lights = {};
  }
  constexpr EffectSet kOfMaterials = Effect::kEmission | Effect::kMirror | Effect::kGlass | Effect::kMedia;
  std::size_t count = 0;
  for (std::size_t i = 0; (effects & kOfMaterials) != 0 && i < scene.surfaces.size; ++i) {
    count = used.is[i] && scene.surfaces[i].kind != SurfaceKind::kDiffuse ? i + 1 : count;
  }
  scene.surfaces.size = count;
  return scene;
}

std::size_t lit_table_bytes(const LitScene& scene) {
  return scene.surfaces.size * sizeof(Surface) + scene.lights.size * sizeof(Light);
}

std::size_t lit_state_bytes(const LitScene& scene, EffectSet effects) {
  return lit_render_bytes(effects) + (effects == Effect::kNone ? 0 : lit_table_bytes(scene));
}

void add_counts(const LitCounts& more, LitCounts* counts) {
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    counts->rays[kind] += more.rays[kind];
    counts->hits[kind] += more.hits[kind];
    counts->node_visits[kind] += more.node_visits[kind];
  }
  counts->step_limited += more.step_limited;
  counts->pending_high_water = std::max(counts->pending_high_water, more.pending_high_water);
}

RenderCounts totals_of(const LitCounts& counts) {
  RenderCounts all;
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    all.rays += counts.rays[kind];
    all.hits += counts.hits[kind];
    all.node_visits += counts.node_visits[kind];
  }
  all.step_limited = counts.step_limited;
  return all;
}

const char* ray_kind_name(LitRayKind kind) {
  constexpr std::array<const char*, kLitRayKinds> kNames{"primary", "shadow", "occlusion", "mirror",
                                                         "glass",   "media",  "water"};
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace thimble::tools
