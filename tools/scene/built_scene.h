/// A scene inside one block of memory: the structure that is traced, and room for one band of pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "readers/source.h"
#include "scene/host_memory.h"
#include "scene/scene_arguments.h"
#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/octree.h"

namespace thimble::tools {

// A scene's voxels as rays are traced through them, in one of three structures.

/// Only the member that `kind` names counts. Its bytes are an arena's.
struct Structure {
  StructureKind kind = StructureKind::kCompact;
  DenseGrid dense;
  Octree pool;
  CompactTree compact;

  /// Calls `visit` with the one that is traced.
  template <class Visit>
  auto with_traced(const Visit& visit) const {
    return kind == StructureKind::kDense  ? visit(dense)
           : kind == StructureKind::kPool ? visit(pool)
                                          : visit(compact);
  }
};

class SceneSource;

/// The least grid that holds `size` and whose world is that of 2^level: the world, the least that holds the grid,
/// decides how rays are quantised, so the longest side grows until it is that.
Vec3i grid_size(Vec3i size, int level);

struct BuildOptions {
  StructureKind structure = StructureKind::kCompact;
  std::optional<std::uint64_t> memory_bytes;          ///< --memory: everything between reader and display
  bool coarsen = false;                               ///< --coarsen
  std::uint64_t band_bytes = 0;                       ///< one band of pixels; 0: nothing is rendered
  std::uint64_t render_state_bytes = render_bytes();  ///< what draws keeps beside the band
  std::uint64_t least_band_bytes = 0;                 ///< what will do for a band when the budget is short
  int threads = 1;                                    ///< that may sort voxels, and look for the best view
  std::string budget_name = "--memory";               ///< who set the budget, for errors
  /// A baked scene is traced where the source has it, as a board does in flash: not part of the budget, and
  /// the source must outlive the result. Otherwise its tree is copied into the arena. Compact trees only.
  bool baked_in_flash = false;
  std::size_t front_bytes =
      0;  ///< of memory, a multiple of 8, that others take in front of all that is built
};

/// Built once, then only read. Layout of the arena, front to back: render state and band, the structure, and what
/// others take there (wide_renderer.h, painter.h).
class BuiltScene {
 public:
  /// Streams `source` into memory of its own. Throws InputError when it does not fit the budget (the sentence
  /// says how much it would need), and what `source` throws.
  BuiltScene(const SceneSource& source, const BuildOptions& options, const Progress& progress = {});

  StructureKind structure() const { return traced_.kind; }
  const Structure& traced() const { return traced_; }
  /// Those that it was built with.
  int threads() const { return options_.threads; }
  int level() const {
    return traced_.with_traced([](const auto& traced) { return traced.level(); });
  }
  /// A box that holds everything solid.
  VoxelBox bounds() const {
    return traced_.with_traced([](const auto& traced) -> VoxelBox { return traced.bounds(); });
  }
  /// Solid volume in voxels.
  std::uint64_t voxels() const;
  /// Voxels that coarsening added: the solid volume less the source's different voxels.
  std::uint64_t solid_added() const { return solid_added_; }
  /// Nodes of the structure that is traced; 0 for a dense grid.
  std::uint64_t nodes() const {
    return structure() == StructureKind::kPool ? traced_.pool.nodes_used() : compact().node_count();
  }
  std::uint64_t tree_bytes() const;
  /// Whether it is traced where a large file has it. Lists or maps beside it would read all of the file, and take several
  /// times as much memory: they are made on demand alone.
  bool draws_from_file() const;
  /// --memory, or what was used at most where none was given.
  std::uint64_t budget_bytes() const { return options_.memory_bytes.value_or(high_water_bytes()); }
  /// The most of the arena that was in use.
  std::uint64_t high_water_bytes() const { return arena_.high_water_bytes(); }
  /// The least budget that this scene can be built in without coarsening; at most `high_water_bytes()` of a
  /// build without one, less where points repeat.
  std::uint64_t least_budget_bytes() const { return least_budget_bytes_; }
  double build_seconds() const { return build_seconds_; }
  const std::vector<Rgb8>& palette() const { return palette_; }
  Bytes band() const { return band_; }
  /// Gives the memory away, in which the structure then lives.
  HostMemory take_memory() { return std::move(memory_); }
  /// For what is wanted beside what was built, within the budget.
  Arena& arena() { return arena_; }
  const CompactTree& compact() const { return traced_.compact; }

  Status closest_hit(const Ray& ray, Hit* hit, const TraceOptions& options) const {
    return traced_.with_traced(
        [&](const auto& traced) { return thimble::closest_hit(traced, ray, hit, options); });
  }
  Status render_band(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts,
                     const TraceOptions& options) const {
    return traced_.with_traced([&](const auto& traced) {
      return thimble::render_band(traced, camera, shading, band, counts, options);
    });
  }

 private:
  bool try_to_build(const SceneSource& source, const Progress& progress);
  void build(const SceneSource& source, std::uint64_t band_bytes, bool coarsen, const Progress& progress);

  BuildOptions options_;
  HostMemory memory_;
  Arena arena_;
  Bytes band_;
  Structure traced_;
  std::vector<Rgb8> palette_;
  std::uint64_t least_budget_bytes_ = 0;
  std::uint64_t solid_added_ = 0;
  double build_seconds_ = 0;
};

}  // namespace thimble::tools
