/// A scene as a stream of voxels, wherever it comes from: the SCENE argument of every subcommand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "readers/oct.h"
#include "readers/scene_text.h"
#include "readers/source.h"
#include "scene/lit_description.h"
#include "scene/scene_arguments.h"

namespace thimble::tools {

class SceneSource;

/// What a source says of itself before it streams: plain data, filled in by whoever makes the source.
struct SourceFacts {
  std::string kind;           ///< for a person: "voxel model", "generator points", ...
  int level = 1;              ///< the world is 2^level voxels a side
  std::uint64_t points = 0;   ///< what the input counts: points, voxels of the file, vertices
  bool is_point_set = false;  ///< single voxels strewn about, of which a list is smaller than a pool of nodes
  bool is_mesh = false;       ///< every stream voxelises triangles again
  bool is_z_up = false;       ///< a mesh whose y and z were not turned
  bool is_landscape = false;  ///< heights, whose steps stand for a slope
  bool single_material = false;  ///< all voxels have material 0
  std::optional<bool>
      has_colors{};         ///< it says its colours, be it only one; else where its materials are many
  bool is_scalable = true;  ///< another --depth shows the same scene finer or coarser
  /// One past the greatest index on each axis that can occur: what a dense grid must hold; else the whole world.
  std::optional<std::array<std::int32_t, 3>> extent{};
  Palette palette{};
  double color_error = 0;  ///< root of the mean square by which its channels differ from the file's, of 255
  std::optional<SceneCamera> camera{};  ///< that the scene brings along: a baked one, or a generator's own
  /// What light does in it by its file, its text or its generator; else the palette's surfaces alone.
  std::optional<LitDescription> lighting{};
  std::shared_ptr<const BakedFile> baked{};  ///< the baked scene that it is
  std::optional<LookNote> look_note{};       ///< what a baked scene keeps of the one that it was made from
  std::uint32_t frames = 1;                  ///< of its file; `SceneArguments::frame` takes one
  std::shared_ptr<const SceneSource> in_frames{};  ///< where there are several: what all of them show, in one
  std::size_t placements = 0;  ///< models, boxes and balls of a .scene, those within it counted each time
};

/// Streams the same voxels on every call.
class SceneSource {
 public:
  /// Calls the sink for each voxel. Where a position repeats, the last one counts; in a point set the one with the
  /// greatest material.
  using Stream = std::function<void(const VoxelSink& sink)>;
  /// The same in blocks, for a source that has larger ones than voxels. Only a mesh's tells `progress` itself.
  using StreamBlocks = std::function<void(const VisitBlock& visit, const Progress& progress)>;
  SceneSource(SourceFacts facts, Stream stream, StreamBlocks blocks = nullptr);
  SceneSource(SourceFacts facts, StreamBlocks blocks)
      : SceneSource(std::move(facts), nullptr, std::move(blocks)) {}

  const std::string& kind() const { return facts_.kind; }
  int level() const { return facts_.level; }
  std::uint64_t points() const { return facts_.points; }
  bool is_point_set() const { return facts_.is_point_set; }
  bool is_mesh() const { return facts_.is_mesh; }
  /// Of a mesh: z is up in the file.
  bool is_z_up() const { return facts_.is_z_up; }
  bool is_landscape() const { return facts_.is_landscape; }
  bool single_material() const { return facts_.single_material; }
  std::array<std::int32_t, 3> extent() const;
  const Palette& palette() const { return facts_.palette; }
  double color_error() const { return facts_.color_error; }
  bool has_colors() const { return facts_.has_colors.value_or(!facts_.single_material); }
  bool is_scalable() const { return facts_.is_scalable; }
  const SceneCamera* camera() const { return facts_.camera ? &*facts_.camera : nullptr; }
  /// Made anew by each call.
  LitDescription lighting() const {
    return facts_.lighting ? *facts_.lighting : describe_palette(facts_.palette);
  }
  /// Its bytes live as long as the source.
  const BakedScene* baked() const { return facts_.baked != nullptr ? &facts_.baked->scene : nullptr; }
  /// Its voxels as a tree that is there, which building then copies; null where there is none.
  const CompactTree* tree() const { return built_ || baked() == nullptr ? built_ : &baked()->tree(); }
  /// For whoever builds one scene many times: `tree`, built of it without coarsening, outlives the source.
  void keep(const CompactTree* tree) { built_ = tree; }
  const std::optional<LookNote>& look_note() const { return facts_.look_note; }
  std::uint32_t frames() const { return facts_.frames; }
  /// Null where it has one frame.
  const SceneSource* in_frames() const { return facts_.in_frames.get(); }
  std::size_t placements() const { return facts_.placements; }
  /// The files that it was read from: its own, and those that a .scene names, each once. None for a
  /// generator.
  const std::vector<std::string>& files() const { return files_; }
  void add_file(const std::string& path);
  /// What their readers left out or had to decide (readers/source.h), each with the file's name.
  const Notes& notes() const { return notes_; }
  void add_notes(const Notes& notes);
  void stream(const VoxelSink& sink, const Progress& progress) const;
  void stream_blocks(const VisitBlock& visit, const Progress& progress) const;

 private:
  SourceFacts facts_;
  Stream stream_;
  StreamBlocks blocks_;
  const CompactTree* built_ = nullptr;
  std::vector<std::string> files_;
  Notes notes_;
};

/// Opens SCENE: parses a generator or reads a file. Throws InputError.
std::unique_ptr<SceneSource> open_scene(const SceneArguments& arguments, const Progress& progress = {});
/// What a `.oct` holds; `depth` is its own or none.
std::unique_ptr<SceneSource> baked_scene(BakedFile read, std::optional<int> depth = {});
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

/// Points of all generators that a scene names: its models are streamed as it is opened.
inline constexpr std::uint64_t kMostGenerated = std::uint64_t{1} << 27;

/// A model, and what streaming it once has told.
struct OpenedModel {
  std::shared_ptr<const SceneSource> source;
  UsedMaterials used;
  VoxelBox solid;
  std::uint64_t voxels = 0;  ///< streamed, repeated ones too
};

/// What the files of one scene share while they are opened.
struct SceneOpening {
  std::vector<std::string> path;  ///< the .scene files that are being opened, each inside the one before
  std::map<std::string, std::shared_ptr<const OpenedModel>> opened;  ///< by path and options
  std::uint64_t generated = 0;                                       ///< points of generators among them
};

/// Opens what `text`, the content of `arguments.scene`, puts together. `opening` is null for the outermost
/// file. Throws InputError "line L, column C: ...".
std::unique_ptr<SceneSource> open_text_scene(const SceneText& text, const SceneArguments& arguments,
                                             SceneOpening* opening, const Progress& progress);

}  // namespace thimble::tools
