/// What light does in a scene, as a source has it: surfaces of all palette entries, lights, sky, water. The
/// one home of the conversions into the core's `LitScene`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "readers/oct.h"
#include "readers/source.h"
#include "thimble/base/memory.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
#include "thimble/picture/render.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

/// Lamps that a scene's glow is put together to, at the most.
inline constexpr std::size_t kMostGlowLamps = 16;

/// Lamps, at most `most`, for the faces of glowing voxels (SurfaceKind::kEmit) that show: one for each cube of
/// 2^k voxels a side that has such faces, k the least with which they are few enough. A lamp stands in the
/// middle of its faces, or before them where they look one way; has reach 1, the brightness A / pi * (1 +
/// the share in which they look one way) for A faces of brightness 1; and shines alike all around. That is
/// four times the light that such faces send: one for what arrives straight, three for what a room's walls
/// throw to and fro, which is not traced. Brightness above 255 is cut off.
std::vector<Light> glow_lamps(const CompactTree& tree, const std::vector<Surface>& surfaces,
                              std::size_t most = kMostGlowLamps);

class SceneSource;

/// Which palette entries occur in all that a source streams, by streaming it (a baked one's by its tree). What is
/// covered later counts too.
UsedMaterials used_materials(const SceneSource& source);

struct LitDescription {
  /// By palette index, all 256 of them.
  std::vector<Surface> surfaces = std::vector<Surface>(kMaxSurfaces);
  std::vector<Light> lights;
  /// What the scene's author calls them, where he does.
  std::map<std::uint8_t, std::string> material_names;
  /// All the rest; its spans are empty.
  LitScene rest;
  /// Effects that the scene's author turned on or off, whatever materials and lights call for.
  EffectSet on = Effect::kNone;
  EffectSet off = Effect::kNone;

  /// The scene says how bright it is where no light shines: without lights it gets no sun made up.
  bool has_own_ambient = false;
  bool has_baked_glow = false;  ///< its lamps are among the lights
  /// `lights`, and lamps for what glows once `find_glow` has looked for it.
  std::vector<Light> lights_and_glow;

  /// A view of it all, as long as this lives and keeps its vectors.
  LitScene lit_scene() const;
  /// The same as these effects draw it: with lamps for what glows (Effect::kEmitterLight), with_defaults.
  LitScene drawn(EffectSet effects) const;
  /// Looks for what glows in the tree. Of a baked scene the lamps are among the lights already.
  void find_glow(const CompactTree& tree);
  /// "glow", or "5" for one without a name.
  std::string name_of(std::uint8_t material) const;
  /// Before there is a tree: room for as many lamps as there may be.
  void expect_glow();
};

/// What a material of a file does with light. Parameters beyond what the core takes are clamped: roughness
/// and shares to 0..1, the index of refraction to 1..4, density and emission to 16 bits in 1/256; NaN counts
/// as the least. `.vox` parameters mean:
///   metal   share mirrored: metalness, or the weight where there is none
///   glass   density: halvings a voxel of a channel that its colour lacks; from attenuation and opacity
///   emit    emission (or the weight) times 2^flux
///   media   density d as exp(-d) a voxel, 1.44 d halvings
Surface surface_of(const Material& material);
/// What the colour of a surface and its kind are to those who know palettes only.
Material material_of(const Surface& surface);

/// The colours alone.
std::vector<Rgb8> colors_of(const Palette& palette);

/// Surfaces of a whole palette and nothing else: no light, no sky.
LitDescription describe_palette(const Palette& palette);
/// The same as light of its own, with no other light.
LitDescription describe_unlit(const Palette& palette);

/// Throws InputError where that is the status of drawing light.
void check_lit_limits(Status status);

/// What a baked scene holds, with the rest of its palette as plain surfaces. The set that it was baked for is
/// what it calls for, no more and no less.
LitDescription describe_baked(const BakedLighting& lighting, const Palette& palette);

/// The effects that `used` materials and the rest call for (`effects_of`), with what the author turned on and
/// without what he turned off. Shadows need direct light: they come and go with it. What glows
/// (Effect::kEmission) calls for Effect::kEmitterLight, which comes with direct light and shadows, and goes
/// with emission or direct light.
EffectSet called_for(const LitDescription& lit, const UsedMaterials& used);

/// What --effects says.
struct EffectChoice {
  bool automatic = true;
  EffectSet effects = Effect::kNone;  ///< unless automatic
  bool on_top = false;                ///< "all": they come on top of what the scene calls for
  std::optional<bool> smooth{};       ///< --normals: with Effect::kSmoothNormals, or without
  bool is_given = false;  ///< somebody said so; "auto" then adds nothing to what the scene calls for
};
/// What --effects, --normals and --bounces say.
struct EffectWishes {
  EffectChoice choice;
  std::optional<std::uint8_t> bounces;

  /// Whether effects are named.
  bool named() const {
    return (!choice.automatic && choice.effects != Effect::kNone) || choice.smooth == true;
  }
  /// A scene's lighting with --bounces for its own.
  LitDescription lighting(LitDescription lit) const;
};
/// "auto", "none", "all" or names of effects with commas between them, "ao" for ambient-occlusion; nothing for
/// anything else. "all" is what the scene calls for and what every scene can have: direct light, shadows,
/// occlusion, glow that lights its neighbours, and smooth normals.
std::optional<EffectChoice> parse_effects(std::string_view text);
/// The names of a set's effects with commas between them; "none" for the empty one.
std::string effects_text(EffectSet effects);
/// The names of the set, in the order of the bits.
std::vector<std::string> effect_list(EffectSet effects);
/// All names, for help and errors.
std::string effect_names();

/// The set that is drawn: what the scene calls for, or what was named. Shadows that are named bring direct
/// light along, emitter light these and emission.
EffectSet chosen_effects(const LitDescription& lit, const UsedMaterials& used, const EffectChoice& choice);

/// `scene` with something to show for each effect of the set: a sun where direct light has no lights (but
/// for `sunless` scenes), shadows, a sky, 8 rays of occlusion, fog that halves light in 64 voxels, a depth cue. What effects of
/// materials and water need cannot be made up: they stay without work. The result's spans are those of
/// `scene`, or of a constant.
LitScene with_defaults(LitScene scene, EffectSet effects, bool sunless = false);

/// The section of a baked scene (`SectionKind::kLighting`) with what these effects need and no more; empty
/// where that is nothing. Surfaces reach up to the last used material that is not plain; the palette has the
/// rest. Throws InputError when a number is beyond the core's limits.
std::vector<std::uint8_t> lighting_section(const LitDescription& lit, const UsedMaterials& used,
                                           EffectSet effects, int level);

// From the core's brightness to a finished picture: exposure and a shoulder, in integers.
//
// Light is drawn at two thirds, so that what is half again as bright as white is still told apart. A table
// of 256 entries then brightens it by the exposure, straight up to a knee and gently on towards white, so
// that no colour is cut off.

/// All that shines, at two thirds: lights, ambient, what glows, sky, fog and clouds.
void dim(LitDescription* lighting, const UsedMaterials& used);

/// All that shines, so many 256ths as bright: what `dim` dims.
void expose_light(std::uint32_t exposure_q8, const UsedMaterials& used, LitDescription* lighting);

// What a baked scene keeps of the scene that it was made from, so that its picture without another word is the one of
// the scene itself: the section of kind `SectionKind::kLook` (src/FORMAT.md). The core never reads it.

struct LookNote {
  bool is_mesh = false;
  bool is_points = false;
  bool has_colors = false;
  bool has_own_light = false;    ///< lights, ambient and shadows are the scene's, not of default_look.h
  bool has_own_sky = false;      ///< so is the sky, if there is one
  EffectSet on = Effect::kNone;  ///< what the scene's author turned on and off
  EffectSet off = Effect::kNone;
};

/// The section's 12 bytes, and back. What is not of this version and size says nothing.
std::vector<std::uint8_t> look_section(const LookNote& note);
std::optional<LookNote> read_look_note(ConstBytes section);

/// The lighting of a baked scene without what the rule added. What glows is to be looked for again.
LitDescription without_rule(const LookNote& note, LitDescription baked);

// From a scene's lighting and --effects to what the core's lit renderer gets, and what that takes.
//
// The set of effects follows from the materials in the built tree; the budget is shared out before there is
// one. So it goes in two steps:
//
//     LitDescription lit = source.lighting();
//     UsedMaterials used;
//     EffectSet effects = expected_effects(source, lit, choice, &used);
//     lit.expect_glow();
//     ... build, keeping back lit_state_bytes(lit_scene_for(lit, used, effects), effects) ...
//     used = used_materials(built.compact());
//     effects = chosen_effects(lit, used, choice);              // the same, or less
//     lit.find_glow(built.compact());
//     const LitScene scene = lit_scene_for(lit, used, effects);  // views into `lit`

/// At least the effects that will be chosen once the tree is built, and in `used` at least its materials. The
/// source is streamed only where its materials make a difference.
EffectSet expected_effects(const SceneSource& source, const LitDescription& lit, const EffectChoice& choice,
                           UsedMaterials* used);

/// What these effects need of the scene, and no more, as a baked scene has it too (`lighting_section`):
/// lights where there is direct light, surfaces up to the last used one that is not plain. The spans are
/// those of `lit`, or of a constant.
LitScene lit_scene_for(const LitDescription& lit, const UsedMaterials& used, EffectSet effects);

/// Bytes that drawing keeps besides tree and band: the renderer's state, and the tables of surfaces and lights.
/// `render_bytes()` without effects.
std::size_t lit_state_bytes(const LitScene& scene, EffectSet effects);

/// Of rays of every kind together.
RenderCounts totals_of(const LitCounts& counts);

/// "primary", "shadow", "occlusion", "mirror", "glass", "media", "water".
const char* ray_kind_name(LitRayKind kind);

}  // namespace thimble::tools
