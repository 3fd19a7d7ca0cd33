/// The numbers with which the kernels find greys (ShadeMode::kDepth) or faces, from where rays enter their boxes.
#pragma once

#include <stdint.h>

namespace thimble {
class Camera;
struct Hit;
struct Ray;
struct Shading;
}  // namespace thimble

namespace thimble::wide {

/// How much darker the farthest grey is than the nearest: 255 - kFarBrightness.
inline constexpr int kMostFall = 215;

/// A ray enters its box at t = numerator / (256 * speed), with the speed |direction| along the axis whose
/// plane is passed last. The core rounds three times (src/picture/shading.cpp):
///
///     ratio = floor(dividend / speed)    depth = floor(numerator * ratio * scale)
///     grey = 255 - floor((depth - near) * (255 - kFarBrightness) / (far - near)), between its limits
///
/// Floats find the fall in brightness, before its last rounding, within `margin`. A ratio below 2^21 is exact; a
/// larger one is off by less than 2^-20 of itself. So the depth differs from the core's by at most 1.01 and 2^-19 of
/// itself. The fall is at most 255 and takes three more roundings, so it is within margin = per_depth * (1.01 +
/// greatest / 2^19) + 2^-12, where `greatest` is a little beyond the far plane. Beyond that plane the margin grows no
/// faster than the fall.
struct GrayScale {
  /// What a pixel keeps of the voxel that it shows: a grey, or 1 + the number of the face by which the ray enters
  /// (2 * axis, and 1 more where the face looks towards larger coordinates).
  enum class Code : uint8_t { kGray, kFace };
  Code code;

  double dividend;  ///< depth per t, in the upper of 32 bits
  double scale;     ///< 2^-(shift + 8)
  int shift;
  double near_q8, far_q8;
  double cut;  ///< 1/256 where depths are cut to 24 bits, else 1
  double inverse;

  float float_dividend, float_scale, float_near, float_per_depth;
  int32_t int_dividend;
  float margin;
  /// Whether floats are of use. Where they are not, every fall may lie within the margin of a whole number.
  bool floats_tell;
  /// For a camera whose rays are parallel: the ratio of each axis, rounded to a float (within 2^-24); 0 for an axis
  /// along which the rays do not move.
  float axis_ratio[3];
};

GrayScale gray_scale_of(const Camera& camera, const Shading& shading);

/// The code of what the core's ray hits.
uint8_t code_of(GrayScale::Code code, const Hit& hit, const Ray& ray, const Camera& camera,
                const Shading& shading);

/// Finds, as the core does, the grey or the code of the face where the ray of pixel (x, y) hits an entry of one voxel
/// (voxel_lists.h) of the cube at `cube`.
uint8_t code_exactly(const Camera& camera, const Shading& shading, GrayScale::Code code, int32_t x, int32_t y,
                     uint32_t entry, const uint32_t (&cube)[3]);

}  // namespace thimble::wide
