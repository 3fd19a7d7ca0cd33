/// What a scene takes at every depth in every structure, and what a smaller depth does to its picture.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "instruments/timed_frames.h"
#include "scene/framing.h"
#include "scene/scene_source.h"
#include "thimble/picture/shading.h"

namespace thimble::tools {

// A scene at less than its own depth, in all structures: what `thimble memory` measures.
//
// A voxel of a lower depth is solid when anything in it is: it is the parent block of the finer voxels. Its
// material is the one that most of its solid volume has, the lowest number on a tie.

/// A bit for each place, a pool that can be edited, a compact tree, and one with equal subtrees once.
enum MemoryStructure : std::size_t { kDense, kPool, kCompact, kShared, kMemoryStructures };

struct PictureError : DepthError {
  std::uint64_t wrong_px = 0;  ///< of another colour
};

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

/// Throws InputError.
MemoryStudy study_memory(const SceneSource& source, const std::string& name, const StudyOptions& options,
                         const Progress& progress);
/// What `thimble memory --json` writes of it: an array of objects, one a depth (commands/memory.cpp).
std::string memory_json(const MemoryStudy& study);

}  // namespace thimble::tools
