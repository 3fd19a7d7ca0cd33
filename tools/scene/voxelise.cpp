#include "scene/voxelise.h"

#include <algorithm>
#include <cstdlib>

#include "scene/world_fit.h"

namespace thimble::tools {
namespace {

/// The two coordinates that stay when `axis` is left out.
constexpr std::array<std::array<std::size_t, 2>, 3> kPlane{{{1, 2}, {0, 2}, {0, 1}}};

/// A cube of 2^level voxels a side by its lowest voxel.
struct Block {
  UnitPoint voxel;
  int level;
  /// Bit a: all that the block holds meets the slabs of the plane perpendicular to axis a.
  std::uint8_t inside = 0;
};

std::array<double, 3> turned(const std::array<double, 3>& p, bool z_up) {
  return z_up ? p : std::array<double, 3>{p[0], -p[2], p[1]};
}

/// First and last block of 2^level voxels whose closed extent meets the closed range low..high. The range
/// keeps off the world's border, so neither is outside.
std::int32_t first_block(std::int32_t low, int level) {
  return (low - 1) >> (kUnitBits + level);
}
std::int32_t last_block(std::int32_t high, int level) {
  return high >> (kUnitBits + level);
}

/// Voxels first..last, row by row; what a plane decides is asked once for each row, column or cell.
void emit_voxels(const TriangleBoxTest& test, const UnitPoint& first, const UnitPoint& last,
                 std::uint8_t material, const VoxelSink& sink) {
  constexpr std::int32_t kHalf = kUnitsPerVoxel / 2;
  for (std::int32_t z = first[2]; z <= last[2]; ++z) {
    for (std::int32_t y = first[1]; y <= last[1]; ++y) {
      UnitPoint center{0, y * kUnitsPerVoxel + kHalf, z * kUnitsPerVoxel + kHalf};
      if (!test.meets_plane(0, center, kHalf)) {
        continue;
      }
      for (std::int32_t x = first[0]; x <= last[0]; ++x) {
        center[0] = x * kUnitsPerVoxel + kHalf;
        if (test.meets_plane(1, center, kHalf) && test.meets_plane(2, center, kHalf) &&
            test.meets_surface(center, kHalf)) {
          sink(x, y, z, material);
        }
      }
    }
  }
}

/// Whether the triangle meets `block`; asks nothing that is known for the block it is part of, and adds to
/// `block.inside` what its parts need not ask.
bool meets_block(const TriangleBoxTest& test, Block& block) {
  const std::int32_t half = kUnitsPerVoxel / 2 << block.level;
  UnitPoint center;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    center[axis] = block.voxel[axis] * kUnitsPerVoxel + half;
  }
  if (!test.meets_bounds(center, half) || !test.meets_surface(center, half)) {
    return false;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if ((block.inside >> axis & 1) != 0) {
      continue;
    }
    if (!test.meets_plane(axis, center, half)) {
      return false;
    }
    if (block.level > 0 && test.inside_plane(axis, center, half)) {
      block.inside = static_cast<std::uint8_t>(block.inside | 1U << axis);
    }
  }
  return true;
}

/// Emits the voxels of a block that meets the triangle. The stack holds at most 7 siblings a level and the
/// block in hand.
void descend(const TriangleBoxTest& test, const Block& root, std::uint8_t material, const VoxelSink& sink) {
  std::array<Block, 7 * 12 + 1> stack;
  std::size_t depth = 0;
  stack[depth++] = root;
  while (depth > 0) {
    const Block block = stack[--depth];
    if (block.level == 0) {
      sink(block.voxel[0], block.voxel[1], block.voxel[2], material);
      continue;
    }
    const int level = block.level - 1;
    for (int child = 7; child >= 0; --child) {
      Block part{block.voxel, level, block.inside};
      for (int axis = 0; axis < 3; ++axis) {
        part.voxel[static_cast<std::size_t>(axis)] += (child >> axis & 1) << level;
      }
      if (meets_block(test, part)) {
        stack[depth++] = part;
      }
    }
  }
}

/// Triangles voxelised not long ago, so that a file that repeats them costs no more than reading it. What is
/// forgotten (one slot for all triangles of the same hash) is only voxelised again.
class RecentTriangles {
 public:
  /// `triangles` of the mesh, which bound the memory as well.
  explicit RecentTriangles(std::size_t triangles) {
    std::size_t slots = 1;
    while (slots < kMostSlots && slots < triangles) {
      slots *= 2;
    }
    slots_.resize(slots);
  }

  /// Whether voxelising `triangle` would change nothing, and notes that it is voxelised. A voxel has the
  /// material that came last, so a repeat is idle only when no other material came in between.
  bool is_repeat(UnitTriangle triangle, std::uint8_t material) {
    if (run_ == 0 || material != material_) {
      material_ = material;
      ++run_;
    }
    std::sort(triangle.begin(), triangle.end());
    std::uint64_t hash = 0;
    for (const UnitPoint& vertex : triangle) {
      for (const std::int32_t coordinate : vertex) {
        hash = (hash ^ static_cast<std::uint32_t>(coordinate)) * 0x9E3779B97F4A7C15U;
        hash ^= hash >> 29U;
      }
    }
    Slot& slot = slots_[hash & (slots_.size() - 1)];
    if (slot.run == run_ && slot.triangle == triangle) {
      return true;
    }
    slot = {triangle, run_};
    return false;
  }

 private:
  static constexpr std::size_t kMostSlots = 65536;
  struct Slot {
    UnitTriangle triangle{};  ///< vertices in ascending order
    std::uint64_t run = 0;    ///< which run of triangles of one material; 0 is an empty slot
  };
  std::vector<Slot> slots_;
  std::uint64_t run_ = 0;
  std::uint8_t material_ = 0;
};

/// About how many voxels a triangle may have: decides only how often progress is reported.
std::uint64_t rough_cost(const UnitTriangle& triangle) {
  std::array<std::uint64_t, 3> span{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] = std::minmax({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
    span[axis] = static_cast<std::uint64_t>(high - low) / kUnitsPerVoxel + 1;
  }
  std::sort(span.begin(), span.end());
  return span[1] * span[2];
}

}  // namespace

TriangleBoxTest::TriangleBoxTest(const UnitTriangle& triangle) : origin_(triangle[0]), slabs_{} {
  std::array<std::array<std::int64_t, 3>, 3> local{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low_[axis] = std::min({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
    high_[axis] = std::max({triangle[0][axis], triangle[1][axis], triangle[2][axis]});
    for (std::size_t i = 0; i < 3; ++i) {
      local[i][axis] = triangle[i][axis] - origin_[axis];
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [p, q] = kPlane[axis];
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const auto& from = local[edge];
      const auto& to = local[(edge + 1) % 3];
      const auto& other = local[(edge + 2) % 3];
      Slab& slab = slabs_[axis][edge];
      slab.u = from[q] - to[q];
      slab.v = to[p] - from[p];
      // Both ends of the edge give the same value, the third vertex the slab's other side.
      const std::int64_t on_edge = slab.u * from[p] + slab.v * from[q];
      const std::int64_t opposite = slab.u * other[p] + slab.v * other[q];
      slab.low = std::min(on_edge, opposite);
      slab.high = std::max(on_edge, opposite);
      slab.reach = std::abs(slab.u) + std::abs(slab.v);
    }
  }
  const auto& a = local[1];
  const auto& b = local[2];
  normal_ = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  normal_reach_ = std::abs(normal_[0]) + std::abs(normal_[1]) + std::abs(normal_[2]);
}

bool TriangleBoxTest::meets_bounds(const UnitPoint& center, std::int32_t half) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (high_[axis] < center[axis] - half || low_[axis] > center[axis] + half) {
      return false;
    }
  }
  return true;
}

bool TriangleBoxTest::meets_plane(std::size_t axis, const UnitPoint& center, std::int32_t half) const {
  const auto [p, q] = kPlane[axis];
  const std::int64_t x = center[p] - origin_[p];
  const std::int64_t y = center[q] - origin_[q];
  for (const Slab& slab : slabs_[axis]) {
    const std::int64_t value = slab.u * x + slab.v * y;
    const std::int64_t reach = slab.reach * half;
    if (value + reach < slab.low || value - reach > slab.high) {
      return false;
    }
  }
  return true;
}

bool TriangleBoxTest::inside_plane(std::size_t axis, const UnitPoint& center, std::int32_t half) const {
  const auto [p, q] = kPlane[axis];
  const std::int64_t x = center[p] - origin_[p];
  const std::int64_t y = center[q] - origin_[q];
  for (const Slab& slab : slabs_[axis]) {
    const std::int64_t value = slab.u * x + slab.v * y;
    const std::int64_t reach = slab.reach * half;
    if (value - reach < slab.low || value + reach > slab.high) {
      return false;
    }
  }
  return true;
}

bool TriangleBoxTest::meets_surface(const UnitPoint& center, std::int32_t half) const {
  std::int64_t distance = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    distance += normal_[axis] * (center[axis] - origin_[axis]);
  }
  return std::abs(distance) <= normal_reach_ * half;
}

std::vector<UnitPoint> quantise_vertices(const TriangleMesh& mesh, int level, bool z_up) {
  if (mesh.triangles.empty()) {
    throw InputError("no triangles");
  }
  Bounds bounds;
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      bounds.add(turned(mesh.positions[vertex], z_up));
    }
  }
  const WorldFit fit(bounds, level);
  std::vector<UnitPoint> units(mesh.positions.size());
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      // 0 is outside the fitted range, so it marks a vertex not done yet.
      if (units[vertex][0] == 0) {
        units[vertex] = fit.units(turned(mesh.positions[vertex], z_up));
      }
    }
  }
  return units;
}

void voxelise_triangle(const UnitTriangle& triangle, std::uint8_t material, const VoxelSink& sink) {
  // Wide enough that the bounding box spans at most five blocks a side: few for a triangle of some voxels,
  // which are then tested directly, and few tests wasted on a large one.
  constexpr std::int32_t kMaxSpan = 4;
  const TriangleBoxTest test(triangle);
  int level = 0;
  UnitPoint first{};
  UnitPoint last{};
  for (bool small = false; !small; ++level) {
    small = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = first_block(test.low()[axis], level);
      last[axis] = last_block(test.high()[axis], level);
      small = small && last[axis] - first[axis] <= kMaxSpan;
    }
  }
  --level;
  if (level == 0) {
    emit_voxels(test, first, last, material, sink);
    return;
  }
  for (std::int32_t z = first[2]; z <= last[2]; ++z) {
    for (std::int32_t y = first[1]; y <= last[1]; ++y) {
      for (std::int32_t x = first[0]; x <= last[0]; ++x) {
        Block block{{x << level, y << level, z << level}, level};
        if (meets_block(test, block)) {
          descend(test, block, material, sink);
        }
      }
    }
  }
}

Rgb triangle_color(const TriangleMesh& mesh, std::size_t index) {
  const auto& [a, b, c] = mesh.triangles[index];
  const Rgb& p = mesh.colors[a];
  const Rgb& q = mesh.colors[b];
  const Rgb& r = mesh.colors[c];
  return {static_cast<std::uint8_t>((p.r + q.r + r.r + 1) / 3),
          static_cast<std::uint8_t>((p.g + q.g + r.g + 1) / 3),
          static_cast<std::uint8_t>((p.b + q.b + r.b + 1) / 3)};
}

ColorHistogram triangle_colors(const TriangleMesh& mesh) {
  ColorHistogram histogram;
  if (!mesh.colors.empty()) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      histogram.add(triangle_color(mesh, i));
    }
  }
  return histogram;
}

void voxelise(const TriangleMesh& mesh, int level, bool z_up, const PaletteMap* colors, const VoxelSink& sink,
              const Progress& progress) {
  const std::vector<UnitPoint> units = quantise_vertices(mesh, level, z_up);
  const bool colored = colors != nullptr && !mesh.colors.empty();
  RecentTriangles recent(mesh.triangles.size());
  constexpr std::uint64_t kCostPerReport = 1 << 18;
  std::uint64_t cost = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (progress && (i % 4096 == 0 || cost >= kCostPerReport)) {
      progress(static_cast<double>(i) / static_cast<double>(mesh.triangles.size()));
      cost = 0;
    }
    const auto& [a, b, c] = mesh.triangles[i];
    const UnitTriangle triangle{units[a], units[b], units[c]};
    const std::uint8_t material = colored ? colors->index(triangle_color(mesh, i)) : std::uint8_t{0};
    if (recent.is_repeat(triangle, material)) {
      continue;
    }
    cost += rough_cost(triangle);
    voxelise_triangle(triangle, material, sink);
  }
}

}  // namespace thimble::tools
