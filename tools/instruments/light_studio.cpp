#include "instruments/light_studio.h"

#include <algorithm>
#include <array>

#include "readers/source.h"

namespace thimble::tools {

std::string LightSetting::text() const {
  std::string result;
  const auto add = [&](const char* name, int value) {
    if (value >= 0) {
      result += (result.empty() ? "" : ", ") + std::string(name) + " " + std::to_string(value);
    }
  };
  add("occlusion rays", occlusion_rays);
  add("roughness rays", roughness_rays);
  add("bounces", bounces);
  return result;
}

LightStudio::LightStudio(const SceneSource& source, const BuiltScene& built, const EffectChoice& choice,
                         const Camera& camera, const Shading& shading)
    : built_(built), camera_(camera), shading_(shading), lit_(source.lighting()), polished_(lit_) {
  const UsedMaterials used = used_materials(built.compact());
  effects_ = chosen_effects(lit_, used, choice);
  lit_.find_glow(built.compact());
  polished_.find_glow(built.compact());
  const LitScene scene = lit_.drawn(effects_);
  if ((effects_ & Effect::kAmbientOcclusion) != 0) {
    own_.occlusion_rays = scene.occlusion.rays;
  }
  if ((effects_ & Effect::kBranching) != 0) {
    own_.bounces = scene.bounces;
  }
  for (std::size_t material = 0; material < lit_.surfaces.size(); ++material) {
    const Surface& surface = lit_.surfaces[material];
    if ((effects_ & Effect::kMirror) != 0 && used.is[material] && surface.kind == SurfaceKind::kMetal &&
        surface.roughness != 0) {
      own_.roughness_rays = 4;
    }
  }
  for (Surface& surface : polished_.surfaces) {
    surface.roughness = 0;
  }
}

LightSetting LightStudio::best() const {
  LightSetting setting = own_;
  setting.occlusion_rays = own_.occlusion_rays < 0 ? -1 : 32;
  setting.bounces = own_.bounces < 0 ? -1 : kMaxBounces;
  return setting;
}

std::vector<LightTrial> LightStudio::trials() const {
  std::vector<LightTrial> result;
  if (own_ == LightSetting{}) {
    return result;
  }
  const auto add = [&](const char* group, const LightSetting& setting) {
    if (std::none_of(result.begin(), result.end(),
                     [&](const LightTrial& trial) { return trial.setting == setting; })) {
      result.push_back({group, setting});
    }
  };
  struct LightKnob {
    const char* key;
    int LightSetting::*value;
    std::vector<int> alone;
    std::vector<int> together;
  };
  const std::array<LightKnob, 3> knobs{{
      {"occlusion_rays", &LightSetting::occlusion_rays, {0, 4, 8, 16, 32}, {0, 4, 8, 32}},
      {"roughness_rays", &LightSetting::roughness_rays, {1, 4}, {1, 4}},
      {"bounces", &LightSetting::bounces, {0, 1, 2, 3, 4, 6, 8}, {0, 1, 2, 4, 8}},
  }};
  add("default", own_);
  std::vector<LightSetting> together{own_};
  for (const LightKnob& knob : knobs) {
    if (own_.*knob.value < 0) {
      continue;
    }
    for (const int value : knob.alone) {
      LightSetting setting = own_;
      setting.*knob.value = value;
      add(knob.key, setting);
    }
    std::vector<LightSetting> next;
    for (const LightSetting& setting : together) {
      for (const int value : knob.together) {
        next.push_back(setting);
        next.back().*knob.value = value;
      }
    }
    together = std::move(next);
  }
  for (const LightSetting& setting : together) {
    add("together", setting);
  }
  add("best", best());
  return result;
}

void LightStudio::draw(const LightSetting& setting, std::vector<std::uint8_t>* pixels,
                       RenderCounts* counts) const {
  const LitDescription& lit = setting.roughness_rays == 1 ? polished_ : lit_;
  EffectSet effects = effects_;
  LitScene scene = lit.drawn(effects);
  if (setting.occlusion_rays >= 0) {
    scene.occlusion.rays = static_cast<std::uint8_t>(setting.occlusion_rays);
  }
  if (setting.occlusion_rays == 0) {
    effects &= ~Effect::kAmbientOcclusion;
  }
  if (setting.bounces >= 0) {
    scene.bounces = static_cast<std::uint8_t>(setting.bounces);
  }
  Band band;
  band.pixels = {pixels->data(), pixels->size()};
  band.format = PixelFormat::kRgb888;
  band.rows = camera_.height_px();
  LitCounts lit_counts;
  if (render_lit_band(effects, built_.compact(), camera_, shading_, scene, band, &lit_counts) !=
      Status::kOk) {
    throw InputError("its light cannot be drawn: too many lights, or rays of this camera that are too long");
  }
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    counts->rays += lit_counts.rays[kind];
    counts->hits += lit_counts.hits[kind];
    counts->node_visits += lit_counts.node_visits[kind];
  }
}

}  // namespace thimble::tools
