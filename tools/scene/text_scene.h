/// @file text_scene.h
/// A `.scene` file as a source of voxels: opens its models, turns and places them, and merges their palettes.
///
/// Every part streams on its own when the scene streams; nothing is kept but what the models' readers keep. A
/// model that stands in several places is read once.
///
/// Materials: the world has one palette. Each model's used entries, and the materials of boxes and balls, get
/// the next free index; two that look the same share one. More than 256 are an error.
#ifndef THIMBLE_TOOLS_SCENE_TEXT_SCENE_H
#define THIMBLE_TOOLS_SCENE_TEXT_SCENE_H

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "readers/scene_text.h"
#include "scene/scene_source.h"

namespace thimble::tools {

/// Scenes within scenes: how deep, how many different models are opened for one scene, and how many models,
/// boxes and balls it may place, those of a scene within it counted each time.
inline constexpr std::size_t kMostNestedScenes = 8;
inline constexpr std::size_t kMostSceneModels = 1024;
inline constexpr std::size_t kMostPlacements = 65536;
/// Voxels of all boxes and balls of one file, which no file's size bounds.
inline constexpr std::uint64_t kMostPrimitiveVoxels = std::uint64_t{1} << 30;
/// Voxels that all models may stream, each counted in all its places.
inline constexpr std::uint64_t kMostSceneVoxels = std::uint64_t{1} << 31;

/// A model, and what streaming it once has told.
struct OpenedModel {
  std::shared_ptr<const SceneSource> source;
  UsedMaterials used;
  VoxelBox solid;
  std::uint64_t voxels = 0;      ///< streamed, repeated ones too
  std::uint64_t placements = 0;  ///< a scene's own models, boxes and balls
};

/// What the files of one scene share while they are opened.
struct SceneOpening {
  std::vector<std::string> path;  ///< the .scene files that are being opened, each inside the one before
  std::map<std::string, std::shared_ptr<const OpenedModel>> opened;  ///< by path and options
};

/// Opens what `text`, the content of `arguments.scene`, puts together. `opening` is null for the outermost
/// file. Throws InputError "line L, column C: ...".
std::unique_ptr<SceneSource> open_text_scene(const SceneText& text, const SceneArguments& arguments,
                                             SceneOpening* opening, const Progress& progress);

}  // namespace thimble::tools

#endif
