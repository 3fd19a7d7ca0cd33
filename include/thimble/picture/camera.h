/// @file camera.h
/// A pinhole or parallel camera that makes quantised rays, in integers from set-up to ray.
///
/// Conventions
///   - World axes are right-handed, z up. Image right = forward x up; row 0 is the top row; pixels are square
///     and sampled at their centres; the field of view is vertical.
///   - Perspective rays start at the eye. Orthographic rays are parallel and start on the plane through the
///     eye.
///   - What varies over the picture (perspective: the direction; orthographic: the origin's offset from the
///     eye) is an affine function of the pixel's column and row in every component, evaluated exactly in
///     32.32 fixed point and rounded once:
///
///         component(px, py) = rounded(base + px * step_x + py * step_y)
///
///     So it is monotone along rows and columns: the four corners of a tile bound all of it, and any engine
///     may compute any pixel's ray by itself and gets the ray that every other engine gets.
///
/// Accuracy. A ray may differ from the ideal real camera's by at most 1/8 pixel on the picture, everywhere on
/// the picture (orthographic: at every depth of the world). A direction rounded to integers is off by at most
/// sqrt(3)/2 units; larger integers make that less of a pixel. With `direction_bits` 0 the camera takes the
/// fewest bits that keep directions within 1/16 pixel (8 at least, 20 at most); fewer bits mean shorter
/// products and faster rays on small chips. The picture and the world decide, never the chip. Where 20 bits
/// do not give 1/8 pixel, set-up reports `kTooFine`. `error_bound_px_q16` gives the bound that was reached.
///
/// Exactness. A direction component that is 0 for the ideal camera at every pixel is 0. Components of equal
/// magnitude get equal magnitudes. Moving the eye by a vector moves every origin by just that vector.
/// Mirroring eye, forward and a given up in an axis mirrors every ray, and the picture left to right; turning
/// the axes (x to y to z to x) turns every ray. Rounding is symmetric for that: halves go away from zero.
/// (Automatic bits of an orthographic view depend on where the world lies, so they want it moved or mirrored
/// along.)
///
/// What it does not do: jitter samples within a pixel, clip, or know what a tree holds.
#ifndef THIMBLE_PICTURE_CAMERA_H
#define THIMBLE_PICTURE_CAMERA_H

#include <stdint.h>

#include "../base/status.h"
#include "../base/vec.h"
#include "../trace/ray.h"

namespace thimble {

/// Pictures are 1 .. kMaxPicturePx pixels wide and high.
inline constexpr int32_t kMaxPicturePx = 16384;
/// Components of `forward` and `up` are -2^30 .. 2^30.
inline constexpr int32_t kMaxViewComponent = int32_t{1} << 30;
/// What `direction_bits` may be, besides 0 for automatic.
inline constexpr int kMinDirectionBits = 8;
inline constexpr int kMaxDirectionBits = 20;
/// The vertical field of view.
inline constexpr Q16 kMinFov = Q16::saturate(1);
inline constexpr Q16 kMaxFov = Q16::saturate(120);

/// Bounds, swept by tools/instruments/operation_errors.cpp. `kRayErrorPxQ16`: between any pixel's ray and the
/// ideal real camera's, in 1/65536 pixel, where the bits are chosen automatically. `kDepthPerTErrorQ8`: of
/// `depth_per_t_q8` for a perspective camera; `kDepthPerTErrorParallelQ8`: for an orthographic one.
inline constexpr uint32_t kRayErrorPxQ16 = 8192;
inline constexpr int32_t kDepthPerTErrorQ8 = 4;
inline constexpr int32_t kDepthPerTErrorParallelQ8 = 1;

/// A length that may span nine of the largest worlds: 1/16384 voxel, up to 131,072 voxels.
using Q14 = Fixed<14>;

/// A pinhole camera.
struct PerspectiveView {
  /// -4 .. 5 world sizes on every axis.
  Vec3Q8 eye;
  /// Where it looks: integers of any length up to kMaxViewComponent a component, used with all their bits. A
  /// board passes `look_at(eye, target)`; a host scales its doubles to 2^30.
  Vec3i forward;
  /// What is up in the picture: any length, not parallel to `forward`. All 0 means `default_up(forward)`.
  Vec3i up;
  /// Vertical field of view, kMinFov .. kMaxFov degrees.
  Q16 fov_degrees = Q16::saturate(60);
  int32_t width_px = 0;
  int32_t height_px = 0;
  /// 0: the fewest that keep the accuracy; or 8 .. 20, used as given even where that is coarse.
  int direction_bits = 0;
};

/// A parallel camera. Members as above, except:
struct OrthographicView {
  /// The middle of the picture; every pixel's origin must lie within -4 .. 5 world sizes as well.
  Vec3Q8 eye;
  Vec3i forward;
  Vec3i up;
  /// Width of the picture in voxels, above 0; `span / width_px` is the side of a pixel.
  Q14 span;
  int32_t width_px = 0;
  int32_t height_px = 0;
  int direction_bits = 0;
};

/// From `eye` to `target`, halved until it fits `forward`; zero (which set-up refuses) when they are equal.
Vec3i look_at(const Vec3Q8& eye, const Vec3Q8& target);

/// (0,0,1), or (0,1,0) where that is parallel to `forward`.
constexpr Vec3i default_up(const Vec3i& forward) {
  return forward.x == 0 && forward.y == 0 ? Vec3i{0, 1, 0} : Vec3i{0, 0, 1};
}

/// The least `span` for which an orthographic picture of this width is never `kTooFine` in a world of 2^level
/// with automatic bits, from wherever it is seen: (457 + 2^level) / 16384 voxel a pixel. A view from nearby,
/// or along an axis, may do with less. `width_px` 1 .. kMaxPicturePx, `level` up to kMaxLevel.
constexpr Q14 least_orthographic_span(int32_t width_px, int level) {
  return Q14::from_raw(width_px * (457 + (int32_t{1} << level)));
}

class RowRays;

/// Plain data, 120 bytes, no pointers: copy it as you like. All `const` functions are reentrant.
class Camera {
 public:
  using Vec3Q32 = Vec3<int64_t>;

  /// base + px * step_x + py * step_y, in 32.32 fixed point, |value| < 2^56 on the picture. Round it with
  /// `Camera::rounded`.
  struct Affine {
    Vec3Q32 base;
    Vec3Q32 step_x;
    Vec3Q32 step_y;
  };

  /// A camera without pixels.
  constexpr Camera() = default;

  /// Takes up `view` in a world of 2^level.
  /// Errors, all of which leave the camera as it was:
  ///   kBadArgument  no pixels, no span, zero forward, up parallel to forward
  ///   kOutOfRange   level, size, field of view, bits, a vector's component, the eye, a corner's origin
  ///   kTooFine      automatic bits: 1/8 pixel cannot be had; bits as given: orthographic origins, rounded to
  ///                 1/256 voxel, cannot keep 1/8 pixel, or a perspective direction could round to zero
  /// Cost: perspective 11 divisions of at most 64 steps, 3 square roots of 32 and some 100 multiplications of
  /// up to 64 bits; orthographic 16 divisions, 2 roots and 50 multiplications, and for each number of bits
  /// tried a division, a root and 12 multiplications (26 tries at most, seldom more than 10). No 64-bit
  /// division instruction or library call, no floating point. Stack: below 700 bytes on a Cortex-M0.
  Status set(const PerspectiveView& view, int level);
  Status set(const OrthographicView& view, int level);

  /// The ray of the centre of pixel (px, py), 0 <= px < width_px(), 0 <= py < height_px(): `check_ray`
  /// accepts it. Six 64-bit multiplications by a 32-bit number; `RowRays` needs none.
  Ray ray(int32_t px, int32_t py) const {
    const Vec3i varying{rounded(value(px, py, 0)), rounded(value(px, py, 1)), rounded(value(px, py, 2))};
    return ray_of(varying);
  }

  /// A camera of every `step`-th pixel of this one, from the top left, `step` at least 1: the ray of its
  /// pixel (i, j) is this one's of (i * step, j * step), integer for integer. For a coarse picture some of
  /// whose pixels are the fine one's.
  Camera thinned(int32_t step) const {
    Camera camera = *this;
    camera.width_px_ = (width_px_ + step - 1) / step;
    camera.height_px_ = (height_px_ + step - 1) / step;
    for (int axis = 0; axis < 3; ++axis) {
      camera.affine_.step_x[axis] *= step;
      camera.affine_.step_y[axis] *= step;
    }
    return camera;
  }

  /// A camera of `width_px` x `height_px` pixels of this one, from (px, py) on, all of them on this one's
  /// picture: the ray of its pixel (i, j) is this one's of (px + i, py + j), integer for integer. For a few
  /// pixels of a finer picture (render.h, "Samples where edges are").
  Camera window(int32_t px, int32_t py, int32_t width_px, int32_t height_px) const {
    Camera camera = *this;
    camera.width_px_ = width_px;
    camera.height_px_ = height_px;
    for (int axis = 0; axis < 3; ++axis) {
      camera.affine_.base[axis] = value(px, py, axis);
    }
    return camera;
  }

  bool is_perspective() const { return is_perspective_; }
  int32_t width_px() const { return width_px_; }
  int32_t height_px() const { return height_px_; }
  /// The level it was set up for.
  int level() const { return level_; }
  /// Directions lie within -(2^direction_bits() - 1) .. 2^direction_bits() - 1.
  int direction_bits() const { return direction_bits_; }

  /// Perspective: the direction, in the ray's integers. Orthographic: origin minus eye, in 1/256 voxel.
  const Affine& affine() const { return affine_; }
  /// Perspective: every ray's origin. Orthographic: the point that the origins lie around.
  const Vec3Q8& eye() const { return eye_; }
  /// Orthographic: every ray's direction. Perspective: zero, since each has its own.
  const Vec3i& direction() const { return direction_; }

  /// Distance along the unit forward vector that one unit of t covers, in 1/256 voxel: planar depth in voxels
  /// is t * depth_per_t_q8() / 256. Orthographic: within 1 of the value. Perspective: before rounding, a
  /// constant of the picture, within 4 of the value; a single ray's differs by up to 228 more, since its
  /// direction is rounded.
  int32_t depth_per_t_q8() const { return depth_per_t_q8_; }

  /// A bound on the distance between any pixel's ray and the ideal one on the picture, in 1/65536 pixel: at
  /// most 8192 where the bits were chosen automatically.
  uint32_t error_bound_px_q16() const { return error_bound_px_q16_; }

  /// A 32.32 number rounded to the nearest integer, halves away from zero, so that rounded(-v) ==
  /// -rounded(v).
  static constexpr int32_t rounded(int64_t value_q32) {
    return static_cast<int32_t>((value_q32 + (int64_t{1} << 31) - (value_q32 < 0 ? 1 : 0)) >> 32);
  }

 private:
  friend class RowRays;

  /// Component `axis` of the affine function. Below 2^56: see `set`.
  int64_t value(int32_t px, int32_t py, int axis) const {
    return affine_.base[axis] + px * affine_.step_x[axis] + py * affine_.step_y[axis];
  }
  /// The ray whose varying part is `varying`.
  Ray ray_of(const Vec3i& varying) const {
    if (is_perspective_) {
      return {eye_, varying};
    }
    return {{eye_.x + Q8::from_raw(varying.x), eye_.y + Q8::from_raw(varying.y),
             eye_.z + Q8::from_raw(varying.z)},
            direction_};
  }

  Affine affine_;
  Vec3Q8 eye_;
  Vec3i direction_;
  int32_t width_px_ = 0;
  int32_t height_px_ = 0;
  int32_t depth_per_t_q8_ = 0;
  uint32_t error_bound_px_q16_ = 0;
  uint8_t level_ = 0;
  uint8_t direction_bits_ = 0;
  bool is_perspective_ = false;
};

/// Walks along a row, one pixel a step, with three 64-bit additions and no multiplication. Gives the very
/// rays that `Camera::ray` gives. Valid while the camera lives and is not set up anew.
///
///     RowRays rays(camera, first_px, py);
///     for (int32_t px = first_px; px < end_px; ++px, rays.next()) { ... rays.ray() ... }
class RowRays {
 public:
  RowRays(const Camera& camera, int32_t px, int32_t py)
      : camera_(&camera), value_{camera.value(px, py, 0), camera.value(px, py, 1), camera.value(px, py, 2)} {}

  /// The ray of the pixel it stands on, which lies on the picture.
  Ray ray() const {
    return camera_->ray_of({Camera::rounded(value_.x), Camera::rounded(value_.y), Camera::rounded(value_.z)});
  }
  /// One pixel to the right; at most one step off the picture.
  void next() {
    value_.x += camera_->affine_.step_x.x;
    value_.y += camera_->affine_.step_x.y;
    value_.z += camera_->affine_.step_x.z;
  }

 private:
  const Camera* camera_;
  Camera::Vec3Q32 value_;
};

}  // namespace thimble

#endif
