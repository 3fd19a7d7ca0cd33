/// @file depth_scene.h
/// A scene at less than its own depth, in all structures: what `thimble memory` measures.
///
/// A voxel of a lower depth is solid when anything in it is: it is the parent block of the finer voxels. Its
/// material is the one that most of its solid volume has, the lowest number on a tie.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_DEPTH_SCENE_H
#define THIMBLE_TOOLS_INSTRUMENTS_DEPTH_SCENE_H

#include <array>
#include <cstdint>
#include <vector>

#include "scene/host_memory.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/render.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/octree.h"
#include "thimble/tree/shared_tree.h"

namespace thimble::tools {

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

}  // namespace thimble::tools

#endif
