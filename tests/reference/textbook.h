/// Traversals as textbooks have them, in floating point with and without an epsilon: what the exact tracer is
/// compared with. They are written plainly, to be right as far as their arithmetic lets them.
///
/// Each takes the same quantised ray as the judges (reference.h) and normalises its direction, as renderers
/// do. `Real` is float or double; each function's `epsilon` is in voxels, 0 for none.
#pragma once

#include <vector>

#include "reference/reference.h"

namespace thimble::reference {

/// What such a traversal says. `t` is in voxels along the unit direction.
struct TextbookHit {
  bool hit = false;
  Voxel voxel{};
  double t = 0;
  int axis = -1;
};

/// A grid with, for each power of two, which of its cubes hold a voxel: the octree that `octree_descent`
/// walks. The sides of `grid`, which it keeps a reference to, are all the same power of two.
class Pyramid {
 public:
  explicit Pyramid(const BitGrid& grid);
  Pyramid(BitGrid&&) = delete;
  const BitGrid& grid() const { return grid_; }
  int levels() const { return static_cast<int>(above_.size()); }
  /// Whether the cube of 2^level voxels at `cube` (in units of its side) holds a voxel.
  bool occupied(int level, const Voxel& cube) const {
    return level == 0 ? grid_.test(cube) : above_[static_cast<std::size_t>(level - 1)].test(cube);
  }

 private:
  const BitGrid& grid_;
  std::vector<BitGrid> above_;
};

/// From cell to cell by comparing the t of the next plane on each axis, which grows by a constant at each
/// step (Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987). The
/// epsilon moves the point at which the world is entered inwards.
template <class Real>
TextbookHit grid_walk(const BitGrid& grid, const Ray& ray, Real epsilon);

/// From cell to cell by points: the cell of the point just behind where the last one was left. The epsilon
/// is how far behind. Without one the point may stay where it is; after a bounded number of steps that
/// counts as a miss.
template <class Real>
TextbookHit point_steps(const BitGrid& grid, const Ray& ray, Real epsilon);

/// Down an octree by the t of its planes (Revelles, Urena and Lastra, "An Efficient Parametric Algorithm for
/// Octree Traversal", WSCG 2000). The epsilon takes the place of smaller components of the unit direction.
template <class Real>
TextbookHit octree_descent(const Pyramid& pyramid, const Ray& ray, Real epsilon);

}  // namespace thimble::reference
