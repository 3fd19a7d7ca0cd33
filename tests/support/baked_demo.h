/// Scenes, baked as the boards get them: above all the demonstration's.
#pragma once

#include <optional>
#include <string>

#include "scene/baking.h"

namespace thimble::tests {

/// Under its own words, with its camera where it has one.
inline tools::Baked bake_words(const std::string& scene, tools::BakingOptions options = {}) {
  const auto source = tools::open_scene({.scene = scene, .depth = std::nullopt});
  options.name = scene;
  if (source->camera() != nullptr) {
    options.camera = [&source](const CompactTree&) { return *source->camera(); };
  }
  return tools::bake_scene(*source, options);
}

inline tools::Baked bake_demo(EffectSet effects, bool has_map = false) {
  tools::BakingOptions options;
  options.effects = {effects == Effect::kNone, effects};
  options.brick_map = has_map;
  return bake_words("demo", options);
}

/// Without effects.
inline const tools::Baked& demo_scene() {
  static const tools::Baked baked = bake_demo(Effect::kNone);
  return baked;
}

}  // namespace thimble::tests
