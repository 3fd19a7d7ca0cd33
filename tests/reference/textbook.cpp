#include "reference/textbook.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace thimble::reference {
namespace {

template <class Real>
using Vector = std::array<Real, 3>;

template <class Real>
struct UnitRay {
  Vector<Real> origin;
  Vector<Real> direction;

  explicit UnitRay(const Ray& ray) {
    Real square = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      origin[axis] = static_cast<Real>(ray.origin_q8[axis]) / 256;
      direction[axis] = static_cast<Real>(ray.direction[axis]);
      square += direction[axis] * direction[axis];
    }
    const Real length = std::sqrt(square);
    for (Real& component : direction) {
      component /= length;
    }
  }
  Vector<Real> at(Real t) const {
    return {origin[0] + t * direction[0], origin[1] + t * direction[1], origin[2] + t * direction[2]};
  }
};

// The slab test against the box from 0 to `size`.
template <class Real>
struct Slabs {
  Real enter = 0;
  Real leave = std::numeric_limits<Real>::infinity();
  int axis = -1;  // entered by

  Slabs(const UnitRay<Real>& ray, const Voxel& size) {
    for (std::size_t axis_number = 0; axis_number < 3; ++axis_number) {
      const Real inverse = 1 / ray.direction[axis_number];
      Real near = (0 - ray.origin[axis_number]) * inverse;
      Real far = (static_cast<Real>(size[axis_number]) - ray.origin[axis_number]) * inverse;
      if (inverse < 0) {
        std::swap(near, far);
      }
      if (near > enter) {
        enter = near;
        axis = static_cast<int>(axis_number);
      }
      leave = far < leave ? far : leave;
    }
  }
};

template <class Real>
int cell_of(Real value) {
  return static_cast<int>(std::floor(value));
}

}  // namespace

Pyramid::Pyramid(const BitGrid& grid) : grid_(grid) {
  int side = grid.size()[0];
  if (grid.size()[1] != side || grid.size()[2] != side || (side & (side - 1)) != 0) {
    throw std::invalid_argument("a pyramid wants a cube with a power of two as its side");
  }
  above_.reserve(13);
  const BitGrid* below = &grid;
  while (side > 1) {
    side /= 2;
    BitGrid next({side, side, side});
    for (int z = 0; z < 2 * side; ++z) {
      for (int y = 0; y < 2 * side; ++y) {
        for (int x = 0; x < 2 * side; ++x) {
          if (below->test({x, y, z})) {
            next.set({x / 2, y / 2, z / 2});
          }
        }
      }
    }
    above_.push_back(std::move(next));
    below = &above_.back();
  }
}

template <class Real>
TextbookHit grid_walk(const BitGrid& grid, const Ray& quantised, Real epsilon) {
  const UnitRay<Real> ray(quantised);
  const Slabs<Real> world(ray, grid.size());
  if (!(world.enter < world.leave)) {
    return {};
  }
  const Vector<Real> entry = ray.at(world.enter + epsilon);
  Voxel cell{};
  Vector<Real> next{};   // t of the plane ahead
  Vector<Real> delta{};  // t from plane to plane
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell[axis] = std::clamp(cell_of(entry[axis]), 0, grid.size()[axis] - 1);
    delta[axis] = std::abs(1 / ray.direction[axis]);
    const int ahead = ray.direction[axis] > 0 ? cell[axis] + 1 : cell[axis];
    next[axis] = ray.direction[axis] == 0
                     ? std::numeric_limits<Real>::infinity()
                     : (static_cast<Real>(ahead) - ray.origin[axis]) / ray.direction[axis];
  }
  Real t = world.enter;
  int axis = world.axis;
  while (grid.contains(cell)) {
    if (grid.test(cell)) {
      return {true, cell, static_cast<double>(t), axis};
    }
    std::size_t least = next[0] < next[1] ? 0 : 1;
    least = next[2] < next[least] ? 2 : least;
    t = next[least];
    axis = static_cast<int>(least);
    cell[least] += ray.direction[least] > 0 ? 1 : -1;
    next[least] += delta[least];
  }
  return {};
}

template <class Real>
TextbookHit point_steps(const BitGrid& grid, const Ray& quantised, Real epsilon) {
  const UnitRay<Real> ray(quantised);
  const Slabs<Real> world(ray, grid.size());
  if (!(world.enter < world.leave)) {
    return {};
  }
  Real t = world.enter;
  int axis = world.axis;
  const int most_steps = 4 * (grid.size()[0] + grid.size()[1] + grid.size()[2]);
  for (int step = 0; step < most_steps; ++step) {
    const Vector<Real> point = ray.at(t + epsilon);
    const Voxel cell{cell_of(point[0]), cell_of(point[1]), cell_of(point[2])};
    if (!grid.contains(cell)) {
      return {};
    }
    if (grid.test(cell)) {
      return {true, cell, static_cast<double>(t), axis};
    }
    Real exit = std::numeric_limits<Real>::infinity();
    for (std::size_t a = 0; a < 3; ++a) {
      if (ray.direction[a] == 0) {
        continue;
      }
      const int ahead = ray.direction[a] > 0 ? cell[a] + 1 : cell[a];
      const Real plane = (static_cast<Real>(ahead) - ray.origin[a]) / ray.direction[a];
      if (plane < exit) {
        exit = plane;
        axis = static_cast<int>(a);
      }
    }
    t = exit;
  }
  return {};
}

namespace {

// One descent. Directions are made positive by mirroring the world; `mirror` turns octants back.
template <class Real>
struct Descent {
  const Pyramid& pyramid;
  unsigned mirror = 0;
  TextbookHit hit{};

  static unsigned first_octant(const Vector<Real>& enter, const Vector<Real>& middle) {
    std::size_t axis = enter[0] > enter[1] ? 0 : 1;
    axis = enter[2] > enter[axis] ? 2 : axis;
    unsigned octant = 0;
    for (std::size_t other = 0; other < 3; ++other) {
      if (other != axis && middle[other] < enter[axis]) {
        octant |= 1U << other;
      }
    }
    return octant;
  }

  // Whether something was hit in the cube at `cube` (mirrored), whose planes are met at `enter` and `leave`.
  // NOLINTNEXTLINE(misc-no-recursion): as it is published; 12 levels at most.
  bool visit(int level, const Voxel& cube, const Vector<Real>& enter, const Vector<Real>& leave) {
    if (leave[0] < 0 || leave[1] < 0 || leave[2] < 0) {
      return false;
    }
    const int last = (1 << (pyramid.levels() - level)) - 1;
    Voxel real = cube;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if ((mirror >> axis & 1U) != 0) {
        real[axis] = last - cube[axis];
      }
    }
    if (!pyramid.occupied(level, real)) {
      return false;
    }
    std::size_t entered = enter[0] >= enter[1] ? 0 : 1;
    entered = enter[2] > enter[entered] ? 2 : entered;
    if (level == 0) {
      const bool inside = enter[entered] < 0;
      hit = {true, real, inside ? 0.0 : static_cast<double>(enter[entered]),
             inside ? -1 : static_cast<int>(entered)};
      return true;
    }
    Vector<Real> middle{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      middle[axis] = (enter[axis] + leave[axis]) / 2;
    }
    unsigned octant = first_octant(enter, middle);
    for (int step = 0; step < 4; ++step) {
      Vector<Real> from{};
      Vector<Real> to{};
      Voxel child{};
      std::size_t exit = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool upper = (octant >> axis & 1U) != 0;
        from[axis] = upper ? middle[axis] : enter[axis];
        to[axis] = upper ? leave[axis] : middle[axis];
        child[axis] = 2 * cube[axis] + (upper ? 1 : 0);
        exit = to[axis] < to[exit] ? axis : exit;
      }
      if (visit(level - 1, child, from, to)) {
        return true;
      }
      if ((octant >> exit & 1U) != 0) {
        return false;
      }
      octant |= 1U << exit;
    }
    return false;
  }
};

}  // namespace

template <class Real>
TextbookHit octree_descent(const Pyramid& pyramid, const Ray& quantised, Real epsilon) {
  UnitRay<Real> ray(quantised);
  const Real side = static_cast<Real>(pyramid.grid().size()[0]);
  Descent<Real> descent{pyramid};
  Vector<Real> enter{};
  Vector<Real> leave{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] < 0) {
      ray.origin[axis] = side - ray.origin[axis];
      ray.direction[axis] = -ray.direction[axis];
      descent.mirror |= 1U << axis;
    }
    ray.direction[axis] = std::max(ray.direction[axis], epsilon);
    enter[axis] = (0 - ray.origin[axis]) / ray.direction[axis];
    leave[axis] = (side - ray.origin[axis]) / ray.direction[axis];
  }
  if (std::max({enter[0], enter[1], enter[2]}) < std::min({leave[0], leave[1], leave[2]})) {
    descent.visit(pyramid.levels(), {0, 0, 0}, enter, leave);
  }
  return descent.hit;
}

template TextbookHit grid_walk<float>(const BitGrid&, const Ray&, float);
template TextbookHit grid_walk<double>(const BitGrid&, const Ray&, double);
template TextbookHit point_steps<float>(const BitGrid&, const Ray&, float);
template TextbookHit point_steps<double>(const BitGrid&, const Ray&, double);
template TextbookHit octree_descent<float>(const Pyramid&, const Ray&, float);
template TextbookHit octree_descent<double>(const Pyramid&, const Ray&, double);

}  // namespace thimble::reference
