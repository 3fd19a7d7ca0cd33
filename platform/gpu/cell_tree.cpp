#include "gpu/cell_tree.h"

#include <array>

namespace thimble::gpu {
namespace {

constexpr std::uint32_t kSolid = std::uint32_t{1} << 31;

// A child of a node: nothing, solid through (kSolid | material), or a node of the compact tree.
struct Cell {
  bool there = false;
  std::uint32_t value = 0;
};
using Cells = std::array<Cell, 64>;

class Maker {
 public:
  Maker(const CompactTree& tree, std::size_t most_bytes, CellTree* made)
      : tree_(tree), most_bytes_(most_bytes), made_(*made) {}

  bool make() {
    made_ = {};
    const int level = tree_.level();
    made_.levels = (level + 1) / 2;
    if (tree_.empty()) {
      return true;
    }
    if (tree_.merged()) {
      return false;
    }
    std::vector<std::uint32_t> nodes{tree_.mask(0) == 0 ? kSolid | tree_.block_material(0) : 0};
    std::vector<std::uint32_t> below;
    // Where the level is odd the octree's root stands one level below this tree's.
    bool half = level % 2 != 0;
    for (int k = made_.levels - 1; k >= 0; --k) {
      next_node_ = static_cast<std::uint32_t>(made_.words.size() / 3 + nodes.size());
      below.clear();
      for (const std::uint32_t node : nodes) {
        if (made_.bytes() > most_bytes_ || !add(node, half, k, &below)) {
          return false;
        }
      }
      nodes.swap(below);
      half = false;
    }
    return made_.bytes() <= most_bytes_;
  }

 private:
  // Adds a node with cells of 4^k voxels a side, and those of its cells that are nodes to `below`.
  bool add(std::uint32_t node, bool half, int k, std::vector<std::uint32_t>* below) {
    std::uint32_t mask[2] = {0, 0};
    if ((node & kSolid) != 0) {
      made_.words.insert(made_.words.end(), {~0U, ~0U, node});
      return true;
    }
    Cells cells{};
    if (!find_cells(node, half, k, &cells)) {
      return false;
    }
    const auto base = k == 0 ? static_cast<std::uint32_t>(made_.materials.size())
                             : next_node_ + static_cast<std::uint32_t>(below->size());
    for (unsigned bit = 0; bit < 64; ++bit) {
      if (!cells[bit].there) {
        continue;
      }
      mask[bit / 32] |= 1U << (bit % 32);
      if (k != 0) {
        below->push_back(cells[bit].value);
      } else if (tree_.many_materials()) {
        made_.materials.push_back(static_cast<std::uint8_t>(cells[bit].value));
      }
    }
    made_.words.insert(made_.words.end(), {mask[0], mask[1], base & ~kSolid});
    return true;
  }

  // The cells of a node of the octree: the children of its children, or, for `half`, its own children.
  bool find_cells(std::uint32_t node, bool half, int k, Cells* cells) const {
    if (half) {
      return fill(0, node, k, cells);
    }
    const unsigned mask = tree_.mask(node);
    std::uint32_t child = tree_.first_child(node);
    for (unsigned octant = 0; octant < 8; ++octant) {
      if ((mask >> octant & 1U) != 0 && !fill(octant, child++, k, cells)) {
        return false;
      }
    }
    return true;
  }

  // The eight cells of node `index`, which fills that octant.
  bool fill(unsigned octant, std::uint32_t index, int k, Cells* cells) const {
    if (index >= tree_.node_count()) {
      return false;
    }
    const unsigned mask = tree_.mask(index);
    std::uint32_t child = mask != 0 ? tree_.first_child(index) : 0;
    for (unsigned part = 0; part < 8; ++part) {
      const unsigned x = 2 * (octant & 1U) + (part & 1U);
      const unsigned y = (octant & 2U) + (part >> 1 & 1U);
      const unsigned z = 2 * (octant >> 2) + (part >> 2);
      Cell& cell = (*cells)[x + 4 * y + 16 * z];
      if (mask == 0) {
        cell = {true, kSolid | tree_.block_material(index)};
      } else if ((mask >> part & 1U) != 0) {
        if (k != 0 && child >= tree_.node_count()) {
          return false;
        }
        cell = {true, k == 0                   ? tree_.voxel_material(child)
                      : tree_.mask(child) == 0 ? kSolid | tree_.block_material(child)
                                               : child};
        ++child;
      }
    }
    return true;
  }

  const CompactTree& tree_;
  const std::size_t most_bytes_;
  CellTree& made_;
  std::uint32_t next_node_ = 0;
};

}  // namespace

bool make_cell_tree(const CompactTree& tree, std::size_t most_bytes, CellTree* made) {
  return Maker(tree, most_bytes, made).make();
}

}  // namespace thimble::gpu
