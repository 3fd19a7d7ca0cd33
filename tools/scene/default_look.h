/// The rule for a picture that nobody described further: what a scene has decides how it looks. The one home
/// of the rule; `thimble render --help` prints kDefaultLookText, `--verbose` prints what came of it.
///
/// From a scene to a picture:
///
///     SceneShape shape = shape_of(built);                          // scene_shape.h
///     Framing framing = frame_scene(view_wishes, source, shape);   // framing.h
///     SceneFacts facts = facts_of(source, shape);
///     Look look = default_look(facts, wishes, framing);
///     LookMeasure measured = measure_look(canvas);                 // look_picture.h: exposure, samples
///
/// Another camera of the same scene needs only the last three lines; the facts stay.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/backdrop.h"
#include "scene/framing.h"
#include "scene/lit_description.h"
#include "scene/scene_shape.h"

namespace thimble::tools {

class SceneSource;

/// Points form a surface where at least this share of them, in per cent, have kSurfaceNeighbours neighbours
/// or more among the 26 places around.
inline constexpr int kSurfaceShare = 50;
inline constexpr int kSurfaceNeighbours = 3;

/// The rule in words, for help.
extern const char* const kDefaultLookText;

/// What a scene has.
struct SceneFacts {
  bool has_colors = false;       ///< a palette, or colours of points or corners
  bool is_points = false;        ///< strewn voxels
  bool is_mesh = false;          ///< triangles, or heights: a slope
  int surface_share = 100;       ///< of points: per cent with enough neighbours
  bool has_round_glass = false;  ///< or polished metal: balls, not panes
  LitDescription lighting;       ///< what the scene itself states
  UsedMaterials used;
  std::vector<Rgb8> palette;
  VoxelBox bounds;

  bool forms_surface() const { return !is_points || surface_share >= kSurfaceShare; }
};

/// Before anything is built: at least the materials that will be used, and points taken for a surface.
SceneFacts facts_expected(const SceneSource& source, const LitDescription& lighting);
/// Of what was built. For points it looks at up to 4,096 of them, spread evenly, and the places around.
SceneFacts facts_of(const SceneSource& source, const LitDescription& lighting, const SceneShape& shape);

/// What a baked scene keeps of them, before anything of the rule's was added.
LookNote note_of(const SceneFacts& facts);

/// "none", "gradient" or six hex digits. False for anything else.
bool parse_background(std::string_view text, Background* background);

/// What somebody wished of a look; the rest is the rule's.
struct LookWishes {
  Background background;
  std::optional<bool> ground;  ///< else where the sun is the rule's
  int across = 0;              ///< samples a pixel are its square; 0: the rule's
  bool at_edges = false;       ///< samples where edges are (edge_rows.h); `across` is then kEdgeGrid
  std::optional<bool>
      smooth;  ///< slopes instead of the faces of voxels; else for meshes, surfaces of points and round glass
};

enum class LookKind : std::uint8_t {
  kLit,    ///< light on surfaces
  kStars,  ///< points that shine
};

struct Look {
  LookKind kind = LookKind::kLit;
  /// kLit: surfaces, lights and the rest, at two thirds of their brightness (`dim`).
  LitDescription lighting;
  EffectSet effects = Effect::kNone;
  UsedMaterials used;
  std::vector<Rgb8> palette;
  bool has_own_colors = false;  ///< else stars take theirs from how far they are
  /// Whether the background stands behind the scene; otherwise the core draws air, water or sky there.
  bool has_backdrop = true;
  Background background;
  Ground ground;
  int across = 1;         ///< samples a pixel are its square; by the rule 2, until the rays of that are known
  bool at_edges = false;  ///< samples where edges are, on a camera of `across` times the pixels
  std::string text;       ///< what was chosen and why, but for the samples

  /// Views into `lighting`.
  LitScene lit_scene() const;
};

/// The rule. A function of its arguments alone, the same on every machine.
Look default_look(const SceneFacts& facts, const LookWishes& wishes, const Framing& framing);

/// Meshes and surfaces without colours.
inline constexpr Rgb8 kClay{214, 186, 162};
inline bool is_clay(const SceneFacts& facts) {
  return !facts.has_colors && facts.forms_surface();
}

/// Whether the scene says how it is lit: then the rule adds no sun and no ground.
bool states_light(const LitDescription& lighting);

/// What is baked of the rule for a scene without lights of its own: its colours, the sun and exact shadows, slopes of
/// meshes and of surfaces of points; no more than a small chip draws. Stars stay as they are.
LitDescription baked_look(const SceneFacts& facts, const Framing& framing);
/// What stands behind what `baked_look` lights, and what its glass and mirrors show: a sky in the colours of the
/// gradient, for displays of many colours. False where the scene has one, wants none, or is stars.
bool add_baked_sky(const SceneFacts& facts, LitDescription* lighting);

// A look while the camera moves: what costs no rays of its own, about as bright as the finished picture.

/// What of a look's effects is drawn then.
inline constexpr EffectSet kQuickEffects = Effect::kDirectLight | Effect::kEmission | Effect::kWater |
                                           Effect::kFog | Effect::kSky | Effect::kDepthCue;

/// The light of a face in the open, for pictures without shadows: what comes from everywhere, the suns by their
/// angles, and a share for lamps, wherever they hang. Where that is more than a face can have all get less, so that
/// faces stay apart.
void quick_light(const LitScene& scene, std::uint16_t (&face_light)[6]);

/// The tone that suits an exposure of finished pictures: shadows and corners, which are not in it, take an eighth of
/// a model's light away, and nothing of a sky's.
ToneTable quick_tone(const Look& look, std::uint32_t exposure_q8);

/// Colours with their tone, so that no pass over the picture gives it: exact for the brightest face.
struct QuickLook {
  std::uint16_t face_light[6];
  std::vector<Rgb8> palette;
};
QuickLook quick_look(const Look& look, const ToneTable& tone);

}  // namespace thimble::tools
