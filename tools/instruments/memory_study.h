/// @file memory_study.h
/// What a scene takes at every depth in every structure, and what a smaller depth does to its picture.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_MEMORY_STUDY_H
#define THIMBLE_TOOLS_INSTRUMENTS_MEMORY_STUDY_H

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "instruments/timed_frames.h"
#include "scene/framing.h"
#include "scene/host_memory.h"
#include "scene/scene_source.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::tools {

// A scene at less than its own depth, in all structures: what `thimble memory` measures.
//
// A voxel of a lower depth is solid when anything in it is: it is the parent block of the finer voxels. Its
// material is the one that most of its solid volume has, the lowest number on a tie.

/// A solid block of one material, 2^level voxels a side.
struct SolidBlock {
  Vec3i corner;
  std::uint8_t level = 0;
  std::uint8_t material = 0;
};

/// Everything solid of a sound tree in Morton order; merged blocks as if they were full.
std::vector<SolidBlock> solid_blocks(const CompactTree& tree);
/// The same scene `levels` depths coarser, in Morton order.
std::vector<SolidBlock> coarser(const std::vector<SolidBlock>& blocks, int levels);

enum class MemoryStructure : std::uint8_t { kDense, kPool, kCompact, kShared };
inline constexpr std::size_t kMemoryStructures = 4;
/// As the columns are called: dense, pool, compact, dag.
const char* structure_name(MemoryStructure structure);

/// The blocks of one depth in all structures. Memory of its own, as much as it takes.
class DepthScene {
 public:
  /// A world of 2^world_level; the blocks' coordinates and sides are multiplied by 2^up. `one_material` makes
  /// all of them material 0. The dense grid is filled by `make_dense` only. Throws InputError when the
  /// machine or the formats cannot hold it.
  DepthScene(const std::vector<SolidBlock>& blocks, int world_level, int up, bool one_material);

  const Octree& pool() const { return pool_; }
  Octree& pool() { return pool_; }
  const CompactTree& compact() const { return compact_; }
  const SharedTree& shared() const { return shared_; }
  const DenseGrid& dense() const { return dense_; }
  const CompactShape& shape() const { return shape_; }

  std::uint64_t voxels() const { return pool_.voxels(); }
  /// Solid blocks and voxels of the compact tree.
  std::uint64_t leaves() const { return std::uint64_t{shape_.solid_blocks} + shape_.voxel_bits; }
  /// The least grid from 0,0,0 that holds everything solid and whose world is this one.
  Vec3i dense_size() const { return dense_size_; }
  std::uint64_t bytes(MemoryStructure structure) const;
  /// The hash table that building the DAG took at the least.
  std::uint64_t shared_work_bytes() const { return shared_build_.work_bytes; }

  /// Fills the dense grid from the blocks that this was made from.
  void make_dense(const std::vector<SolidBlock>& blocks);
  bool has_dense() const { return dense_made_; }

  Status render(MemoryStructure structure, const Camera& camera, const Shading& shading, const Band& band,
                RenderCounts* counts) const;

 private:
  HostMemory pool_memory_;
  Octree pool_;
  CompactShape shape_;
  std::vector<std::uint8_t> compact_bytes_;
  CompactTree compact_;
  SharedBuild shared_build_;
  std::vector<std::uint8_t> shared_bytes_;
  SharedTree shared_;
  Vec3i dense_size_;
  std::vector<std::uint8_t> dense_bytes_;
  DenseGrid dense_;
  bool dense_made_ = false;
};

/// What each pixel's ray met: its colour, and the distance in voxels along the unit ray, negative for a miss.
struct TracedPicture {
  std::vector<Rgb8> colors;
  std::vector<double> distances;
};

/// Traces every pixel. The camera is one for the tree's level.
TracedPicture trace_picture(const CompactTree& tree, const Camera& camera, const Shading& shading);

struct PictureError : DepthError {
  std::uint64_t wrong_px = 0;  ///< of another colour
};

PictureError picture_error(const TracedPicture& picture, const TracedPicture& reference);

/// What may have to be stored at a place, one after the other: whether it is solid; and its colour (a palette
/// index, 1 byte), and a normal (2 bytes), and an opacity (1 byte).
inline constexpr std::size_t kStoredKinds = 4;
inline constexpr std::array<const char*, kStoredKinds> kStoredNames{"bit", "color", "normal", "opacity"};
/// Bytes a place of each beside the bit, all before it included.
inline constexpr std::array<std::uint64_t, kStoredKinds> kStoredBytes{0, 1, 3, 4};

struct StructureFigures {
  std::uint64_t bytes = 0;        ///< as it lies there; dense: bits alone
  std::uint64_t build_bytes = 0;  ///< the most in use while it is made
  /// With so much stored at each place: all cells of a dense grid, all solid blocks and voxels of a tree.
  std::array<std::uint64_t, kStoredKinds> stored_bytes{};
  std::optional<double> frame_ms;  ///< processor time, the median; nothing where it was not drawn
  std::optional<double> visits_per_ray;
};

struct DepthRow {
  int depth = 0;
  Vec3i grid;               ///< of the dense grid
  std::uint64_t units = 0;  ///< its cells
  std::uint64_t voxels = 0;
  std::uint64_t leaves = 0;  ///< solid blocks and voxels of the trees
  std::uint64_t pool_nodes = 0;
  std::uint64_t compact_nodes = 0;
  std::uint64_t dag_nodes = 0;
  std::uint64_t dag_table_bytes = 0;  ///< the hash table that the DAG was built in
  std::array<StructureFigures, kMemoryStructures> structures;
  PictureError error;
};

struct BudgetRow {
  std::uint64_t budget_bytes = 0;
  std::array<int, kMemoryStructures> depth{};  ///< the deepest that fits, 0: none
  /// The whole depth, coarsened until the compact tree fits; nothing when even one block does not.
  std::optional<std::uint64_t> coarsened_bytes;
  std::uint64_t solid_added = 0;
  PictureError coarsened_error;
};

struct StudyOptions {
  ViewWishes view;
  ShadeMode shade = ShadeMode::kDepth;
  int frames = 3;                             ///< a structure and depth
  bool budget_sweep = false;                  ///< 1 KiB, doubled until the whole scene fits
  std::optional<std::uint64_t> budget_bytes;  ///< one more budget
};

struct MemoryStudy {
  std::vector<DepthRow> depths;  ///< 1 .. the scene's own
  std::vector<BudgetRow> budgets;
  std::uint64_t pixels = 0;
  /// Bytes of a baked scene around a tree: header, palette, camera and name.
  std::uint64_t around_tree_bytes = 0;
  std::string note;  ///< for a person: what could not be done
};

/// Dense grids beyond this are counted, not filled and drawn.
inline constexpr std::uint64_t kMostDenseBytes = std::uint64_t{128} << 20;

/// Measures. Throws InputError.
MemoryStudy study_memory(const SceneSource& source, const std::string& name, const StudyOptions& options,
                         const Progress& progress);

}  // namespace thimble::tools

#endif
