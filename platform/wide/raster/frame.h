/// The numbers with which a frame's boxes are projected and tested.
///
/// A camera's rays are rounded affine functions of the pixel (thimble/picture/camera.h). Their inverse,
/// without the rounding, takes a point to the picture: with c the point less the eye,
///
///     column = U.c / W.c     row = V.c / W.c        (orthographic: W.c is 1, and c counts from the base, too)
///
/// At which pixels may a box around c with half sides h be seen? Let the ray of column P have the direction
/// D + r, with D the map's own and |r| <= 1/2 on every axis, and pass the point c + e of the box (|e| <= h)
/// at t.
/// Since U.D = P and W.D = 1,
///
///     U.(c + e) - P W.(c + e) = t (U - P W).r,   hence   |column - P| <= k |U - P W|_1   for W.c > 0,
///     k = (h + t / 2) / W.c,   t <= (W.c + h |W|_1) / (1 - |W|_1 / 2).
///
/// With s = 1/2 / (1 - |W|_1 / 2), that is k <= (1 + s |W|_1) h / W.c + s: `reach` and `slack`. |U - P W|_1
/// is convex in P, so over a tile, or the part of a tile in which some boxes may be seen, its greatest value is
/// at one of the two sides. Another bound starts from the column of the box's centre, since
/// |U - P W|_1 <= |U - column W|_1 + |P - column| |W|_1:
///
///     |column - P| <= k |U - column W|_1 / (1 - k |W|_1),   where k |W|_1 <= 1/8: 1 / (1 - q) <= 1 + 1.15 q.
///
/// Floating point adds to U.c, V.c and W.c an error of at most `kRounding` times the sum of the magnitudes that went
/// in; `reach` is widened by that. So floats decide only which pixels are looked at: a superset. The ray's own
/// integers decide whether it hits a box (kernels/judge-inl.h, exact.h).
#pragma once

#include <stdint.h>

// What is compiled for each instruction set takes longest, so it includes no public header and is not compiled again
// when one of these changes.
namespace thimble {
class Camera;
class CompactTree;
}  // namespace thimble

namespace thimble::wide {

/// The pixels x0 .. x1 - 1, y0 .. y1 - 1; none when x0 >= x1.
struct Rectangle {
  int32_t x0, y0, x1, y1;
};

/// Plain data, made once for each frame and tile.
struct WideFrame {
  Rectangle tile;
  bool perspective = false;

  // Projection of the point p, in voxels: column = (u.p + u[3]) / (w.p + w[3]).
  float u[4];
  float v[4];
  float w[4];
  float reach_x;  ///< for a box of one voxel; a larger one multiplies it by its side
  float reach_y;
  float rounding_x;  ///< added to reach, whatever the box's size
  float rounding_y;
  float slack_x;  ///< pixels that are added for any box
  float slack_y;
  float spread_x;  ///< pixels that are added to the nearer bound of far boxes
  float spread_y;
  float norm_w;         ///< |W|_1, or so large a number that the nearer bound is never used
  float per_direction;  ///< 1/2 / (1 - |W|_1 / 2)
  float half_w;  ///< a box of one voxel lies in front of the eye's plane, at least in part, when w > -half_w
  float rounding_w;

  // The same map in floats, for the test in floats, which decides where its error allows. Base and steps are split into
  // whole numbers, whose sum is exact below 2^24, and fractions of at most a half, whose sum is within `map_error`.
  // Where that is 0.5, floats decide nothing.
  float map_whole[3][3], map_rest[3][3];  ///< of base, step_x, step_y; by axis
  float map_error;

  // The exact ray: component a is round(base + px * step_x + py * step_y), each split as high * 2^20 + low.
  double base_high[3], base_low[3];
  double step_x_high[3], step_x_low[3];
  double step_y_high[3], step_y_low[3];
  const Camera* camera;  ///< outlives the frame
  int32_t eye[3];        ///< raw values, 1/256 voxel
  int32_t direction[3];  ///< of all rays of a parallel camera

  /// The caller sets these where the lists leave out hidden voxels (hidden_voxels.h): the tree that holds them, and the number
  /// of a hidden voxel of material 0. Null: the lists leave nothing out.
  const CompactTree* hidden_in = nullptr;
  uint32_t first_hidden = 0;

  /// The voxel that the eye is in; a parallel camera's rays come from beyond the world.
  int32_t eye_cell[3];

  /// The octant of a cube of 2^level voxels a side that is nearest to the eye.
  template <class Coordinate>
  unsigned nearest_octant(const Coordinate (&corner)[3], int level) const {
    unsigned octant = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const int32_t middle = static_cast<int32_t>(corner[axis]) + (int32_t{1} << (level - 1));
      octant |= eye_cell[axis] >= middle ? 1U << axis : 0U;
    }
    return octant;
  }
};

/// Returns false for cameras so narrow or so far off that floats cannot tell their pixels apart, or whose map has no
/// inverse; such frames are drawn ray by ray.
bool make_frame(const Camera& camera, const Rectangle& tile, WideFrame* frame);

}  // namespace thimble::wide
