/// @file ray.h
/// The quantised ray, what it hits, and the functions that find this: exact, in integers, for each of the four
/// structures.
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
#include "../tree/compact_tree.h"
#include "../tree/dense_grid.h"
#include "../tree/octree.h"
#include "../tree/shared_tree.h"

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

// Every function below gives the answer defined at the top, whatever structure and arithmetic width it uses.
// There is no epsilon, no division and no rounding in it. Stack: one entry a level (tests/budgets/stack.csv has
// the bytes computed by the compiler). Nothing is written but the result, so any number of rays may be traced at
// once, in interrupts too, as long as nobody changes the structure.

/// The arithmetic a ray is traced with. It never changes an answer.
enum class Width : uint8_t {
  kAuto,  ///< 32 bits where the target's registers have 32 and the ray allows it, else 64
  k32,    ///< 32-bit products only; rays for which `accepts_32` is false are refused
  k64,    ///< all that `check_ray` accepts; largest intermediate below 2^44
};

struct TraceOptions {
  /// The ray is stopped with HitKind::kStepLimit instead of visiting one more node than this.
  uint32_t max_visits = UINT32_MAX;
  Width width = Width::kAuto;
};

/// Whether the 32-bit path may trace `ray` in a world of 2^level: with R the largest distance on any axis
/// from the origin to a plane of the world (in 1/256 voxel) and D the largest direction component, the bits
/// of R and of D are at most 31 together, so that every product of the two stays below 2^31. A world of 64
/// seen from within two world sizes takes directions of 16 bits, one of 512 takes 13. For rays that pass
/// `check_ray` in that world, and levels 1 .. kMaxLevel; it asks neither.
bool accepts_32(const Ray& ray, int level);

/// The solid voxel entered first. `hit` is always written on `kOk`; `kOutOfRange` and `kBadArgument` are
/// those of `check_ray` (and of `accepts_32` for Width::k32), `hit` then being untouched. A ray that misses
/// the box of what is occupied visits no node. Cost: a few hundred to some thousand instructions,
/// `hit->visits` nodes.
Status closest_hit(const CompactTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options = {});
Status closest_hit(const Octree& tree, const Ray& ray, Hit* hit, const TraceOptions& options = {});
/// The visits are those in the compact tree that it was made from. Materials, where there are several, take
/// another way down to the voxel.
Status closest_hit(const SharedTree& tree, const Ray& ray, Hit* hit, const TraceOptions& options = {});
/// In a dense grid a visit is a cell looked at.
Status closest_hit(const DenseGrid& grid, const Ray& ray, Hit* hit, const TraceOptions& options = {});

/// The same with Width::k32 and nothing of the 64-bit path behind it: a firmware that traces only so has
/// neither its code nor its stack.
Status closest_hit_32(const CompactTree& tree, const Ray& ray, Hit* hit, uint32_t max_visits = UINT32_MAX);

/// Whether there is a hit at all: `kind` gets what `closest_hit` would find, `visits` (may be null) the nodes
/// read, without the work of naming the voxel, its face and its t.
Status any_hit(const CompactTree& tree, const Ray& ray, HitKind* kind, uint32_t* visits = nullptr,
               const TraceOptions& options = {});
Status any_hit(const Octree& tree, const Ray& ray, HitKind* kind, uint32_t* visits = nullptr,
               const TraceOptions& options = {});
Status any_hit(const SharedTree& tree, const Ray& ray, HitKind* kind, uint32_t* visits = nullptr,
               const TraceOptions& options = {});
Status any_hit(const DenseGrid& grid, const Ray& ray, HitKind* kind, uint32_t* visits = nullptr,
               const TraceOptions& options = {});

}  // namespace thimble

#endif
