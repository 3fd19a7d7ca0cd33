#include "scene/voxelise_cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <vector>

#include "scene/world_fit.h"

namespace thimble::tools {
namespace {

constexpr int kCellLevel = 4;  ///< a cell has 16 voxels a side, and 4 x 4 x 4 cubes of 4 x 4 x 4 voxels
constexpr std::size_t kCubes = 64;
constexpr std::uint64_t kFull = ~std::uint64_t{0};

TriangleBlock child_of(const TriangleBlock& block, int child) {
  TriangleBlock part{block.voxel, block.level - 1, block.inside};
  for (int axis = 0; axis < 3; ++axis) {
    part.voxel[static_cast<std::size_t>(axis)] += (child >> axis & 1) << part.level;
  }
  return part;
}

/// What one cell holds: a bit and a material a voxel.
class Cell {
 public:
  explicit Cell(bool has_materials) : has_materials_(has_materials), materials_(has_materials ? 4096 : 0) {}

  void clear() {
    covered_.fill(0);
    full_cubes_ = 0;
    first_material_.reset();
    is_uniform_ = true;
  }
  bool is_full() const { return full_cubes_ == kFull; }

  /// Adds what `triangle` meets and no later triangle has. `cell` is of kCellLevel.
  void add(const CellTriangle& triangle, const TriangleBlock& cell) {
    const TriangleBoxTest test(triangle.corners);
    for (int octant = 0; octant < 8; ++octant) {
      const std::uint64_t cubes = std::uint64_t{0xFF} << (8 * octant);
      TriangleBlock part = child_of(cell, octant);
      if ((full_cubes_ & cubes) == cubes || !meets_block(test, part)) {
        continue;
      }
      for (int child = 0; child < 8; ++child) {
        const std::size_t cube =
            std::size_t{8} * static_cast<std::size_t>(octant) + static_cast<std::size_t>(child);
        TriangleBlock block = child_of(part, child);
        if (covered_[cube] != kFull && meets_block(test, block)) {
          take(cube, test.cube_mask(block.voxel, block.inside), triangle.material);
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
  void take(std::size_t cube, std::uint64_t mask, std::uint8_t material) {
    std::uint64_t added = mask & ~covered_[cube];
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
  std::array<std::uint64_t, kCubes> covered_{};  ///< by Morton number of the cube; bit x + 4 y + 16 z
  std::uint64_t full_cubes_ = 0;
  std::optional<std::uint8_t> first_material_;
  bool is_uniform_ = true;
  std::vector<std::uint8_t> materials_;
};

class Voxeliser {
 public:
  Voxeliser(std::span<const CellTriangle> triangles, int level, const BlockSink& sink,
            const Progress& progress)
      : triangles_(triangles),
        sink_(sink),
        progress_(progress),
        root_level_(std::max(level, kCellLevel)),
        cell_(std::any_of(triangles.begin(), triangles.end(), [&](const CellTriangle& triangle) {
          return triangle.material != triangles.front().material;
        })) {}

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
    if (list.empty() || block.level == kCellLevel) {
      const auto solid = list.empty() ? std::nullopt : visit_cell(block, list);
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
        TriangleBlock part = child_of(block, child);
        if (meets_block(test, part)) {
          parts[static_cast<std::size_t>(child)].push_back(index);
        }
      }
    }
    std::array<std::optional<std::uint8_t>, 8> solid;
    for (std::size_t child = 0; child < 8; ++child) {
      solid[child] = visit(child_of(block, static_cast<int>(child)), parts[child]);
    }
    if (solid[0] && std::count(solid.begin(), solid.end(), solid[0]) == 8) {
      return solid[0];
    }
    for (std::size_t child = 0; child < 8; ++child) {
      if (solid[child]) {
        const TriangleBlock part = child_of(block, static_cast<int>(child));
        sink_(part.voxel, part.level, *solid[child]);
      }
    }
    return std::nullopt;
  }

  std::optional<std::uint8_t> visit_cell(const TriangleBlock& block, const List& list) {
    cell_.clear();
    for (auto index = list.rbegin(); index != list.rend() && !cell_.is_full(); ++index) {
      cell_.add(triangles_[*index], block);
    }
    const auto solid = cell_.solid();
    if (!solid) {
      cell_.emit(block, sink_);
    }
    return solid;
  }

  void report(int level) {
    done_ += std::uint64_t{1} << (3 * (level - kCellLevel));
    if (progress_) {
      const std::uint64_t cells = std::uint64_t{1} << (3 * (root_level_ - kCellLevel));
      progress_(static_cast<double>(done_) / static_cast<double>(cells));
    }
  }

  std::span<const CellTriangle> triangles_;
  const BlockSink& sink_;
  const Progress& progress_;
  int root_level_;
  Cell cell_;
  std::array<std::array<List, 8>, 13> lists_;
  std::uint64_t done_ = 0;  ///< cells
};

}  // namespace

bool meets_block(const TriangleBoxTest& test, TriangleBlock& block) {
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

void voxelise_cells(std::span<const CellTriangle> triangles, int level, const BlockSink& sink,
                    const Progress& progress) {
  Voxeliser(triangles, level, sink, progress).run();
}

}  // namespace thimble::tools
