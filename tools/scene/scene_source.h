/// @file scene_source.h
/// A scene as a stream of voxels, wherever it comes from: the SCENE argument of every subcommand.
#ifndef THIMBLE_TOOLS_SCENE_SCENE_SOURCE_H
#define THIMBLE_TOOLS_SCENE_SCENE_SOURCE_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "readers/oct.h"
#include "readers/scene_text.h"
#include "readers/source.h"
#include "scene/lit_description.h"
#include "scene/scene_arguments.h"

namespace thimble::tools {

/// Streams the same voxels on every call.
class SceneSource {
 public:
  virtual ~SceneSource() = default;
  /// What it is, for a person: ".vox model", "point cloud, fitted", "generator points", ...
  virtual std::string kind() const = 0;
  /// The world is 2^level voxels a side.
  int level() const { return level_; }
  /// What the input counts: points, voxels of the file, vertices; known before streaming.
  virtual std::uint64_t points() const = 0;
  /// Whether it is made of single voxels strewn about, of which a list is smaller than a pool of nodes.
  virtual bool is_point_set() const = 0;
  /// Whether every stream voxelises triangles again.
  virtual bool is_mesh() const { return false; }
  /// Whether all voxels have material 0.
  virtual bool single_material() const = 0;
  /// One past the greatest index on each axis that can occur: what a dense grid must hold.
  virtual std::array<std::int32_t, 3> extent() const;
  virtual const Palette& palette() const = 0;
  /// Whether what it is read from says its colours, be it only one.
  virtual bool has_colors() const { return !single_material(); }
  /// Whether another --depth shows the same scene finer or coarser.
  virtual bool is_scalable() const { return true; }
  /// The camera that the scene brings along, or null: a baked one, or a generator's own.
  virtual const SceneCamera* camera() const { return nullptr; }
  /// What light does in it: what its file, its text or its generator says, else the palette's surfaces alone.
  /// Made anew by each call.
  virtual LitDescription lighting() const { return describe_palette(palette()); }
  /// The baked scene that it is, or null. Its bytes live as long as the source.
  virtual const BakedScene* baked() const { return nullptr; }
  /// Of a baked scene: what it keeps of the scene that it was made from, if it does.
  virtual std::optional<LookNote> look_note() const { return std::nullopt; }
  /// How many frames its file has; `SceneArguments::frame` takes one.
  virtual std::uint32_t frames() const { return 1; }
  /// The files that it was read from: its own, and those that a .scene names, each once. None for a
  /// generator.
  const std::vector<std::string>& files() const { return files_; }
  void add_file(const std::string& path);
  /// What their readers left out or had to decide (readers/source.h), each with the file's name.
  const Notes& notes() const { return notes_; }
  void add_notes(const Notes& notes);
  /// Where a position repeats, the last voxel counts; in a point set the one with the greatest material.
  virtual void stream(const VoxelSink& sink, const Progress& progress) const = 0;
  /// The same in blocks where the source has larger ones than voxels.
  virtual void stream_blocks(const VisitBlock& visit, const Progress& progress) const;

 protected:
  int level_ = 1;

 private:
  std::vector<std::string> files_;
  Notes notes_;
};

/// Opens SCENE: parses a generator or reads a file. Throws InputError.
std::unique_ptr<SceneSource> open_scene(const SceneArguments& arguments, const Progress& progress = {});
struct SceneOpening;
/// The same for a model inside a .scene file.
std::unique_ptr<SceneSource> open_scene(const SceneArguments& arguments, SceneOpening* opening,
                                        const Progress& progress);

// A `.scene` file as a source of voxels: opens its models, turns and places them, and merges their palettes.
//
// Every part streams on its own when the scene streams; nothing is kept but what the models' readers keep. A
// model that stands in several places is read once.
//
// Materials: the world has one palette. Each model's used entries, and the materials of boxes and balls, get
// the next free index; two that look the same share one. More than 256 are an error.

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
