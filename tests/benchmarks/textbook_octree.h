/// @file textbook_octree.h
/// What one would write after reading a book: an octree of nodes with eight pointers, traversed by recursion
/// in double precision. The baseline that the core is measured against, so it is made as fast as that allows.
///
/// The traversal is the parametric one of Jorge Revelles, Carlos Urena and Miguel Lastra, "An Efficient
/// Parametric Algorithm for Octree Traversal" (WSCG 2000): a node is given by the ray parameters at its six
/// planes, a child's are those and the middles between them, and the order in which children are met follows
/// from comparing them. Not exact: ties and near ties fall as rounding has it.
#ifndef THIMBLE_TESTS_BENCHMARKS_TEXTBOOK_OCTREE_H
#define THIMBLE_TESTS_BENCHMARKS_TEXTBOOK_OCTREE_H

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace thimble::benchmarks {

class TextbookOctree {
 public:
  using Real3 = std::array<double, 3>;

  /// An empty world of 2^level voxels a side.
  explicit TextbookOctree(int level) : level_(level), root_(&nodes_.emplace_back()) {}

  void insert(std::int32_t x, std::int32_t y, std::int32_t z) {
    Node* node = root_;
    for (int bit = level_ - 1; bit > 0; --bit) {
      Node*& child = node->child[octant(x, y, z, bit)];
      if (child == nullptr) {
        child = &nodes_.emplace_back();
      }
      node = child;
    }
    node->solid |= static_cast<std::uint8_t>(1U << octant(x, y, z, 0));
  }

  std::size_t bytes() const { return nodes_.size() * sizeof(Node); }

  /// The parameter t at which the ray meets the first solid voxel.
  std::optional<double> first_hit(Real3 origin, Real3 direction) const {
    const double side = static_cast<double>(std::int64_t{1} << level_);
    Planes planes;
    unsigned flip = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (direction[axis] < 0) {
        origin[axis] = side - origin[axis];
        direction[axis] = -direction[axis];
        flip |= 1U << axis;
      } else if (direction[axis] == 0) {
        direction[axis] = 1e-30;  // planes then lie infinitely far, on the right side
      }
      planes.in[axis] = (0 - origin[axis]) / direction[axis];
      planes.out[axis] = (side - origin[axis]) / direction[axis];
    }
    double t = 0;
    const bool crossed = std::max({planes.in[0], planes.in[1], planes.in[2]}) <
                         std::min({planes.out[0], planes.out[1], planes.out[2]});
    return crossed && visit(*root_, level_, planes, flip, t) ? std::optional(t) : std::nullopt;
  }

 private:
  struct Node {
    std::array<Node*, 8> child{};
    std::uint8_t solid = 0;  ///< in nodes of 2 x 2 x 2 voxels, which have no children: the solid ones
  };
  /// Ray parameters at a node's lower and upper planes.
  struct Planes {
    Real3 in;
    Real3 out;
  };

  static std::size_t octant(std::int32_t x, std::int32_t y, std::int32_t z, int bit) {
    return static_cast<std::size_t>((x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2);
  }

  static bool visit(const Node& node, int level, const Planes& planes, unsigned flip, double& t) {
    const Real3& in = planes.in;
    const Real3& out = planes.out;
    if (out[0] < 0 || out[1] < 0 || out[2] < 0) {
      return false;
    }
    const Real3 middle{0.5 * (in[0] + out[0]), 0.5 * (in[1] + out[1]), 0.5 * (in[2] + out[2])};
    const double entry = std::max({in[0], in[1], in[2]});
    unsigned current =
        (middle[0] < entry ? 1U : 0U) | (middle[1] < entry ? 2U : 0U) | (middle[2] < entry ? 4U : 0U);
    for (;;) {
      Planes part;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool above = (current >> axis & 1U) != 0;
        part.in[axis] = above ? middle[axis] : in[axis];
        part.out[axis] = above ? out[axis] : middle[axis];
      }
      const std::size_t which = current ^ flip;
      if (level > 1) {
        if (node.child[which] != nullptr && visit(*node.child[which], level - 1, part, flip, t)) {
          return true;
        }
      } else if ((node.solid >> which & 1U) != 0 && part.out[0] >= 0 && part.out[1] >= 0 &&
                 part.out[2] >= 0) {
        t = std::max({part.in[0], part.in[1], part.in[2], 0.0});
        return true;
      }
      const unsigned leaves = part.out[0] < part.out[1] ? (part.out[0] < part.out[2] ? 1U : 4U)
                                                        : (part.out[1] < part.out[2] ? 2U : 4U);
      if ((current & leaves) != 0) {
        return false;
      }
      current |= leaves;
    }
  }

  int level_;
  std::deque<Node> nodes_;
  Node* root_;
};

}  // namespace thimble::benchmarks

#endif
