#include "scene/voxelise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <vector>

#include "scene/world_fit.h"

namespace thimble::tools {
namespace {

constexpr int kCellLevel = 4;   ///< a cell has 16 voxels a side, and 4 x 4 x 4 cubes of 4 x 4 x 4 voxels
constexpr int kGroupLevel = 6;  ///< cells that are filled together: 4 x 4 x 4
constexpr std::size_t kCubes = 64;
constexpr std::uint64_t kFull = ~std::uint64_t{0};

TriangleBlock child_of(const TriangleBlock& block, int child) {
  TriangleBlock part{block.voxel, block.level - 1, block.inside};
  for (int axis = 0; axis < 3; ++axis) {
    part.voxel[static_cast<std::size_t>(axis)] += (child >> axis & 1) << part.level;
  }
  return part;
}

std::int32_t half_of(int level) {
  return kUnitsPerVoxel / 2 << level;
}

UnitPoint center_of(const TriangleBlock& block) {
  const std::int32_t half = half_of(block.level);
  return {block.voxel[0] * kUnitsPerVoxel + half, block.voxel[1] * kUnitsPerVoxel + half,
          block.voxel[2] * kUnitsPerVoxel + half};
}

/// A test that knows how the distance from the plane changes from a cube's centre to that of an eighth of it.
class SteppingTest : public TriangleBoxTest {
 public:
  explicit SteppingTest(const UnitTriangle& triangle) : TriangleBoxTest(triangle) {
    for (std::size_t child = 0; child < 8; ++child) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        steps_[child] += (child >> axis & 1) != 0 ? normal()[axis] : -normal()[axis];
      }
    }
  }
  /// Bit a of `child`: the upper half of axis a. The eighth has sides of 2^`level` voxels.
  std::int64_t distance_step(int child, int level) const {
    return steps_[static_cast<std::size_t>(child)] * half_of(level);
  }

 private:
  std::array<std::int64_t, 8> steps_{};  ///< sums of the normal's components, each with the child's sign
};

/// A block and the distance of its centre from a triangle's plane, which steps from part to part.
struct NearBlock {
  TriangleBlock block;
  std::int64_t distance;
};

/// Whether the triangle meets that part of `whole`, which becomes `part`.
bool meets_part(const SteppingTest& test, const NearBlock& whole, int child, NearBlock* part) {
  const int level = whole.block.level - 1;
  part->distance = whole.distance + test.distance_step(child, level);
  if (!test.meets_surface(part->distance, half_of(level))) {
    return false;
  }
  part->block = child_of(whole.block, child);
  return meets_slabs(test, part->block);
}

/// What one cell holds: a bit and a material a voxel.
class Cell {
 public:
  Cell(bool has_materials, const CellShade& shade)
      : has_materials_(has_materials), shade_(shade), materials_(has_materials ? 4096 : 0) {}

  void clear() {
    covered_.fill(0);
    full_cubes_ = 0;
    first_material_.reset();
    is_uniform_ = true;
  }
  bool is_full() const { return full_cubes_ == kFull; }

  /// Adds what a triangle meets and no later triangle has. `cell` is of kCellLevel.
  void add(const SteppingTest& test, const CellTriangle& triangle, const NearBlock& cell) {
    NearBlock part{};
    NearBlock block{};
    for (int octant = 0; octant < 8; ++octant) {
      const std::uint64_t cubes = std::uint64_t{0xFF} << (8 * octant);
      if ((full_cubes_ & cubes) == cubes || !meets_part(test, cell, octant, &part)) {
        continue;
      }
      for (int child = 0; child < 8; ++child) {
        const std::size_t cube =
            std::size_t{8} * static_cast<std::size_t>(octant) + static_cast<std::size_t>(child);
        if (covered_[cube] != kFull && meets_part(test, part, child, &block)) {
          const std::uint64_t met = missing_met(test, block, ~covered_[cube]);
          if (shade_) {
            take_shaded(cube, met, triangle, block.block);
          } else {
            take(cube, met, triangle.material);
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
  /// Which of the voxels `missing` of a cube the triangle meets. A few are tested one by one.
  static std::uint64_t missing_met(const SteppingTest& test, const NearBlock& cube, std::uint64_t missing) {
    constexpr std::uint64_t kSome = 8;
    std::uint64_t left = missing;
    for (std::uint64_t i = 0; i < kSome; ++i) {
      left &= left - 1;
    }
    const TriangleBlock& block = cube.block;
    if (left != 0) {
      const std::uint64_t met = test.surface_mask(cube.distance) & missing;
      return met == 0 || block.inside == kAllInside ? met : met & test.slab_mask(block.voxel, block.inside);
    }
    std::uint64_t met = 0;
    for (; missing != 0; missing &= missing - 1) {
      const int bit = std::countr_zero(missing);
      TriangleBlock voxel{
          {block.voxel[0] + (bit & 3), block.voxel[1] + (bit >> 2 & 3), block.voxel[2] + (bit >> 4)},
          0,
          block.inside};
      met |= std::uint64_t{meets_block(test, voxel)} << bit;
    }
    return met;
  }

  void take_shaded(std::size_t cube, std::uint64_t met, const CellTriangle& triangle,
                   const TriangleBlock& block) {
    for (; met != 0; met &= met - 1) {
      const int bit = std::countr_zero(met);
      const auto material = shade_(triangle, {block.voxel[0] + (bit & 3), block.voxel[1] + (bit >> 2 & 3),
                                              block.voxel[2] + (bit >> 4)});
      if (material) {
        take(cube, std::uint64_t{1} << bit, *material);
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
    for (; has_materials_ && added != 0; added &= added - 1) {
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
      const int bit = std::countr_zero(left);
      sink({block.voxel[0] + (bit & 3), block.voxel[1] + (bit >> 2 & 3), block.voxel[2] + (bit >> 4)}, 0,
           has_materials_ ? materials_[64 * cube + static_cast<std::size_t>(bit)] : *first_material_);
    }
  }

  bool has_materials_;
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
  Group(int level, bool has_materials, const CellShade& shade)
      : cells_(std::size_t{1} << (3 * (level - kCellLevel)), Cell(has_materials, shade)) {
    all_ = cells_.size() == 64 ? kFull : (std::uint64_t{1} << cells_.size()) - 1;
  }

  void clear() { touched_ = full_ = 0; }
  bool is_full() const { return full_ == all_; }

  void add(const CellTriangle& triangle, const TriangleBlock& group) {
    const SteppingTest test(triangle.corners);
    add_to(test, triangle, {group, test.distance(center_of(group))}, 0);
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

  void add_to(const SteppingTest& test, const CellTriangle& triangle, const NearBlock& whole,
              std::size_t first) {
    const int level = whole.block.level - 1;
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
    NearBlock part{};
    for (int child = 0; child < 8; ++child) {
      const std::size_t at = cell_of(whole.block, first, child);
      if ((full_ >> at & some) != some && meets_part(test, whole, child, &part)) {
        add_to(test, triangle, part, at);
      }
    }
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
        group_(group_level_,
               shade || std::any_of(triangles.begin(), triangles.end(),
                                    [&](const CellTriangle& triangle) {
                                      return triangle.material != triangles.front().material;
                                    }),
               shade) {}

  void run() {
    std::vector<std::uint32_t> all(triangles_.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i] = static_cast<std::uint32_t>(i);
    }
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
      const SteppingTest test(triangles_[index].corners);
      const NearBlock whole{block, test.distance(center_of(block))};
      NearBlock part{};
      for (int child = 0; child < 8; ++child) {
        if (meets_part(test, whole, child, &part)) {
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
      group_.add(triangles_[*index], block);
    }
    return group_.emit(block, 0, sink_);
  }

  void report(int level) {
    done_ += std::uint64_t{1} << (3 * (level - group_level_));
    if (progress_) {
      const std::uint64_t groups = std::uint64_t{1} << (3 * (root_level_ - group_level_));
      progress_(static_cast<double>(done_) / static_cast<double>(groups));
    }
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

bool meets_block(const TriangleBoxTest& test, TriangleBlock& block) {
  return test.meets_surface(center_of(block), half_of(block.level)) && meets_slabs(test, block);
}

bool meets_slabs(const TriangleBoxTest& test, TriangleBlock& block) {
  if (block.inside == kAllInside) {
    return true;
  }
  const std::int32_t half = half_of(block.level);
  const UnitPoint center = center_of(block);
  if ((block.inside & 8U) == 0) {
    if (!test.meets_bounds(center, half)) {
      return false;
    }
    if (block.level > 0 && test.inside_bounds(center, half)) {
      block.inside |= 8U;
    }
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

void voxelise_cells(std::span<const CellTriangle> triangles, int level, const BlockSink& sink,
                    const Progress& progress, const CellShade& shade) {
  Voxeliser(triangles, level, sink, progress, shade).run();
}

}  // namespace thimble::tools
