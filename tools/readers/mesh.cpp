#include "readers/mesh.h"

#include <algorithm>

#include "output/units.h"

namespace thimble::tools {

namespace {

class VertexCloud final : public PointCloud {
 public:
  explicit VertexCloud(TriangleMesh mesh) : mesh_(std::move(mesh)) { notes = std::move(mesh_.notes); }

  void for_each(const Visit& visit) const override {
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
      const auto& [x, y, z] = mesh_.positions[i];
      visit({x, y, z, has_color() ? mesh_.colors[i] : Rgb{}, i + 1});
    }
  }
  bool has_color() const override { return !mesh_.colors.empty(); }

 private:
  TriangleMesh mesh_;
};

using Point2 = std::array<double, 2>;

/// Twice the area of a triangle, positive where it turns to the left.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// One polygon, seen along the longest component of its normal so that it runs to the left.
struct FlatPolygon {
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> texcoords;  ///< one a corner, or empty
  std::vector<Point2> points;

  void see(const std::vector<std::array<double, 3>>& positions) {
    std::array<double, 3> normal{};
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto& p = positions[corners[i]];
      const auto& q = positions[corners[(i + 1) % corners.size()]];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3;
        const std::size_t v = (axis + 2) % 3;
        normal[axis] += (p[u] - q[u]) * (p[v] + q[v]);
      }
    }
    std::size_t axis = std::fabs(normal[0]) > std::fabs(normal[1]) ? 0 : 1;
    axis = std::fabs(normal[2]) > std::fabs(normal[axis]) ? 2 : axis;
    const std::size_t u = (axis + (normal[axis] < 0 ? 2 : 1)) % 3;
    const std::size_t v = (axis + (normal[axis] < 0 ? 1 : 2)) % 3;
    points.clear();
    for (const std::uint32_t corner : corners) {
      points.push_back({positions[corner][u], positions[corner][v]});
    }
  }
  bool is_convex() const {
    const std::size_t count = points.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (turn(points[i], points[(i + 1) % count], points[(i + 2) % count]) < 0) {
        return false;
      }
    }
    return true;
  }
  /// Whether the triangle of corner `i` and its neighbours lies inside and no other corner lies in it.
  bool is_ear(std::size_t i) const {
    const std::size_t count = points.size();
    const Point2& a = points[(i + count - 1) % count];
    const Point2& b = points[i];
    const Point2& c = points[(i + 1) % count];
    if (turn(a, b, c) < 0) {
      return false;
    }
    return std::none_of(points.begin(), points.end(), [&](const Point2& p) {
      return p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
    });
  }
  void remove(std::size_t i) {
    corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(i));
    if (!texcoords.empty()) {
      texcoords.erase(texcoords.begin() + static_cast<std::ptrdiff_t>(i));
    }
    points.erase(points.begin() + static_cast<std::ptrdiff_t>(i));
  }
};

}  // namespace

void Polygons::add(std::uint32_t corner, std::uint32_t texcoord) {
  if (corners_ >= 2) {
    continues_.resize(mesh_.triangles.size());
    continues_.push_back(corners_ > 2);
    if (texcoord != kNoTexcoord || !mesh_.texcoord_corners.empty()) {
      mesh_.texcoord_corners.resize(mesh_.triangles.size(), {kNoTexcoord, kNoTexcoord, kNoTexcoord});
      mesh_.texcoord_corners.push_back({first_texcoord_, last_texcoord_, texcoord});
    }
    mesh_.triangles.push_back({first_, last_, corner});
  }
  first_ = corners_ == 0 ? corner : first_;
  first_texcoord_ = corners_ == 0 ? texcoord : first_texcoord_;
  last_ = corner;
  last_texcoord_ = texcoord;
  ++corners_;
}

void Polygons::cut_ears() {
  continues_.resize(mesh_.triangles.size());
  FlatPolygon polygon;
  for (std::size_t first = 0, end = 0; first < mesh_.triangles.size(); first = end) {
    for (end = first + 1; end < mesh_.triangles.size() && continues_[end];) {
      ++end;
    }
    if (end == first + 1 || end - first + 2 > kMostEarCorners) {
      continue;
    }
    polygon.corners = {mesh_.triangles[first][0], mesh_.triangles[first][1]};
    for (std::size_t i = first; i < end; ++i) {
      polygon.corners.push_back(mesh_.triangles[i][2]);
    }
    polygon.texcoords.clear();
    if (end <= mesh_.texcoord_corners.size()) {
      polygon.texcoords = {mesh_.texcoord_corners[first][0], mesh_.texcoord_corners[first][1]};
      for (std::size_t i = first; i < end; ++i) {
        polygon.texcoords.push_back(mesh_.texcoord_corners[i][2]);
      }
    }
    polygon.see(mesh_.positions);
    if (polygon.is_convex()) {
      continue;
    }
    for (std::size_t at = first; at < end; ++at) {
      const std::size_t count = polygon.corners.size();
      std::size_t ear = 1;  // of what has none: the fan's next triangle
      for (std::size_t i = 0; i < count; ++i) {
        if (polygon.is_ear(i)) {
          ear = i;
          break;
        }
      }
      const std::array<std::size_t, 3> kept{ear == 0 ? count - 1 : ear - 1, ear,
                                            ear + 1 == count ? 0 : ear + 1};
      for (std::size_t i = 0; i < 3; ++i) {
        mesh_.triangles[at][i] = polygon.corners[kept[i]];
        if (!polygon.texcoords.empty()) {
          mesh_.texcoord_corners[at][i] = polygon.texcoords[kept[i]];
        }
      }
      polygon.remove(ear);
    }
  }
}

void check_texcoords(TriangleMesh& mesh) {
  const bool is_shaded =
      std::any_of(mesh.surfaces.begin(), mesh.surfaces.end(), [&](const MeshSurface& surface) {
        const bool has_picture = surface.color != nullptr || surface.opacity != nullptr;
        return (has_picture && !mesh.texcoords.empty()) || surface.emission != std::array<double, 3>{};
      });
  if (!is_shaded) {
    mesh.surfaces = {};
    mesh.surface_of = {};
    mesh.texcoords = {};
    mesh.texcoord_corners = {};
    return;
  }
  if (!mesh.texcoord_corners.empty()) {
    mesh.texcoord_corners.resize(mesh.triangles.size(), {kNoTexcoord, kNoTexcoord, kNoTexcoord});
  }
  for (auto& corners : mesh.texcoord_corners) {
    if (std::any_of(corners.begin(), corners.end(),
                    [&](std::uint32_t number) { return number >= mesh.texcoords.size(); })) {
      corners.fill(kNoTexcoord);
    }
  }
  mesh.surface_of.resize(mesh.triangles.size());
}

void TriangleStrip::add(std::uint32_t corner) {
  if (corners_ >= 2 && older_ != last_ && last_ != corner && corner != older_) {
    const bool is_turned = corners_ % 2 != 0;
    mesh_.triangles.push_back({is_turned ? last_ : older_, is_turned ? older_ : last_, corner});
  }
  older_ = last_;
  last_ = corner;
  ++corners_;
}

Notes notes_of(const Source& source) {
  return std::visit(
      [](const auto& each) -> Notes {
        if constexpr (requires { each.notes; }) {
          return each.notes;
        } else if constexpr (requires { each->notes; }) {
          return each->notes;
        }
        return {};
      },
      source);
}

void note_left_out(Notes& notes, std::uint64_t points) {
  note_if(points != 0, notes, counted(points, "point is not finite and is", "points are not finite and are"),
          " left out");
}

Source mesh_or_points(TriangleMesh mesh, std::uint64_t face_count) {
  fail_if(mesh.positions.empty(), "the file holds no vertices");
  if (face_count == 0) {
    return std::make_unique<VertexCloud>(std::move(mesh));
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
