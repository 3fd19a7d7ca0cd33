/// What each effect of a scene costs: the frame with it beside the frame without it.
///
/// An effect's figures are those of the scene's whole set of effects less those of the set without it. Since
/// shadows need direct light, direct light is judged between two frames without shadows. What a scene does
/// not call for is not drawn with, and costs 0.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "instruments/timed_frames.h"
#include "scene/framing.h"
#include "scene/lit_description.h"
#include "scene/scene_source.h"
#include "thimble/light/render.h"

namespace thimble::tools {

struct EffectsOptions {
  ViewWishes view;
  EffectWishes effects;
  int frames = 5;  ///< of each set of effects, by turns; at least 1
};

struct EffectRow : MedianTime {  ///< times: of the differences, frame by frame
  EffectSet effect = Effect::kNone;
  bool called_for = false;  ///< if not, all below is 0 and empty
  std::string why;          ///< in words: which material, light or line of the scene
  EffectSet with = Effect::kNone;
  EffectSet without = Effect::kNone;
  std::array<std::int64_t, kLitRayKinds> rays{};  ///< more with it than without, by kind
  std::int64_t node_visits = 0;                   ///< the same, of all kinds
  double with_ms = 0;                             ///< medians of the frames
  double without_ms = 0;
  /// State and tables (lit_state_bytes), without `EffectsStudy::base_ram_bytes`.
  std::uint64_t ram_bytes = 0;
  /// On lm3s6965evb, without `base_flash_bytes` (platform/boards/effect_flash.h).
  std::uint64_t flash_bytes = 0;

  std::int64_t all_rays() const;
};

struct EffectsStudy {
  EffectSet effects = Effect::kNone;
  std::array<EffectRow, Effect::kCount> rows;  ///< in the order of the bits
  LitCounts lit;                               ///< the whole frame
  LitCounts plain;                             ///< the frame without effects
  double lit_ms = 0;
  double plain_ms = 0;
  /// What the first effect costs beside its own: nothing where there is none.
  std::uint64_t base_ram_bytes = 0;
  std::uint64_t base_flash_bytes = 0;
  std::uint64_t state_bytes = 0;  ///< all of it, as --memory counts it
  std::string note;
};

/// Builds the scene, draws and measures. Throws InputError.
EffectsStudy study_effects(const SceneSource& source, const EffectsOptions& options,
                           const Progress& progress);

}  // namespace thimble::tools
