#include "scene/structure.h"

namespace thimble::tools {

int Structure::level() const {
  return with_traced([](const auto& traced) { return traced.level(); });
}

VoxelBox Structure::bounds() const {
  return with_traced([](const auto& traced) { return traced.bounds(); });
}

std::uint64_t Structure::voxels() const {
  return kind == StructureKind::kDense  ? dense.voxel_count()
         : kind == StructureKind::kPool ? pool.voxels()
                                        : compact.voxel_count();
}

std::uint64_t Structure::nodes() const {
  return kind == StructureKind::kPool ? pool.nodes_used() : compact.node_count();
}

std::uint64_t Structure::bytes() const {
  return kind == StructureKind::kDense  ? dense.used_bytes()
         : kind == StructureKind::kPool ? pool.used_bytes()
                                        : compact.size_bytes();
}

Status Structure::closest_hit(const Ray& ray, Hit* hit, const TraceOptions& options) const {
  return with_traced([&](const auto& traced) { return thimble::closest_hit(traced, ray, hit, options); });
}

Status Structure::render_band(const Camera& camera, const Shading& shading, const Band& band,
                              RenderCounts* counts, const TraceOptions& options) const {
  return with_traced([&](const auto& traced) {
    return thimble::render_band(traced, camera, shading, band, counts, options);
  });
}

}  // namespace thimble::tools
