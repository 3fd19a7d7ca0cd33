/// `.scene`: a scene as a person writes it, a statement a line. src/FORMAT.md describes the language.
///
/// This reader turns text into what it says and opens no other file; `scene/text_scene.cpp` opens the models
/// and puts the world together. Every error names line and column; both count from 1, a column is a character
/// of UTF-8.
#pragma once

#include <optional>

#include "readers/source.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/scene.h"

namespace thimble::tools {

/// Limits of one file.
inline constexpr std::size_t kSceneTextBytes = std::size_t{1} << 20;
inline constexpr std::size_t kSceneTextMaterials = 256;
inline constexpr std::size_t kSceneTextParts = 4096;
/// Corners and places of voxels, in either direction.
inline constexpr std::int32_t kSceneTextReach = 16384;

/// Where something stands in the file.
struct TextPlace {
  std::uint32_t line = 0;
  std::uint32_t column = 0;
};
/// Throws InputError "line L, column C: SENTENCE", a sentence of these pieces.
template <class... Pieces>
[[noreturn]] void fail_at(const TextPlace& place, const Pieces&... pieces) {
  throw InputError("line ", place.line, ", column ", place.column, ": ", pieces...);
}
/// Throws it where `is_wrong`.
template <class... Pieces>
void fail_if(bool is_wrong, const TextPlace& place, const Pieces&... pieces) {
  fail_if(is_wrong, "line ", place.line, ", column ", place.column, ": ", pieces...);
}

struct SceneText {
  struct NamedSurface {
    std::string name;
    bool has_color = false;  ///< otherwise what it replaces in a model keeps its own colour
    Surface surface;
    TextPlace place;
  };

  enum class PartKind : std::uint8_t { kModel, kBox, kBall };
  struct Part {
    PartKind kind = PartKind::kModel;
    TextPlace place;  ///< of the statement

    // Boxes and balls.
    std::size_t material = 0;    ///< index into `materials`
    Vec3i low;                   ///< box: voxels low .. high - 1
    Vec3i high;                  ///< box
    Vec3Q8 center;               ///< ball
    std::int32_t radius_q8 = 0;  ///< ball, at least a voxel

    // Models.
    std::string file;  ///< path relative to the scene's own folder, or a generator
    TextPlace file_place;
    Vec3i at;  ///< where the lowest corner of its box goes, once turned
    /// Turned voxel i = sign[i] > 0 ? v[axis[i]] : size[axis[i]] - 1 - v[axis[i]].
    std::array<std::uint8_t, 3> axis{0, 1, 2};
    std::array<std::int8_t, 3> sign{1, 1, 1};
    bool crop = false;  ///< what leaves the world is cut off rather than an error
    std::optional<int> depth;
    bool as_voxels = false;
    bool z_up = false;
    /// For each palette index of the model the material that takes its place, or -1.
    std::array<std::int16_t, 256> replaced{};
    bool replaces = false;
  };

  struct PlacedLight {
    Light light;
    TextPlace place;
  };

  std::optional<int> depth;
  std::vector<NamedSurface> materials;
  std::vector<Part> parts;  ///< in the file's order: the last one wins where they overlap
  std::optional<SceneCamera> camera;
  TextPlace camera_place;
  std::vector<PlacedLight> lights;
  /// Ambient, sky, fog, occlusion, bounces, flags, the water's material. Spans and water stay empty.
  LitScene rest;
  bool has_ambient = false;  ///< the file says it
  struct WaterArea {
    std::optional<std::array<std::int32_t, 4>> from_to;  ///< x, y, x, y: columns from .. to - 1; none: all
    std::int32_t floor = 0;                              ///< voxels
    std::int32_t level_q8 = 0;                           ///< of the surface, above 0
    TextPlace place;
  };
  std::optional<WaterArea> water;
  EffectSet on = Effect::kNone;
  EffectSet off = Effect::kNone;
};

}  // namespace thimble::tools
