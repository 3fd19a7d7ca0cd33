/// Scenes of any light, and the same lit picture by the core and by streams of rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "support/wide_cases.h"
#include "wide/lit/lit_renderer.h"

namespace thimble::tests {

/// What light does in a scene of the world; the vectors hold what `scene` refers to, so it moves but is not copied.
struct LitCase {
  LitScene scene;
  EffectSet effects = Effect::kNone;
  LitOptions options;
  std::vector<Surface> surfaces;
  std::vector<Light> lights;
  std::vector<std::int32_t> heights;

  LitCase() = default;
  LitCase(LitCase&&) = default;
  LitCase& operator=(LitCase&&) = default;
};

/// Any surfaces, lights, water, air and effects.
LitCase random_light(std::mt19937_64& random, int level);
/// Boxes and voxels of all materials close together, so that rays go far.
WideScene cabinet(std::mt19937_64& random);

struct LitDrawn {
  std::vector<std::uint8_t> pixels;
  LitCounts counts;
};

LitDrawn draw_lit_core(const WideScene& scene, const FrameCase& frame, const LitCase& lit);
LitDrawn draw_lit_streams(const WideScene& scene, const wide::RayMap& map, const FrameCase& frame,
                          const LitCase& lit, std::size_t workspace_bytes, int threads);

}  // namespace thimble::tests
