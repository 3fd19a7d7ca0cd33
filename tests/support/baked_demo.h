/// The demonstration's scene, baked as the boards get it.
#pragma once

#include <optional>

#include "scene/baking.h"

namespace thimble::tests {

inline tools::Baked bake_demo(EffectSet effects, bool has_map = false) {
  const auto source = tools::open_scene({.scene = "demo", .depth = std::nullopt});
  tools::BakingOptions options;
  options.effects = {effects == Effect::kNone, effects};
  options.name = "demo";
  options.brick_map = has_map;
  options.camera = [&source](const CompactTree&) { return *source->camera(); };
  return tools::bake_scene(*source, options);
}

/// Without effects.
inline const tools::Baked& demo_scene() {
  static const tools::Baked baked = bake_demo(Effect::kNone);
  return baked;
}

}  // namespace thimble::tests
