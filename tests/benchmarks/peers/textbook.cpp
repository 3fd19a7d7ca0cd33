// What one would write after reading a book: an octree of nodes with eight pointers, traversed by recursion in double
// precision, made as fast as that allows.
//
// The traversal is the parametric one of Jorge Revelles, Carlos Urena and Miguel Lastra, "An Efficient Parametric Algorithm
// for Octree Traversal" (WSCG 2000): a node is given by the ray parameters at its six planes, a child's are those and the
// middles between them, and the order in which children are met follows from comparing them. Not exact: ties and near ties
// fall as rounding has it.
#include <algorithm>
#include <array>
#include <deque>
#include <optional>

#include "benchmarks/peers/peer.h"

namespace thimble::benchmarks {
namespace {

class Textbook : public Peer {
 public:
  using Real3 = std::array<double, 3>;

  // The voxels come in Morton order, so nodes that are near in space are near in memory.
  explicit Textbook(const std::vector<Voxel>& voxels) : root_(&nodes_.emplace_back()) {
    for (const Voxel& at : voxels) {
      while ((std::max({at.x, at.y, at.z}) >> level_) != 0) {
        ++level_;
      }
    }
    for (const Voxel& at : voxels) {
      insert(at.x, at.y, at.z);
    }
  }
  std::string name() const override { return "textbook's octree"; }
  std::size_t bytes() const override { return nodes_.size() * sizeof(Node); }

  void draw(const View& view, std::uint8_t* gray, Voxel* voxels) override {
    std::size_t pixel = 0;
    for (std::int32_t y = 0; y < view.height_px; ++y) {
      for (std::int32_t x = 0; x < view.width_px; ++x, ++pixel) {
        Voxel voxel = kNoVoxel;
        const auto t = first_hit(ray_of(view, x, y), &voxel);
        gray[pixel] = t ? view.gray(static_cast<float>(*t)) : 0;
        if (voxels != nullptr) {
          voxels[pixel] = voxel;
        }
      }
    }
  }

 private:
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

  // The parameter t at which the ray meets the first solid voxel, and that voxel.
  std::optional<double> first_hit(const FloatRay& ray, Voxel* voxel) const {
    Real3 origin{ray.origin[0], ray.origin[1], ray.origin[2]};
    Real3 direction{ray.direction[0], ray.direction[1], ray.direction[2]};
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
        direction[axis] = 0x1p-100;  // planes then lie infinitely far, on the right side, without rounding
      }
      in[axis] = (0 - origin[axis]) / direction[axis];
      out[axis] = (side - origin[axis]) / direction[axis];
    }
    Found found;
    const bool crossed = std::max({in[0], in[1], in[2]}) < std::min({out[0], out[1], out[2]});
    if (!crossed || !visit(*root_, level_, 0, in[0], in[1], in[2], out[0], out[1], out[2], flip, &found)) {
      return std::nullopt;
    }
    for (int bit = 0; bit < level_; ++bit) {
      const unsigned octant = static_cast<unsigned>(found.path >> 3 * bit) & 7U;
      voxel->x = static_cast<std::uint16_t>((bit == 0 ? 0 : voxel->x) | (octant & 1U) << bit);
      voxel->y = static_cast<std::uint16_t>((bit == 0 ? 0 : voxel->y) | (octant >> 1 & 1U) << bit);
      voxel->z = static_cast<std::uint16_t>((bit == 0 ? 0 : voxel->z) | (octant >> 2) << bit);
    }
    return found.t;
  }

  struct Node {
    std::array<Node*, 8> child{};
    std::uint8_t solid = 0;  ///< in nodes of 2 x 2 x 2 voxels, which have no children: the solid ones
  };
  // What was met: t, and the octants on the way down.
  struct Found {
    double t = 0;
    std::uint64_t path = 0;
  };
  static constexpr unsigned kOutside = 8;

  static std::size_t octant(std::int32_t x, std::int32_t y, std::int32_t z, int bit) {
    return static_cast<std::size_t>((x >> bit & 1) | (y >> bit & 1) << 1 | (z >> bit & 1) << 2);
  }
  // The octant behind the plane that is crossed first.
  static unsigned next(double x, unsigned behind_x, double y, unsigned behind_y, double z,
                       unsigned behind_z) {
    if (x < y) {
      return x < z ? behind_x : behind_z;
    }
    return y < z ? behind_y : behind_z;
  }

  // Visits a node by the ray parameters at its lower (x0, y0, z0) and upper (x1, y1, z1) planes.
  static bool visit(const Node& node, int level, std::uint64_t path, double x0, double y0, double z0,
                    double x1, double y1, double z1, unsigned flip, Found* found) {
    if (x1 < 0 || y1 < 0 || z1 < 0) {
      return false;
    }
    const double xm = 0.5 * (x0 + x1);
    const double ym = 0.5 * (y0 + y1);
    const double zm = 0.5 * (z0 + z1);
    const auto met = [&](unsigned which, double a0, double b0, double c0, double a1, double b1, double c1) {
      if (level > 1) {
        const Node* child = node.child[which ^ flip];
        return child != nullptr &&
               visit(*child, level - 1, path << 3 | (which ^ flip), a0, b0, c0, a1, b1, c1, flip, found);
      }
      if ((node.solid >> (which ^ flip) & 1U) == 0 || a1 < 0 || b1 < 0 || c1 < 0) {
        return false;
      }
      *found = {std::max({a0, b0, c0, 0.0}), path << 3 | (which ^ flip)};
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

  int level_ = 1;
  std::deque<Node> nodes_;
  Node* root_;
};

}  // namespace

std::unique_ptr<Peer> make_textbook(const std::vector<Voxel>& voxels) {
  return std::make_unique<Textbook>(voxels);
}

}  // namespace thimble::benchmarks
