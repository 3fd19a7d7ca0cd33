/// What one would write after reading a book: an octree of nodes with eight pointers, traversed by recursion
/// in double precision. The baseline that the core is measured against, so it is made as fast as that allows.
///
/// The traversal is the parametric one of Jorge Revelles, Carlos Urena and Miguel Lastra, "An Efficient
/// Parametric Algorithm for Octree Traversal" (WSCG 2000): a node is given by the ray parameters at its six
/// planes, a child's are those and the middles between them, and the order in which children are met follows
/// from comparing them. Not exact: ties and near ties fall as rounding has it.
#pragma once

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
    Real3 in;
    Real3 out;
    unsigned flip = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (direction[axis] < 0) {
        origin[axis] = side - origin[axis];
        direction[axis] = -direction[axis];
        flip |= 1U << axis;
      } else if (direction[axis] == 0) {
        direction[axis] = 1e-30;  // planes then lie infinitely far, on the right side
      }
      in[axis] = (0 - origin[axis]) / direction[axis];
      out[axis] = (side - origin[axis]) / direction[axis];
    }
    double t = 0;
    const bool crossed = std::max({in[0], in[1], in[2]}) < std::min({out[0], out[1], out[2]});
    return crossed && visit(*root_, level_, in[0], in[1], in[2], out[0], out[1], out[2], flip, t)
               ? std::optional(t)
               : std::nullopt;
  }

 private:
  struct Node {
    std::array<Node*, 8> child{};
    std::uint8_t solid = 0;  ///< in nodes of 2 x 2 x 2 voxels, which have no children: the solid ones
  };
  static constexpr unsigned kOutside = 8;

  static std::size_t octant(std::int32_t x, std::int32_t y, std::int32_t z, int bit) {
    return static_cast<std::size_t>((x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2);
  }
  /// The octant behind the plane that is crossed first.
  static unsigned next(double x, unsigned behind_x, double y, unsigned behind_y, double z,
                       unsigned behind_z) {
    if (x < y) {
      return x < z ? behind_x : behind_z;
    }
    return y < z ? behind_y : behind_z;
  }

  /// Visits a node by the ray parameters at its lower (x0, y0, z0) and upper (x1, y1, z1) planes.
  static bool visit(const Node& node, int level, double x0, double y0, double z0, double x1, double y1,
                    double z1, unsigned flip, double& t) {
    if (x1 < 0 || y1 < 0 || z1 < 0) {
      return false;
    }
    const double xm = 0.5 * (x0 + x1);
    const double ym = 0.5 * (y0 + y1);
    const double zm = 0.5 * (z0 + z1);
    const auto met = [&](unsigned which, double a0, double b0, double c0, double a1, double b1, double c1) {
      if (level > 1) {
        const Node* child = node.child[which ^ flip];
        return child != nullptr && visit(*child, level - 1, a0, b0, c0, a1, b1, c1, flip, t);
      }
      if ((node.solid >> (which ^ flip) & 1U) == 0 || a1 < 0 || b1 < 0 || c1 < 0) {
        return false;
      }
      t = std::max({a0, b0, c0, 0.0});
      return true;
    };
    const double entry = std::max({x0, y0, z0});
    unsigned current = (xm < entry ? 1U : 0U) | (ym < entry ? 2U : 0U) | (zm < entry ? 4U : 0U);
    while (current != kOutside) {
      switch (current) {
        case 0:
          if (met(0, x0, y0, z0, xm, ym, zm)) {
            return true;
          }
          current = next(xm, 1, ym, 2, zm, 4);
          break;
        case 1:
          if (met(1, xm, y0, z0, x1, ym, zm)) {
            return true;
          }
          current = next(x1, kOutside, ym, 3, zm, 5);
          break;
        case 2:
          if (met(2, x0, ym, z0, xm, y1, zm)) {
            return true;
          }
          current = next(xm, 3, y1, kOutside, zm, 6);
          break;
        case 3:
          if (met(3, xm, ym, z0, x1, y1, zm)) {
            return true;
          }
          current = next(x1, kOutside, y1, kOutside, zm, 7);
          break;
        case 4:
          if (met(4, x0, y0, zm, xm, ym, z1)) {
            return true;
          }
          current = next(xm, 5, ym, 6, z1, kOutside);
          break;
        case 5:
          if (met(5, xm, y0, zm, x1, ym, z1)) {
            return true;
          }
          current = next(x1, kOutside, ym, 7, z1, kOutside);
          break;
        case 6:
          if (met(6, x0, ym, zm, xm, y1, z1)) {
            return true;
          }
          current = next(xm, 7, y1, kOutside, z1, kOutside);
          break;
        default:
          return met(7, xm, ym, zm, x1, y1, z1);
      }
    }
    return false;
  }

  int level_;
  std::deque<Node> nodes_;
  Node* root_;
};

}  // namespace thimble::benchmarks
