// A corner of the convex hull is a corner of the hull of its slab, whichever axis the slabs are cut along. So
// hulls of slabs, which are plane, leave few corners to look at.
#include "scene/scene_shape.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "scene/built_scene.h"
#include "scene/scene_source.h"

namespace thimble::tools {
namespace {

constexpr int kMostLevel = 10;

// Twice the area of the triangle a, b, c by its axes u and v; positive when it turns left.
inline std::int64_t turn(const Vec3i& a, const Vec3i& b, const Vec3i& c, int u, int v) {
  return std::int64_t{b[u] - a[u]} * (c[v] - a[v]) - std::int64_t{b[v] - a[v]} * (c[u] - a[u]);
}

// Appends one half of a plane hull: the corners of `begin` .. `end`, in their order, that are not to the right.
template <class Point>
void add_half_hull(Point begin, Point end, int u, int v, std::vector<Vec3i>* hull) {
  const std::size_t first = hull->size();
  for (Point point = begin; point != end; ++point) {
    while (hull->size() >= first + 2 && turn((*hull)[hull->size() - 2], hull->back(), *point, u, v) <= 0) {
      hull->pop_back();
    }
    hull->push_back(*point);
  }
}

// Appends the plane hulls of points, slab by slab across z: A. M. Andrew, "Another efficient algorithm for
// convex hulls in two dimensions", 1979.
std::vector<Vec3i> thinned_across_z(std::vector<Vec3i> points) {
  std::sort(points.begin(), points.end(), [](const Vec3i& a, const Vec3i& b) {
    return a.z != b.z ? a.z < b.z : a.x != b.x ? a.x < b.x : a.y < b.y;
  });
  std::vector<Vec3i> hull;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin;
    while (end < points.size() && points[end].z == points[begin].z) {
      ++end;
    }
    const auto at = [&](std::size_t i) { return points.begin() + static_cast<std::ptrdiff_t>(i); };
    add_half_hull(at(begin), at(end), 0, 1, &hull);
    add_half_hull(std::make_reverse_iterator(at(end)), std::make_reverse_iterator(at(begin)), 0, 1, &hull);
    begin = end;
  }
  return hull;
}

// The lowest and highest corner of each column of corners.
class Columns {
 public:
  explicit Columns(const CompactTree& tree)
      : tree_(tree),
        shift_(std::max(0, tree.level() - kMostLevel)),
        side_((std::size_t{1} << (tree.level() - shift_)) + 1),
        ends_(side_ * side_) {
    if (!tree.empty()) {
      find(false);
      find(true);
    }
  }

  void add(const Vec3i& corner, int level) {
    const std::int32_t size = std::int32_t{1} << level;
    const Vec3i from{corner.x >> shift_, corner.y >> shift_, corner.z >> shift_};
    const Vec3i to{up(corner.x + size), up(corner.y + size), up(corner.z + size)};
    const Ends added{static_cast<std::int16_t>(from.z), static_cast<std::int16_t>(to.z)};
    Ends* const first = ends_.data() + static_cast<std::size_t>(from.x) * side_;
    Ends* const last = ends_.data() + static_cast<std::size_t>(to.x) * side_;
    first[from.y].add(added);
    first[to.y].add(added);
    last[from.y].add(added);
    last[to.y].add(added);
  }
  // Adds what is lowest in each column, or what is highest: what lies behind that in all its columns is not looked at.
  void find(bool from_above) {
    for (int level = shift_; level <= tree_.level(); ++level) {
      found_[level].assign(std::size_t{1} << (2 * (tree_.level() - level)), false);
    }
    visit(0, tree_.level(), {}, from_above);
  }
  void visit(std::uint32_t node, int level, const Vec3i& corner, bool from_above) {
    const std::uint32_t mask = tree_.mask(node);
    if (mask == 0) {
      add(corner, level);
      return;
    }
    const int below = level - 1;
    const std::uint32_t first_child = tree_.first_child(node);
    for (unsigned place = 0; place < 8; ++place) {
      const unsigned octant = from_above ? 7 - place : place;
      const auto along = [&](unsigned axis) {
        return static_cast<std::int32_t>(octant >> axis & 1U) << below;
      };
      const Vec3i at{corner.x + along(0), corner.y + along(1), corner.z + along(2)};
      if ((mask >> octant & 1U) == 0 || found_[below][column(at, below)]) {
        continue;
      }
      if (below > shift_) {
        const auto before = static_cast<unsigned>(std::popcount(mask & ((1U << octant) - 1)));
        visit(first_child + before, below, at, from_above);
        continue;
      }
      add(at, below);
      set_found(at);
    }
  }
  std::size_t column(const Vec3i& at, int level) const {
    return static_cast<std::size_t>(at.y >> level) << (tree_.level() - level) |
           static_cast<std::size_t>(at.x >> level);
  }
  void set_found(const Vec3i& at) {
    found_[shift_][column(at, shift_)] = true;
    for (int level = shift_ + 1; level <= tree_.level(); ++level) {
      const std::int32_t half = 1 << (level - 1);
      const Vec3i corner{at.x & -2 * half, at.y & -2 * half, 0};
      for (const Vec3i& part : {Vec3i{0, 0, 0}, Vec3i{half, 0, 0}, Vec3i{0, half, 0}, Vec3i{half, half, 0}}) {
        if (!found_[level - 1][column({corner.x + part.x, corner.y + part.y, 0}, level - 1)]) {
          return;
        }
      }
      found_[level][column(at, level)] = true;
    }
  }
  // The corners that the plane hulls of all slabs across x leave.
  std::vector<Vec3i> thinned() const {
    std::vector<Vec3i> hull;
    std::vector<Vec3i> lows;
    std::vector<Vec3i> highs;
    for (std::size_t x = 0; x < side_; ++x) {
      lows.clear();
      highs.clear();
      for (std::size_t y = 0; y < side_; ++y) {
        const Ends& ends = ends_[x * side_ + y];
        if (ends.low <= ends.high) {
          const Vec3i corner{static_cast<std::int32_t>(x) << shift_, static_cast<std::int32_t>(y) << shift_,
                             0};
          lows.push_back({corner.x, corner.y, ends.low << shift_});
          highs.push_back({corner.x, corner.y, ends.high << shift_});
        }
      }
      if (!lows.empty()) {
        // There the lower half of the hull turns into the upper one, and here that into it.
        lows.push_back(highs.back());
        highs.insert(highs.begin(), lows.front());
        add_half_hull(lows.begin(), lows.end(), 1, 2, &hull);
        add_half_hull(highs.rbegin(), highs.rend(), 1, 2, &hull);
      }
    }
    return hull;
  }

 private:
  struct Ends {
    std::int16_t low = INT16_MAX;
    std::int16_t high = INT16_MIN;
    void add(const Ends& other) {
      low = std::min(low, other.low);
      high = std::max(high, other.high);
    }
  };

  std::int32_t up(std::int32_t value) const { return (value + (1 << shift_) - 1) >> shift_; }

  const CompactTree& tree_;
  int shift_;
  std::size_t side_;
  std::vector<bool> found_[kMaxLevel + 1];  // of each square of columns: whether all have their end
  std::vector<Ends> ends_;
};

SceneShape shape_in_frames(const SceneSource& source, int threads) {
  BuildOptions options;
  options.threads = threads;
  const auto whole = std::make_shared<const BuiltScene>(*source.in_frames(), options);
  SceneShape shape = shape_of(*whole);
  shape.owner = whole;
  return shape;
}

}  // namespace

std::array<Vec3i, 8> box_corners(const VoxelBox& box) {
  std::array<Vec3i, 8> corners;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    for (int axis = 0; axis < 3; ++axis) {
      corners[corner][axis] = ((corner >> axis) & 1U) != 0 ? box.high[axis] : box.low[axis];
    }
  }
  return corners;
}

SceneShape shape_of(const CompactTree& tree) {
  SceneShape shape;
  shape.level = tree.level();
  shape.bounds = tree.bounds();
  shape.tree = &tree;
  shape.corners = thinned_across_z(Columns(tree).thinned());
  return shape;
}

SceneShape shape_of(const BuiltScene& built) {
  if (built.structure() == StructureKind::kCompact) {
    SceneShape shape = shape_of(built.compact());
    shape.threads = built.threads();
    return shape;
  }
  SceneShape shape;
  shape.level = built.level();
  shape.bounds = built.bounds();
  if (!shape.bounds.empty()) {
    const std::array<Vec3i, 8> corners = box_corners(shape.bounds);
    shape.corners.assign(corners.begin(), corners.end());
  }
  return shape;
}

SceneShape shape_of(const SceneSource& source, const BuiltScene& built) {
  return source.in_frames() == nullptr ? shape_of(built) : shape_in_frames(source, built.threads());
}
SceneShape shape_of(const SceneSource& source, const CompactTree& tree) {
  return source.in_frames() == nullptr ? shape_of(tree) : shape_in_frames(source, 1);
}

}  // namespace thimble::tools
