#include "readers/mesh.h"

#include <cmath>
#include <memory>
#include <utility>

namespace thimble::tools {

namespace {

class VertexCloud final : public PointCloud {
 public:
  explicit VertexCloud(TriangleMesh mesh) : mesh_(std::move(mesh)) { notes = std::move(mesh_.notes); }

  void for_each(const Visit& visit) const override {
    CloudPoint point;
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
      point.x = mesh_.positions[i][0];
      point.y = mesh_.positions[i][1];
      point.z = mesh_.positions[i][2];
      if (has_color()) {
        point.color = mesh_.colors[i];
      }
      point.line = i + 1;
      visit(point);
    }
  }
  bool has_color() const override { return !mesh_.colors.empty(); }

 private:
  TriangleMesh mesh_;
};

}  // namespace

void TriangleStrip::add(std::uint32_t corner) {
  if (corners_ >= 2 && older_ != last_ && last_ != corner && corner != older_) {
    if (corners_ % 2 == 0) {
      mesh_.triangles.push_back({older_, last_, corner});
    } else {
      mesh_.triangles.push_back({last_, older_, corner});
    }
  }
  older_ = last_;
  last_ = corner;
  ++corners_;
}

Notes notes_of(const Source& source) {
  if (const auto* model = std::get_if<std::unique_ptr<VoxelModel>>(&source)) {
    return (*model)->notes;
  }
  if (const auto* grid = std::get_if<std::unique_ptr<VoxelGrid>>(&source)) {
    return (*grid)->notes;
  }
  if (const auto* cloud = std::get_if<std::unique_ptr<PointCloud>>(&source)) {
    return (*cloud)->notes;
  }
  const auto* mesh = std::get_if<TriangleMesh>(&source);
  return mesh != nullptr ? mesh->notes : Notes();
}

Source mesh_or_points(TriangleMesh mesh, std::uint64_t face_count) {
  if (mesh.positions.empty()) {
    throw InputError("the file holds no vertices");
  }
  if (face_count == 0) {
    return std::unique_ptr<PointCloud>(std::make_unique<VertexCloud>(std::move(mesh)));
  }
  return mesh;
}

std::uint8_t unit_to_byte(double component) {
  if (!(component > 0)) {
    return 0;
  }
  return component >= 1 ? std::uint8_t{255} : static_cast<std::uint8_t>(std::floor(component * 255 + 0.5));
}

}  // namespace thimble::tools
