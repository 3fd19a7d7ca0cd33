/// @file structure.h
/// A scene's voxels as rays are traced through them, in one of three structures.
#ifndef THIMBLE_TOOLS_SCENE_STRUCTURE_H
#define THIMBLE_TOOLS_SCENE_STRUCTURE_H

#include <cstdint>

#include "scene/scene_arguments.h"
#include "thimble/picture/render.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/dense_grid.h"
#include "thimble/tree/octree.h"

namespace thimble::tools {

/// Only the member that `kind` names counts. Its bytes are an arena's.
struct Structure {
  StructureKind kind = StructureKind::kCompact;
  DenseGrid dense;
  Octree pool;
  CompactTree compact;

  int level() const;
  /// A box that holds everything solid.
  VoxelBox bounds() const;
  /// Solid volume in voxels.
  std::uint64_t voxels() const;
  /// 0 for a dense grid.
  std::uint64_t nodes() const;
  std::uint64_t bytes() const;

  Status closest_hit(const Ray& ray, Hit* hit, const TraceOptions& options) const;
  Status render_band(const Camera& camera, const Shading& shading, const Band& band, RenderCounts* counts,
                     const TraceOptions& options) const;

 private:
  /// Calls `visit` with the one that is traced.
  template <class Visit>
  auto with_traced(const Visit& visit) const {
    switch (kind) {
      case StructureKind::kDense:
        return visit(dense);
      case StructureKind::kPool:
        return visit(pool);
      case StructureKind::kCompact:
        break;
    }
    return visit(compact);
  }
};

}  // namespace thimble::tools

#endif
