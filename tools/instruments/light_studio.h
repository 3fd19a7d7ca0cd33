/// @file light_studio.h
/// The knobs of light in one view of a scene: rays of ambient occlusion, rays of rough metal, bounces. Only
/// those that the scene calls for.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_LIGHT_STUDIO_H
#define THIMBLE_TOOLS_INSTRUMENTS_LIGHT_STUDIO_H

#include <cstdint>
#include <string>
#include <vector>

#include "scene/built_scene.h"
#include "scene/lit_description.h"
#include "scene/scene_source.h"
#include "thimble/light/render.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

/// Where they stand. -1: the scene does not call for it.
struct LightSetting {
  int occlusion_rays = -1;  ///< a hit: 0, 4, 8, 16 or 32
  int roughness_rays = -1;  ///< a ray that meets rough metal: 4, or 1 as if it were polished
  int bounces = -1;         ///< 0 .. kMaxBounces
  friend bool operator==(const LightSetting&, const LightSetting&) = default;

  /// "occlusion rays 8, bounces 4".
  std::string text() const;
};

struct LightTrial {
  std::string group;  ///< "default", the knob that is turned alone, "together" or "best" where no other is it
  LightSetting setting;
};

/// Draws lit pictures of a compact tree, which stays the caller's.
class LightStudio {
 public:
  LightStudio(const SceneSource& source, const BuiltScene& built, const EffectChoice& choice,
              const Camera& camera, const Shading& shading);

  EffectSet effects() const { return effects_; }
  /// Every knob at its best.
  LightSetting best() const;
  /// All that the study tries, each once; none where no effect has a knob.
  std::vector<LightTrial> trials() const;
  /// Draws the whole picture into `pixels`, rows of kRgb888 without gaps, which are that large.
  /// `counts->step_limited` stays as it is. Throws InputError when the scene cannot be drawn.
  void draw(const LightSetting& setting, std::vector<std::uint8_t>* pixels, RenderCounts* counts) const;

 private:
  const BuiltScene& built_;
  Camera camera_;
  Shading shading_;
  LitDescription lit_;
  LitDescription polished_;
  EffectSet effects_ = Effect::kNone;
  LightSetting own_;
};

}  // namespace thimble::tools

#endif
