// A corner of the convex hull is a corner of the hull of its slab, whichever axis the slabs are cut along. So
// hulls of slabs, which are plane, leave few corners to look at.
#include "scene/scene_shape.h"

#include <algorithm>
#include <cstdint>

#include "readers/oct.h"
#include "scene/built_scene.h"

namespace thimble::tools {
namespace {

constexpr int kMostLevel = 10;

// Twice the area of the triangle a, b, c by its axes u and v; positive when it turns left.
std::int64_t turn(const Vec3i& a, const Vec3i& b, const Vec3i& c, int u, int v) {
  return std::int64_t{b[u] - a[u]} * (c[v] - a[v]) - std::int64_t{b[v] - a[v]} * (c[u] - a[u]);
}

// Appends the plane hull of points that share a slab: A. M. Andrew, "Another efficient algorithm for convex
// hulls in two dimensions", 1979. `slab` is sorted on the way.
void add_plane_hull(std::vector<Vec3i>* slab, int u, int v, std::vector<Vec3i>* hull) {
  std::sort(slab->begin(), slab->end(),
            [u, v](const Vec3i& a, const Vec3i& b) { return a[u] != b[u] ? a[u] < b[u] : a[v] < b[v]; });
  const auto half = [&](auto begin, auto end) {
    const std::size_t first = hull->size();
    for (auto point = begin; point != end; ++point) {
      while (hull->size() >= first + 2 && turn((*hull)[hull->size() - 2], hull->back(), *point, u, v) <= 0) {
        hull->pop_back();
      }
      hull->push_back(*point);
    }
  };
  half(slab->begin(), slab->end());
  half(slab->rbegin(), slab->rend());
}

// The corners that the plane hulls of all slabs across `axis` leave.
std::vector<Vec3i> thinned(std::vector<Vec3i> points, int axis) {
  std::stable_sort(points.begin(), points.end(),
                   [axis](const Vec3i& a, const Vec3i& b) { return a[axis] < b[axis]; });
  std::vector<Vec3i> hull;
  std::vector<Vec3i> slab;
  for (std::size_t i = 0; i < points.size(); ++i) {
    slab.push_back(points[i]);
    if (i + 1 == points.size() || points[i + 1][axis] != points[i][axis]) {
      add_plane_hull(&slab, (axis + 1) % 3, (axis + 2) % 3, &hull);
      slab.clear();
    }
  }
  return hull;
}

// The lowest and highest corner of each column of corners.
class Columns {
 public:
  explicit Columns(int level)
      : shift_(std::max(0, level - kMostLevel)),
        side_((std::size_t{1} << (level - shift_)) + 1),
        low_(side_ * side_, INT16_MAX),
        high_(side_ * side_, INT16_MIN) {}

  void add(const Vec3i& corner, int level) {
    const std::int32_t size = std::int32_t{1} << level;
    const Vec3i from{corner.x >> shift_, corner.y >> shift_, corner.z >> shift_};
    const Vec3i to{up(corner.x + size), up(corner.y + size), up(corner.z + size)};
    for (const std::int32_t y : {from.y, to.y}) {
      for (const std::int32_t x : {from.x, to.x}) {
        const std::size_t at = static_cast<std::size_t>(y) * side_ + static_cast<std::size_t>(x);
        low_[at] = static_cast<std::int16_t>(std::min<std::int32_t>(low_[at], from.z));
        high_[at] = static_cast<std::int16_t>(std::max<std::int32_t>(high_[at], to.z));
      }
    }
  }
  std::vector<Vec3i> ends() const {
    std::vector<Vec3i> points;
    for (std::size_t at = 0; at < low_.size(); ++at) {
      if (low_[at] <= high_[at]) {
        const auto x = static_cast<std::int32_t>(at % side_) << shift_;
        const auto y = static_cast<std::int32_t>(at / side_) << shift_;
        points.push_back({x, y, low_[at] << shift_});
        points.push_back({x, y, high_[at] << shift_});
      }
    }
    return points;
  }

 private:
  std::int32_t up(std::int32_t value) const { return (value + (1 << shift_) - 1) >> shift_; }

  int shift_;
  std::size_t side_;
  std::vector<std::int16_t> low_;
  std::vector<std::int16_t> high_;
};

std::vector<Vec3i> corners_of(const VoxelBox& box) {
  std::vector<Vec3i> corners;
  for (unsigned corner = 0; corner < 8 && !box.empty(); ++corner) {
    corners.push_back({(corner & 1U) != 0 ? box.high.x : box.low.x,
                       (corner & 2U) != 0 ? box.high.y : box.low.y,
                       (corner & 4U) != 0 ? box.high.z : box.low.z});
  }
  return corners;
}

}  // namespace

SceneShape shape_of(const CompactTree& tree) {
  SceneShape shape;
  shape.level = tree.level();
  shape.bounds = tree.bounds();
  shape.tree = &tree;
  Columns columns(tree.level());
  if (!tree.empty()) {
    for_each_block(tree, [&](const Vec3i& corner, int level, std::uint8_t) { columns.add(corner, level); });
  }
  shape.corners = thinned(thinned(columns.ends(), 0), 2);
  return shape;
}

SceneShape shape_of(const BuiltScene& built) {
  if (built.structure() == StructureKind::kCompact) {
    return shape_of(built.compact());
  }
  SceneShape shape;
  shape.level = built.level();
  shape.bounds = built.bounds();
  shape.corners = corners_of(shape.bounds);
  return shape;
}

}  // namespace thimble::tools
