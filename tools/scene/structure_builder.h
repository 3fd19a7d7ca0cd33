/// @file structure_builder.h
/// Builds what is traced, from a stream of voxels, in the memory of an arena and nowhere else.
#ifndef THIMBLE_TOOLS_SCENE_STRUCTURE_BUILDER_H
#define THIMBLE_TOOLS_SCENE_STRUCTURE_BUILDER_H

#include <cstddef>
#include <cstdint>

#include "readers/source.h"
#include "scene/structure.h"
#include "thimble/base/memory.h"

namespace thimble::tools {

class SceneSource;

/// What a dense grid of the scene must hold.
Vec3i dense_size(const SceneSource& source);

/// Builds behind what the arena holds; its layout, front to back:
///
///   what is there | pool of nodes, or list of keys, while building | compact tree
///
/// At the end the compact tree moves down over the workspace. A baked scene's tree is just taken up, without
/// any workspace; the other structures are filled from it.
class StructureBuilder {
 public:
  struct Shortage {};  ///< thrown: the arena is too small

  /// `baked_in_flash`: a baked scene's tree is traced where the source has it. Otherwise it is copied into
  /// the arena. `threads` may sort voxels. All that is given outlives the builder.
  StructureBuilder(const SceneSource& source, Arena* arena, bool baked_in_flash, int threads,
                   const Progress& progress)
      : source_(source),
        arena_(*arena),
        baked_in_flash_(baked_in_flash),
        threads_(threads),
        progress_(progress) {}

  /// `coarsen`: merges blocks until the arena is large enough. Throws Shortage, InputError and what the
  /// source throws; what the arena then holds behind what was there is lost.
  Structure build(StructureKind kind, bool coarsen);
  /// The least bytes of an arena in which the same comes out without coarsening, where that is less than the
  /// most that was in use; else 0. After `build`.
  std::uint64_t least_bytes() const { return least_bytes_; }

 private:
  void build_dense();
  void build_pool(bool coarsen);
  void build_parts();
  void fill_part(Bytes pool, int part_level, std::size_t part);
  void insert(const Vec3i& corner, int block_level, std::uint8_t material);
  void take_baked(const CompactTree& tree);
  template <class Key>
  void build_keys();
  void keep_compact(Bytes tree);

  const SceneSource& source_;
  Arena& arena_;
  bool baked_in_flash_;
  int threads_;
  const Progress& progress_;
  Structure built_;
  std::uint64_t least_bytes_ = 0;
};

}  // namespace thimble::tools

#endif
