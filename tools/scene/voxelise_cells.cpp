#include "scene/voxelise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>
#include <vector>

namespace thimble::tools {
namespace {

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

  void add(const CellTriangle& triangle, const TriangleBlock& group) {
    add_to(TriangleBoxTest(triangle.corners), triangle, group, 0);
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

  void add_to(const TriangleBoxTest& test, const CellTriangle& triangle, const TriangleBlock& whole,
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
        group_(group_level_, shade) {}

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
      group_.add(triangles_[*index], block);
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

void voxelise_cells(std::span<const CellTriangle> triangles, int level, const BlockSink& sink,
                    const Progress& progress, const CellShade& shade) {
  Voxeliser(triangles, level, sink, progress, shade).run();
}

}  // namespace thimble::tools
