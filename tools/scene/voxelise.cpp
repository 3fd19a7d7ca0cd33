#include "scene/voxelise.h"

#include <algorithm>
#include <bit>

#include "scene/mesh_shade.h"
#include "scene/world_fit.h"

namespace thimble::tools {
namespace {

constexpr std::int32_t kHalfVoxel = kUnitsPerVoxel / 2;

/// The two coordinates that stay when `axis` is left out.
constexpr std::array<std::array<std::size_t, 2>, 3> kPlane{{{1, 2}, {0, 2}, {0, 1}}};

/// Bits p + 4 q of the plane perpendicular to `axis` as bits x + 4 y + 16 z, the same all along the axis.
std::uint64_t spread_plane(std::size_t axis, std::uint64_t cells) {
  if (axis == 2) {
    return cells * 0x0001000100010001U;
  }
  std::uint64_t spread = 0;
  for (int i = 0; i < 4; ++i) {
    const std::uint64_t four = cells >> (4 * i) & 0xF;
    if (axis == 1) {
      spread |= four * 0x1111U << (16 * i);
    } else {
      const std::uint64_t apart = (four | four << 3 | four << 6 | four << 9) & 0x1111U;
      spread |= apart * 0xF << (16 * i);
    }
  }
  return spread;
}

std::array<double, 3> turned(const std::array<double, 3>& p, bool z_up) {
  return z_up ? p : std::array<double, 3>{p[0], -p[2], p[1]};
}

/// The voxels of a block of at least 4 a side that meet the triangle.
void visit_met(const TriangleBoxTest& test, const TriangleBlock& block,
               const std::function<void(const UnitPoint& voxel)>& visit) {
  if (block.level > 2) {
    for (int child = 0; child < 8; ++child) {
      const TriangleBlock part = child_of(block, child);
      if (meets_block(test, part)) {
        visit_met(test, part, visit);
      }
    }
    return;
  }
  for (std::uint64_t met = test.met_mask(block.voxel); met != 0; met &= met - 1) {
    visit(voxel_of(block.voxel, met));
  }
}

/// What triangle by triangle is quickly done, whatever the world; and what a triangle of a scan has at most.
constexpr std::uint64_t kCheapVoxels = std::uint64_t{1} << 24;
constexpr std::uint64_t kSmallTriangleVoxels = 64;

/// About how many voxels a triangle may have: decides only how they are found and how often progress is reported.
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
  return std::all_of(slabs_[axis].begin(), slabs_[axis].end(), [&](const Slab& slab) {
    const std::int64_t value = slab.u * x + slab.v * y;
    const std::int64_t reach = slab.reach * half;
    return value + reach >= slab.low && value - reach <= slab.high;
  });
}

std::uint64_t TriangleBoxTest::met_mask(const UnitPoint& voxel) const {
  const std::uint64_t mask = surface_mask(voxel);
  return mask == 0 ? 0 : mask & bounds_mask(voxel) & slabs_mask(voxel);
}

std::uint64_t TriangleBoxTest::bounds_mask(const UnitPoint& voxel) const {
  constexpr std::uint64_t kOnes = 0x1111111111111111U;
  // Along x the bits of a nibble, along y nibbles, along z sixteen bits.
  constexpr std::array<std::array<std::uint64_t, 4>, 3> kRows{
      {{kOnes, kOnes << 1, kOnes << 2, kOnes << 3},
       {0x000F000F000F000FU, 0x00F000F000F000F0U, 0x0F000F000F000F00U, 0xF000F000F000F000U},
       {0xFFFFU, 0xFFFFULL << 16, 0xFFFFULL << 32, 0xFFFFULL << 48}}};
  std::uint64_t mask = ~std::uint64_t{0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t first = std::max(((low_[axis] - 1) >> kUnitBits) - voxel[axis], 0);
    const std::int32_t last = std::min((high_[axis] >> kUnitBits) - voxel[axis], 3);
    std::uint64_t rows = 0;
    for (std::int32_t i = first; i <= last; ++i) {
      rows |= kRows[axis][static_cast<std::size_t>(i)];
    }
    mask &= rows;
  }
  return mask;
}

std::uint64_t TriangleBoxTest::slabs_mask(const UnitPoint& voxel) const {
  std::uint64_t mask = ~std::uint64_t{0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [p, q] = kPlane[axis];
    // The first voxel's centre from vertex 0.
    const std::int64_t at_p = voxel[p] * kUnitsPerVoxel + kHalfVoxel - origin_[p];
    const std::int64_t at_q = voxel[q] * kUnitsPerVoxel + kHalfVoxel - origin_[q];
    std::uint64_t cells = 0xFFFF;  // bit p + 4 q
    for (const Slab& slab : slabs_[axis]) {
      const std::int64_t low = slab.low - slab.reach * kHalfVoxel;
      const auto width = static_cast<std::uint64_t>(slab.high - slab.low + 2 * slab.reach * kHalfVoxel);
      std::int64_t row = slab.u * at_p + slab.v * at_q - low;
      std::uint64_t passed = 0;
      for (int bit = 0; bit < 16; bit += 4, row += slab.v * kUnitsPerVoxel) {
        std::int64_t value = row;
        for (int i = 0; i < 4; ++i, value += slab.u * kUnitsPerVoxel) {
          passed |= std::uint64_t{static_cast<std::uint64_t>(value) <= width} << (bit + i);
        }
      }
      cells &= passed;
    }
    mask &= spread_plane(axis, cells);
  }
  return mask;
}

std::uint64_t TriangleBoxTest::surface_mask(const UnitPoint& voxel) const {
  const std::int64_t reach = normal_reach_ * kHalfVoxel;
  // From the first voxel's centre on.
  std::int64_t slice =
      distance({voxel[0] * kUnitsPerVoxel + kHalfVoxel, voxel[1] * kUnitsPerVoxel + kHalfVoxel,
                voxel[2] * kUnitsPerVoxel + kHalfVoxel}) +
      reach;
  const auto width = static_cast<std::uint64_t>(2 * reach);
  std::uint64_t passed = 0;
  for (int z = 0; z < 64; z += 16, slice += normal_[2] * kUnitsPerVoxel) {
    std::int64_t row = slice;
    for (int y = 0; y < 16; y += 4, row += normal_[1] * kUnitsPerVoxel) {
      std::int64_t value = row;
      for (int x = 0; x < 4; ++x, value += normal_[0] * kUnitsPerVoxel) {
        passed |= std::uint64_t{static_cast<std::uint64_t>(value) <= width} << (x + y + z);
      }
    }
  }
  return passed;
}

UnitPoint voxel_of(const UnitPoint& corner, std::uint64_t mask) {
  const int bit = std::countr_zero(mask);
  return {corner[0] + (bit & 3), corner[1] + (bit >> 2 & 3), corner[2] + (bit >> 4)};
}

TriangleBlock child_of(const TriangleBlock& block, int child) {
  TriangleBlock part{block.voxel, block.level - 1};
  for (int axis = 0; axis < 3; ++axis) {
    part.voxel[static_cast<std::size_t>(axis)] += (child >> axis & 1) << part.level;
  }
  return part;
}

bool meets_block(const TriangleBoxTest& test, const TriangleBlock& block) {
  const std::int32_t half = kHalfVoxel << block.level;
  return test.meets({block.voxel[0] * kUnitsPerVoxel + half, block.voxel[1] * kUnitsPerVoxel + half,
                     block.voxel[2] * kUnitsPerVoxel + half},
                    half);
}

std::vector<UnitPoint> quantise_vertices(const TriangleMesh& mesh, int level, bool z_up) {
  fail_if(mesh.triangles.empty(), "no triangles");
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

void voxelise_triangle(const UnitTriangle& triangle,
                       const std::function<void(const UnitPoint& voxel)>& visit) {
  const TriangleBoxTest test(triangle);
  // The least block of the octree that holds it. It keeps off the world's border, so no voxel that it meets is outside.
  TriangleBlock block{{}, 2};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.voxel[axis] = (test.low()[axis] - 1) >> kUnitBits;
    const std::int32_t last = test.high()[axis] >> kUnitBits;
    block.level = std::max(block.level,
                           static_cast<int>(std::bit_width(static_cast<unsigned>(block.voxel[axis] ^ last))));
  }
  for (std::int32_t& coordinate : block.voxel) {
    coordinate = coordinate >> block.level << block.level;
  }
  visit_met(test, block, visit);
}

bool is_shaded(const TriangleMesh& mesh) {
  return !mesh.colors.empty() || !mesh.face_colors.empty() || !mesh.surfaces.empty();
}

void voxelise_triangles(std::size_t count, std::size_t passes,
                        const std::function<CellTriangle(std::size_t)>& triangle_at, int level,
                        const CellShade& shade, const BlockSink& sink, const Progress& progress) {
  std::uint64_t all_cost = 0;
  for (std::size_t i = 0; i < count; ++i) {
    all_cost += rough_cost(triangle_at(i).corners);
  }
  const std::size_t end = passes * count;
  if (all_cost > std::max(kCheapVoxels, kSmallTriangleVoxels * count)) {
    std::vector<CellTriangle> triangles;
    triangles.reserve(end);
    for (std::size_t i = 0; i < end; ++i) {
      triangles.push_back(triangle_at(i));
    }
    voxelise_cells(triangles, level, sink, progress, shade);
    return;
  }
  constexpr std::uint64_t kCostPerReport = 1 << 18;
  std::uint64_t cost = 0;
  for (std::size_t i = 0; i < end; ++i) {
    if (progress && (i % 4096 == 0 || cost >= kCostPerReport)) {
      progress(static_cast<double>(i) / static_cast<double>(end));
      cost = 0;
    }
    const CellTriangle triangle = triangle_at(i);
    cost += rough_cost(triangle.corners);
    voxelise_triangle(triangle.corners, [&](const UnitPoint& voxel) {
      if (const auto material = shade ? shade(triangle, voxel) : std::optional(std::uint8_t{0})) {
        sink(voxel, 0, *material);
      }
    });
  }
}

void voxelise(const TriangleMesh& mesh, int level, bool z_up, const PaletteMap* colors, const BlockSink& sink,
              const Progress& progress) {
  if (is_shaded(mesh)) {
    const auto material_of = [&](Rgb color, std::uint32_t power_q8) {
      return colors == nullptr ? std::uint8_t{0} : colors->index(color, power_q8 != 0);
    };
    voxelise_shaded(mesh, level, z_up, material_of, sink, progress);
    return;
  }
  const std::vector<UnitPoint> units = quantise_vertices(mesh, level, z_up);
  const auto triangle_at = [&](std::size_t i) {
    const auto& [a, b, c] = mesh.triangles[i];
    return CellTriangle{{units[a], units[b], units[c]}};
  };
  voxelise_triangles(mesh.triangles.size(), 1, triangle_at, level, {}, sink, progress);
}

}  // namespace thimble::tools
