/// @file built_scene.h
/// A scene inside one arena: the structure that is traced, and room for one band of pixels.
#ifndef THIMBLE_TOOLS_SCENE_BUILT_SCENE_H
#define THIMBLE_TOOLS_SCENE_BUILT_SCENE_H

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/host_memory.h"
#include "scene/scene_source.h"
#include "thimble/base/memory.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"
#include "thimble/trace/trace.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/octree.h"
#include "wide/renderer.h"

namespace thimble::tools {

enum class StructureKind : std::uint8_t { kDense, kPool, kCompact };

struct BuildOptions {
  StructureKind structure = StructureKind::kCompact;
  std::optional<std::uint64_t> memory_bytes;          ///< --memory: everything between reader and display
  bool coarsen = false;                               ///< --coarsen
  std::uint64_t band_bytes = 0;                       ///< one band of pixels; 0: nothing is rendered
  std::uint64_t render_state_bytes = render_bytes();  ///< what draws keeps beside the band
  std::uint64_t least_band_bytes = 0;                 ///< what will do for a band when the budget is short
  int threads = 1;                                    ///< that may sort voxels
  std::string budget_name = "--memory";               ///< who set the budget, for errors
  /// A baked scene is traced where the source has it, as a board does in flash: not part of the budget, and
  /// the source must outlive the result. Otherwise its tree is copied into the arena. Compact trees only.
  bool baked_in_flash = false;
};

/// Built once, then only read. Layout of the arena, front to back:
///
///   render state and band | pool of nodes, or list of keys, while building | compact tree
///
/// At the end the compact tree moves down over the workspace. A baked scene's tree is just taken up, without
/// any workspace; the other structures are filled from it. What the wide renderer wants stands behind it.
/// `arena.high_water_bytes()` is the most that was in use.
class BuiltScene {
 public:
  /// Streams `source` into memory of its own. Throws InputError when it does not fit the budget (the sentence
  /// says how much it would need), and what `source` throws.
  BuiltScene(const SceneSource& source, const BuildOptions& options, const Progress& progress = {});

  StructureKind structure() const { return options_.structure; }
  int level() const;
  /// A box that holds everything solid.
  VoxelBox bounds() const;
  /// Solid volume in voxels.
  std::uint64_t voxels() const;
  /// Voxels that coarsening added: the solid volume less the source's different voxels.
  std::uint64_t solid_added() const { return solid_added_; }
  /// Nodes of the structure that is traced; 0 for a dense grid.
  std::uint64_t nodes() const;
  std::uint64_t tree_bytes() const;
  /// --memory, or what was used at most where none was given.
  std::uint64_t budget_bytes() const { return options_.memory_bytes.value_or(high_water_bytes()); }
  std::uint64_t high_water_bytes() const { return arena_.high_water_bytes(); }
  /// The least budget that this scene can be built in without coarsening; at most `high_water_bytes()` of a
  /// build without one, less where points repeat.
  std::uint64_t least_budget_bytes() const { return least_budget_bytes_; }
  double build_seconds() const { return build_seconds_; }
  const std::vector<Rgb8>& palette() const { return palette_; }
  Bytes band() const { return band_; }
  /// So many bytes of the arena beside what was built, within the budget; empty when they do not fit.
  Bytes take(std::size_t bytes) { return arena_.take(bytes); }
  const CompactTree& compact() const { return compact_; }

  /// Makes the lists of the wide renderer (platform/wide) and takes its workspace: for all rows of
  /// pictures of this size, or for as many as there is room for. False, and nothing taken, when there is no
  /// compact tree, or room for fewer than `kLeastWideRows`. Its time counts as building.
  bool prepare_wide(std::int32_t width_px, std::int32_t height_px, int threads);
  static constexpr std::int32_t kLeastWideRows = 16;
  /// Most rows in a band for `render_wide`; 0 before `prepare_wide`.
  std::int32_t wide_rows() const { return wide_rows_; }
  /// The same pixels as `render_band`; Status::kTooFine for cameras that are left to it.
  Status render_wide(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts,
                     wide::Counts* work) const;

  Status closest_hit(const Ray& ray, Hit* hit, const TraceOptions& options) const;
  Status render_band(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts,
                     const TraceOptions& options) const;

 private:
  struct Shortage {};  // thrown inside `build`: the budget is too small

  bool try_to_build(const SceneSource& source, const Progress& progress);
  void build(const SceneSource& source, std::uint64_t band_bytes, bool coarsen, const Progress& progress);
  void build_dense(const SceneSource& source, const Progress& progress);
  void build_pool(const SceneSource& source, bool coarsen, const Progress& progress);
  void build_parts(const SceneSource& source, const Progress& progress);
  void fill_part(const SceneSource& source, Bytes pool, int part_level, std::size_t part,
                 const Progress& progress);
  void insert(const SceneSource& source, const Vec3i& corner, int block_level, std::uint8_t material);
  void take_baked(const CompactTree& tree);
  template <class Key>
  void build_keys(const SceneSource& source, const Progress& progress);
  void keep_compact(Bytes tree);
  /// Calls `visit` with the structure that is traced.
  template <class Visit>
  auto with_structure(const Visit& visit) const {
    switch (options_.structure) {
      case StructureKind::kDense:
        return visit(dense_);
      case StructureKind::kPool:
        return visit(octree_);
      case StructureKind::kCompact:
        break;
    }
    return visit(compact_);
  }

  BuildOptions options_;
  HostMemory memory_;
  Arena arena_;
  Bytes band_;
  CompactTree compact_;
  Octree octree_;
  DenseGrid dense_;
  std::vector<Rgb8> palette_;
  wide::VoxelLists lists_;
  Bytes wide_workspace_;
  std::int32_t wide_rows_ = 0;
  std::unique_ptr<wide::Threads> wide_threads_;
  std::uint64_t least_budget_bytes_ = 0;
  std::uint64_t solid_added_ = 0;
  double build_seconds_ = 0;
};

}  // namespace thimble::tools

#endif
