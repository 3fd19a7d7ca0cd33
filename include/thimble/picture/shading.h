/// @file shading.h
/// From a hit to a colour, in integers: the same colour on every machine.
#ifndef THIMBLE_PICTURE_SHADING_H
#define THIMBLE_PICTURE_SHADING_H

#include <stdint.h>

#include "../base/memory.h"
#include "../base/vec.h"
#include "../trace/ray.h"
#include "camera.h"
#include "pixel.h"

namespace thimble {

enum class ShadeMode : uint8_t {
  kDepth,   ///< brightness falls with the distance from the camera's plane (the paper's Figure 2)
  kNormal,  ///< the direction of the face as a colour: component -1..1 becomes 0..255
  kColor,   ///< palette colour under one distant light
  kMono,    ///< white where something is, black where not (the paper's first tracer)
};

/// Everything that `shade` looks at besides the hit. Plain data: copy it as you like.
struct Shading {
  ShadeMode mode = ShadeMode::kDepth;
  /// Colours by material index; an index beyond it takes `default_color`. May be empty.
  Span<const Rgb8> palette;
  Rgb8 default_color{230, 230, 230};
  /// Where a ray hits nothing; kMono is black there.
  Rgb8 background{0, 0, 0};
  /// kDepth: distances along the camera's forward vector, in 1/256 voxel, that get full brightness and the
  /// least (`kFarBrightness`); see `depth_range`. Nearer and farther ones are clamped. Any two numbers will
  /// do: where far is not beyond near, everything up to near is bright and everything behind it dim.
  int32_t near_q8 = 0;
  int32_t far_q8 = 256;
  /// kColor: brightness of the faces -x, +x, -y, +y, -z, +z, 256 = the palette's own colour; see
  /// `light_from`.
  uint16_t face_light[6] = {160, 122, 199, 83, 44, 238};
};

/// What kDepth gives at `far_q8` and beyond: well above black, so that everything hit is seen.
inline constexpr int kFarBrightness = 40;

/// Bounds of what follows against exact arithmetic on the same integers, swept by
/// tools/instruments/operation_errors.cpp. Depths are too small by at most 1/2^kPlanarDepthErrorShift of
/// themselves and kPlanarDepthErrorQ8; the others are of 255 or 256 for full brightness, kDepthShadeErrorQ8
/// in 1/256 of that.
inline constexpr int kPlanarDepthErrorShift = 11;
inline constexpr int32_t kPlanarDepthErrorQ8 = 1;
inline constexpr int kDepthShadeErrorQ8 = 260;
inline constexpr int kFaceLightError = 2;
inline constexpr int kLitChannelError = 1;

/// The near and far planes for `camera` that just hold `bounds`, a box in the world: distances of its nearest
/// and farthest corner, rounded down. Near is at least 0, far at least one voxel beyond near. The corners of
/// `bounds` are 0 .. 2^kMaxLevel; an empty box and a camera that was never set have the range of a
/// DepthRange{}.
struct DepthRange {
  int32_t near_q8 = 0;
  int32_t far_q8 = 256;
};
DepthRange depth_range(const Camera& camera, const VoxelBox& bounds);

/// Face brightness under a distant light that shines from `toward_light` (any length up to 2^14 a component,
/// not all 0): half-Lambert, (141 + 115 cos(angle)) / 256, so a face turned straight to the light has 1 and
/// one turned away 0.1.
void light_from(const Vec3i& toward_light, uint16_t (&face_light)[6]);

/// The face that a hit is shaded with: axis and side (negative: the face looks towards smaller coordinates).
/// A ray that starts inside (axis -1) gets the face opposed to its largest direction component, the lowest
/// axis on a tie.
struct Face {
  int axis;
  bool negative;
};
Face face_of(const Hit& hit, const Vec3i& direction);

/// Distance of the hit along the camera's forward vector, in 1/256 voxel: t * camera.depth_per_t_q8(),
/// rounded down twice, so too small by at most 2^-11 of itself and one unit; INT32_MAX where it would be
/// more, which no hit of this camera's rays reaches. 0 for a ray that starts inside. One 32-bit division, one
/// 64-bit product.
int32_t planar_depth_q8(const Hit& hit, const Camera& camera);

/// The colour of one pixel. One 32-bit division for kDepth, none else.
Rgb8 shade(const Hit& hit, const Ray& ray, const Camera& camera, const Shading& shading);

}  // namespace thimble

#endif
