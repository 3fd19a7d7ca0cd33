/// @file ray.h
/// The quantised ray, what it hits, and the limits of both.
///
/// A point of the ray is origin + t * direction, t >= 0, in voxels. The origin is given in 1/256 voxel, the
/// direction in integers; that is the whole definition, so the answer is a fact of integer arithmetic and the
/// same on every machine (src/trace/README.md, "A ray").
///
/// Voxel (i,j,k) is the half-open box [i,i+1) x [j,j+1) x [k,k+1). A ray hits a solid voxel when it spends a
/// positive length inside; it does not hit what it touches in a point only. A ray that runs within a face or
/// an edge belongs to the box that owns it. The hit is the solid voxel entered first.
#ifndef THIMBLE_TRACE_RAY_H
#define THIMBLE_TRACE_RAY_H

#include <stdint.h>

#include "../base/status.h"
#include "../base/vec.h"

namespace thimble {

/// Directions are integers of at most 20 bits and a sign.
inline constexpr int32_t kMaxDirection = (int32_t{1} << 20) - 1;
/// Origins lie from -4 to 5 world sizes, inclusive, on every axis.
inline constexpr int32_t kMinOriginWorlds = -4;
inline constexpr int32_t kMaxOriginWorlds = 5;

struct Ray {
  Vec3Q8 origin;    ///< in 1/256 voxel
  Vec3i direction;  ///< integers, -kMaxDirection .. kMaxDirection, not all zero
};

enum class HitKind : uint8_t {
  kMiss,       ///< the ray leaves the world without a hit
  kHit,        ///< `voxel`, `t_numerator`, `axis` and the rest are valid
  kStepLimit,  ///< stopped by the limit given; whether there is a hit further on is not known
};

/// What a ray met. For `kMiss` and `kStepLimit` only `visits` is meaningful.
struct Hit {
  HitKind kind = HitKind::kMiss;
  /// Axis of the face entered (0, 1, 2; the lowest when several are entered at the same t), or -1 when the
  /// ray starts inside the voxel.
  int8_t axis = -1;
  /// Palette index of what was hit.
  uint8_t material = 0;
  /// Log2 of the side of the solid block hit: 0 for a voxel; above 0 only for a block merged by coarsening,
  /// whose lowest corner `voxel` then is.
  uint8_t block_level = 0;
  /// The voxel's indices.
  Vec3i voxel;
  /// t = t_numerator / t_denominator exactly: numerator 0 .. 2^23, denominator 256 * |direction[axis]|
  /// (1 for axis -1). Not reduced.
  int32_t t_numerator = 0;
  int32_t t_denominator = 1;
  /// Tree nodes whose child mask was read (dense grid: cells looked at).
  uint32_t visits = 0;
};

/// Whether `ray` may be traced in a world of 2^level: `kOk`, `kBadArgument` (zero direction) or `kOutOfRange`
/// (level, direction or origin beyond the limits above).
constexpr Status check_ray(const Ray& ray, int level) {
  if (level < kMinLevel || level > kMaxLevel) {
    return Status::kOutOfRange;
  }
  const int32_t low = kMinOriginWorlds * (Q8::kOne << level);
  const int32_t high = kMaxOriginWorlds * (Q8::kOne << level);
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t origin = ray.origin[axis].raw;
    const int32_t direction = ray.direction[axis];
    if (origin < low || origin > high || direction < -kMaxDirection || direction > kMaxDirection) {
      return Status::kOutOfRange;
    }
  }
  if (ray.direction == Vec3i{}) {
    return Status::kBadArgument;
  }
  return Status::kOk;
}

}  // namespace thimble

#endif
