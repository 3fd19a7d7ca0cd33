/// @file lit_setup.h
/// From a scene's lighting and --effects to what the core's lit renderer gets, and what that takes.
///
/// The set of effects follows from the materials in the built tree; the budget is shared out before there is
/// one. So it goes in two steps:
///
///     LitDescription lit = source.lighting();
///     UsedMaterials used;
///     EffectSet effects = expected_effects(source, lit, choice, &used);
///     lit.expect_glow();
///     ... build, keeping back lit_state_bytes(lit_scene_for(lit, used, effects), effects) ...
///     used = used_materials(built.compact());
///     effects = chosen_effects(lit, used, choice);              // the same, or less
///     lit.find_glow(built.compact());
///     const LitScene scene = lit_scene_for(lit, used, effects);  // views into `lit`
#ifndef THIMBLE_TOOLS_SCENE_LIT_SETUP_H
#define THIMBLE_TOOLS_SCENE_LIT_SETUP_H

#include <cstddef>

#include "scene/lit_description.h"
#include "scene/scene_source.h"
#include "thimble/light/render.h"
#include "thimble/picture/render.h"

namespace thimble::tools {

/// At least the effects that will be chosen once the tree is built, and in `used` at least its materials. The
/// source is streamed only where its materials make a difference.
EffectSet expected_effects(const SceneSource& source, const LitDescription& lit, const EffectChoice& choice,
                           UsedMaterials* used);

/// What these effects need of the scene, and no more, as a baked scene has it too (`lighting_section`):
/// lights where there is direct light, surfaces up to the last used one that is not plain. The spans are
/// those of `lit`, or of a constant.
LitScene lit_scene_for(const LitDescription& lit, const UsedMaterials& used, EffectSet effects);

/// Bytes of the tables of surfaces and lights.
std::size_t lit_table_bytes(const LitScene& scene);
/// Bytes that drawing keeps besides tree and band: the renderer's state and the tables. `render_bytes()`
/// without effects.
std::size_t lit_state_bytes(const LitScene& scene, EffectSet effects);

/// Adds what another thread counted.
void add_counts(const LitCounts& more, LitCounts* counts);

/// Of rays of every kind together.
RenderCounts totals_of(const LitCounts& counts);

/// "primary", "shadow", "occlusion", "mirror", "glass", "media", "water".
const char* ray_kind_name(LitRayKind kind);

}  // namespace thimble::tools

#endif
