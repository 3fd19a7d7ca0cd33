/// @file baked_lighting.h
/// Surfaces, lights, sky, fog and water of a baked scene, opened where they lie. src/FORMAT.md has the bytes.
///
/// Apart from baked_scene.h, so that a program that draws no light links none of this:
///
///     BakedLighting lighting;
///     const ConstBytes bytes = scene.section(SectionKind::kLighting);
///     if (BakedLighting::open(bytes, scene.tree().level(), &lighting) == Status::kOk) ...
#ifndef THIMBLE_LIGHT_BAKED_LIGHTING_H
#define THIMBLE_LIGHT_BAKED_LIGHTING_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "scene.h"

namespace thimble {

/// The version of the section that is written, and the only one that is read (src/FORMAT.md, "Versions").
inline constexpr uint8_t kLightingVersion = 1;
/// Bytes before the tables of surfaces and lights.
inline constexpr size_t kLightingHeadBytes = 64;
/// Components of a distant light's direction are at most this.
inline constexpr int32_t kMaxLightComponent = int32_t{1} << 14;

/// Bytes of the section for `scene`: 64 + 12 a surface + 21 a light. 0 when there are too many of either.
size_t lighting_bytes(const LitScene& scene);

struct BakedLighting {
  /// `surfaces` and `lights` lie in the section's bytes; `water` is at rest. Every number is within the
  /// limits of scene.h.
  LitScene scene;
  /// What the scene was baked for: the effects that it calls for, or those that somebody chose. A firmware
  /// image reads the same set from the header that `thimble bake` generates, when it is compiled.
  EffectSet effects = Effect::kNone;

  /// Writes the section to the front of `to`. Water is written as it is at rest (`highest_q8`; its heights
  /// are not kept). `kOutOfMemory` when it does not fit, and nothing is written; `kBadArgument` when `open`
  /// would refuse it (the bytes are then of no use).
  static Status make(const BakedLighting& lighting, int level, Bytes to);

  /// Looks at every number of a section in a world of 2^level (1 .. kMaxLevel, in all three), at most 256
  /// surfaces and 100 lights.
  /// `kDamaged`, with `*lighting` as it was: no section (no bytes), another version, tables that are not as
  /// long as they should be, a number beyond its limits. Safe for any bytes.
  static Status open(ConstBytes section, int level, BakedLighting* lighting);

  /// The same, as a short English phrase that says what is wrong, or nullptr. `place` (may be null) gets the
  /// offset of the field concerned.
  static const char* validate(ConstBytes section, int level, uint32_t* place = nullptr);
};

}  // namespace thimble

#endif
