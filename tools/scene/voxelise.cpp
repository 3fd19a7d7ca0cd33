#include "scene/voxelise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <optional>
#include <vector>

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

constexpr int kCellLevel = 4;   ///< a cell has 16 voxels a side, and 4 x 4 x 4 cubes of 4 x 4 x 4 voxels
constexpr int kGroupLevel = 6;  ///< cells that are filled together: 4 x 4 x 4
constexpr std::size_t kCubes = 64;
constexpr std::uint64_t kFull = ~std::uint64_t{0};

/// What one cell holds: a bit and a material a voxel.
class Cell {
 public:
  explicit Cell(const CellShade& shade) : shade_(shade), materials_(shade ? 4096 : 0) {}

  void clear() {
    covered_.fill(0);
    full_cubes_ = 0;
    first_material_.reset();
    is_uniform_ = true;
  }
  bool is_full() const { return full_cubes_ == kFull; }

  /// Adds what a triangle meets and no later triangle has. `cell` is of kCellLevel.
  void add(const TriangleBoxTest& test, const CellTriangle& triangle, const TriangleBlock& cell) {
    for (int octant = 0; octant < 8; ++octant) {
      const std::uint64_t cubes = std::uint64_t{0xFF} << (8 * octant);
      const TriangleBlock part = child_of(cell, octant);
      if ((full_cubes_ & cubes) == cubes || !meets_block(test, part)) {
        continue;
      }
      for (int child = 0; child < 8; ++child) {
        const std::size_t cube =
            std::size_t{8} * static_cast<std::size_t>(octant) + static_cast<std::size_t>(child);
        const TriangleBlock block = child_of(part, child);
        if (covered_[cube] != kFull && meets_block(test, block)) {
          const std::uint64_t met = test.met_mask(block.voxel) & ~covered_[cube];
          if (shade_) {
            take_shaded(cube, met, triangle, block);
          } else {
            take(cube, met, 0);
          }
        }
      }
    }
  }

  /// The one material of a full cell.
  std::optional<std::uint8_t> solid() const {
    return is_full() && is_uniform_ ? first_material_ : std::nullopt;
  }

  /// Hands over what is in it.
  void emit(const TriangleBlock& cell, const BlockSink& sink) const {
    for (int octant = 0; octant < 8; ++octant) {
      const TriangleBlock part = child_of(cell, octant);
      const auto first = std::size_t{8} * static_cast<std::size_t>(octant);
      const std::uint64_t cubes = std::uint64_t{0xFF} << first;
      if (is_uniform_ && (full_cubes_ & cubes) == cubes) {
        sink(part.voxel, part.level, *first_material_);
        continue;
      }
      for (int child = 0; child < 8; ++child) {
        emit_cube(first + static_cast<std::size_t>(child), child_of(part, child), sink);
      }
    }
  }

 private:
  void take_shaded(std::size_t cube, std::uint64_t met, const CellTriangle& triangle,
                   const TriangleBlock& block) {
    for (; met != 0; met &= met - 1) {
      if (const auto material = shade_(triangle, voxel_of(block.voxel, met))) {
        take(cube, met & -met, *material);
      }
    }
  }

  void take(std::size_t cube, std::uint64_t added, std::uint8_t material) {
    if (added == 0) {
      return;
    }
    covered_[cube] |= added;
    full_cubes_ |= std::uint64_t{covered_[cube] == kFull} << cube;
    is_uniform_ = is_uniform_ && first_material_.value_or(material) == material;
    first_material_ = first_material_.value_or(material);
    for (; shade_ && added != 0; added &= added - 1) {
      materials_[64 * cube + static_cast<std::size_t>(std::countr_zero(added))] = material;
    }
  }

  void emit_cube(std::size_t cube, const TriangleBlock& block, const BlockSink& sink) const {
    if (is_uniform_ && covered_[cube] == kFull) {
      sink(block.voxel, block.level, *first_material_);
      return;
    }
    std::uint64_t left = covered_[cube];
    for (int child = 0; is_uniform_ && child < 8; ++child) {
      constexpr std::uint64_t kEight = 0x330033;  // two by two by two
      const std::uint64_t eight = kEight << (2 * (child & 1) + 8 * (child >> 1 & 1) + 32 * (child >> 2));
      if ((left & eight) == eight) {
        const TriangleBlock part = child_of(block, child);
        sink(part.voxel, part.level, *first_material_);
        left &= ~eight;
      }
    }
    for (; left != 0; left &= left - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(left));
      sink(voxel_of(block.voxel, left), 0, shade_ ? materials_[64 * cube + bit] : *first_material_);
    }
  }

  const CellShade& shade_;
  std::array<std::uint64_t, kCubes> covered_{};  ///< by Morton number of the cube; bit x + 4 y + 16 z
  std::uint64_t full_cubes_ = 0;
  std::optional<std::uint8_t> first_material_;
  bool is_uniform_ = true;
  std::vector<std::uint8_t> materials_;
};

/// Cells that lie together, filled by one triangle after the other, the last one first, so that no triangle is
/// asked of a cell that later ones have filled.
class Group {
 public:
  Group(int level, const CellShade& shade)
      : cells_(std::size_t{1} << (3 * (level - kCellLevel)), Cell(shade)) {
    all_ = cells_.size() == 64 ? kFull : (std::uint64_t{1} << cells_.size()) - 1;
  }

  void clear() { touched_ = full_ = 0; }
  bool is_full() const { return full_ == all_; }

  /// Adds what a triangle meets of `whole`, whose cells are `first` and on.
  void add(const TriangleBoxTest& test, const CellTriangle& triangle, const TriangleBlock& whole,
           std::size_t first) {
    const int level = whole.level - 1;
    if (level < kCellLevel) {
      const std::uint64_t bit = std::uint64_t{1} << first;
      Cell& cell = cells_[first];
      if ((touched_ & bit) == 0) {
        touched_ |= bit;
        cell.clear();
      }
      cell.add(test, triangle, whole);
      full_ |= cell.is_full() ? bit : 0;
      return;
    }
    const std::uint64_t some = (std::uint64_t{1} << (1 << (3 * (level - kCellLevel)))) - 1;
    for (int child = 0; child < 8; ++child) {
      const std::size_t at = cell_of(whole, first, child);
      const TriangleBlock part = child_of(whole, child);
      if ((full_ >> at & some) != some && meets_block(test, part)) {
        add(test, triangle, part, at);
      }
    }
  }

  /// Hands over what `block`, whose cells are `first` and on, holds; where it is full of one material says that and
  /// leaves it to the caller.
  std::optional<std::uint8_t> emit(const TriangleBlock& block, std::size_t first,
                                   const BlockSink& sink) const {
    if (block.level == kCellLevel) {
      if ((touched_ >> first & 1) == 0) {
        return std::nullopt;
      }
      const auto solid = cells_[first].solid();
      if (!solid) {
        cells_[first].emit(block, sink);
      }
      return solid;
    }
    std::array<std::optional<std::uint8_t>, 8> solid;
    for (int child = 0; child < 8; ++child) {
      solid[static_cast<std::size_t>(child)] =
          emit(child_of(block, child), cell_of(block, first, child), sink);
    }
    return emit_solid(block, solid, sink);
  }

  /// Of eight parts, those that are full of one material: all of them as one where they are of the same.
  static std::optional<std::uint8_t> emit_solid(const TriangleBlock& block,
                                                const std::array<std::optional<std::uint8_t>, 8>& solid,
                                                const BlockSink& sink) {
    if (solid[0] && std::count(solid.begin(), solid.end(), solid[0]) == 8) {
      return solid[0];
    }
    for (std::size_t child = 0; child < 8; ++child) {
      if (solid[child]) {
        const TriangleBlock part = child_of(block, static_cast<int>(child));
        sink(part.voxel, part.level, *solid[child]);
      }
    }
    return std::nullopt;
  }

 private:
  /// The first cell of a part, in Morton order.
  static std::size_t cell_of(const TriangleBlock& block, std::size_t first, int child) {
    return first + (static_cast<std::size_t>(child) << (3 * (block.level - 1 - kCellLevel)));
  }

  std::vector<Cell> cells_;  ///< in Morton order
  std::uint64_t all_ = 0;
  std::uint64_t touched_ = 0;  ///< cells that hold anything; the others are not cleared yet
  std::uint64_t full_ = 0;
};

class Voxeliser {
 public:
  Voxeliser(std::span<const CellTriangle> triangles, int level, const BlockSink& sink,
            const Progress& progress, const CellShade& shade)
      : triangles_(triangles),
        sink_(sink),
        progress_(progress),
        root_level_(std::max(level, kCellLevel)),
        group_level_(std::min(root_level_, kGroupLevel)),
        group_(group_level_, shade) {}

  void run() {
    std::vector<std::uint32_t> all(triangles_.size());
    std::iota(all.begin(), all.end(), 0U);
    const TriangleBlock root{{0, 0, 0}, root_level_};
    if (const auto solid = visit(root, all)) {
      sink_(root.voxel, root.level, *solid);
    }
  }

 private:
  using List = std::vector<std::uint32_t>;

  /// Hands over what `block` holds; where it is full of one material says that and leaves it to the caller.
  std::optional<std::uint8_t> visit(const TriangleBlock& block, const List& list) {
    if (list.empty() || block.level == group_level_) {
      const auto solid = list.empty() ? std::nullopt : visit_group(block, list);
      report(block.level);
      return solid;
    }
    std::array<List, 8>& parts = lists_[static_cast<std::size_t>(block.level)];
    for (List& part : parts) {
      part.clear();
    }
    for (const std::uint32_t index : list) {
      const TriangleBoxTest test(triangles_[index].corners);
      for (int child = 0; child < 8; ++child) {
        if (meets_block(test, child_of(block, child))) {
          parts[static_cast<std::size_t>(child)].push_back(index);
        }
      }
    }
    std::array<std::optional<std::uint8_t>, 8> solid;
    for (std::size_t child = 0; child < 8; ++child) {
      solid[child] = visit(child_of(block, static_cast<int>(child)), parts[child]);
    }
    return Group::emit_solid(block, solid, sink_);
  }

  std::optional<std::uint8_t> visit_group(const TriangleBlock& block, const List& list) {
    group_.clear();
    for (auto index = list.rbegin(); index != list.rend() && !group_.is_full(); ++index) {
      const CellTriangle& triangle = triangles_[*index];
      group_.add(TriangleBoxTest(triangle.corners), triangle, block, 0);
    }
    return group_.emit(block, 0, sink_);
  }

  void report(int level) {
    done_ += std::uint64_t{1} << (3 * (level - group_level_));
    const std::uint64_t groups = std::uint64_t{1} << (3 * (root_level_ - group_level_));
    tell(progress_, static_cast<double>(done_) / static_cast<double>(groups));
  }

  std::span<const CellTriangle> triangles_;
  const BlockSink& sink_;
  const Progress& progress_;
  int root_level_;
  int group_level_;
  Group group_;
  std::array<std::array<List, 8>, 13> lists_;
  std::uint64_t done_ = 0;  ///< groups
};

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

void voxelise_cells(std::span<const CellTriangle> triangles, int level, const BlockSink& sink,
                    const Progress& progress, const CellShade& shade) {
  Voxeliser(triangles, level, sink, progress, shade).run();
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
