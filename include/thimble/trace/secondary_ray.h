/// @file secondary_ray.h
/// Secondary rays, which start at a hit: shadows, mirrors, glass. Exact, and without an epsilon.
///
/// A secondary ray starts on the face that was crossed, with that coordinate exact: on the lower plane of the
/// block for a face that looks to smaller coordinates, on the upper one for the other. Its two other
/// coordinates are those of the exact point of the hit, rounded down to 1/256 voxel and clamped to
/// low .. high - 1/256, low and high being the block's planes (so its point belongs to the block it was hit
/// on).
///
///           |              A ray that runs away from the plane spends no length on the far side, by
///     out   |   block      the rule of ray.h. So a reflected ray cannot hit what it leaves: no acne, by
///     <-----*              definition and not by luck. One that runs into the plane starts in the
///           |              block, unless it starts on another of its planes and leaves by that at once.
///         plane
///
/// Which of the two it does is a question about the sign of one component (`leaves_face`, `enters_face`). A
/// direction that runs within the plane does neither and sends no ray.
///
/// Everything here is reentrant and exact. Limits are those of ray.h.
#ifndef THIMBLE_TRACE_SECONDARY_RAY_H
#define THIMBLE_TRACE_SECONDARY_RAY_H

#include <stdint.h>

#include "../base/status.h"
#include "../base/vec.h"
#include "../tree/compact_tree.h"
#include "ray.h"

namespace thimble {

/// Where a secondary ray starts at `hit` (a kHit of `ray`). For axis -1 the origin itself: the ray starts inside.
/// Two 32-bit divisions for a voxel or a block of up to 8 voxels a side; by shifting for larger ones.
Vec3Q8 start_on_face(const Ray& ray, const Hit& hit);

/// The same on any plane: that of `axis` at `plane_q8`, which the ray crosses at t = |plane_q8 - origin| /
/// (256 * |direction|) >= 0 (its direction is not 0 there). The other two coordinates are clamped to
/// low_q8 .. high_q8 - 1 (1/256 voxel, low < high), those of `axis` are not looked at. Planes and bounds are
/// within the limits of origins.
Vec3Q8 start_on_plane(const Ray& ray, int axis, int32_t plane_q8, const Vec3i& low_q8, const Vec3i& high_q8);

/// Whether a ray of `direction` from a face of `axis` (looking to smaller coordinates or not) goes away from
/// the solid behind it, or into it. True both for axis -1: there is no face.
constexpr bool leaves_face(const Vec3i& direction, int axis, bool towards_smaller) {
  return axis < 0 || (towards_smaller ? direction[axis] < 0 : direction[axis] > 0);
}
constexpr bool enters_face(const Vec3i& direction, int axis, bool towards_smaller) {
  return axis < 0 || (towards_smaller ? direction[axis] > 0 : direction[axis] < 0);
}
/// Whether the face entered by `hit` looks to smaller coordinates; false for axis -1.
constexpr bool looks_to_smaller(const Ray& ray, const Hit& hit) {
  return hit.axis >= 0 && ray.direction[hit.axis] > 0;
}

/// The voxel in which a ray spends a positive length from t = 0 on; may lie outside the world.
constexpr Vec3i starting_voxel(const Ray& ray) {
  // On a plane, a ray that goes down is in the voxel below.
  return {(ray.origin.x.raw - (ray.direction.x < 0 ? 1 : 0)) >> Q8::kBits,
          (ray.origin.y.raw - (ray.direction.y < 0 ? 1 : 0)) >> Q8::kBits,
          (ray.origin.z.raw - (ray.direction.z < 0 ? 1 : 0)) >> Q8::kBits};
}

/// Whether `voxel` is solid, and then its material. False for a voxel outside the world. `material` may be
/// null. Reads one node a level at most.
bool material_at(const CompactTree& tree, const Vec3i& voxel, uint8_t* material);

/// A place on a ray: exactly t = t_numerator / t_denominator, both as in a `Hit` of the same ray (numerator
/// 0 .. 2^23, denominator 256 * |a component of its direction| or, for t = 0, 1).
struct RayPoint {
  int32_t t_numerator = 0;
  int32_t t_denominator = 1;
};
constexpr RayPoint point_of(const Hit& hit) {
  return {hit.t_numerator, hit.t_denominator};
}

/// Where a ray leaves a medium: the first voxel after it that is not solid with that material, as a `Hit`.
struct MediumExit {
  /// `kind`: kHit, or kStepLimit (then only `visits` is valid). `voxel`: the voxel, which for `left_world`
  /// lies just outside of the world; of a merged block its lowest corner. `axis` and t: of the face by which
  /// the ray enters it, the lowest axis on a tie, so `start_on_face` takes it as it is; -1 when the ray
  /// starts in it at its origin. `material`: valid with `into_solid`.
  Hit hit;
  bool into_solid = false;  ///< the voxel is solid, with another material
  bool left_world = false;  ///< the voxel lies outside the world
};

/// Follows `ray`, from `from` on, as long as it is in voxels that are solid with `material`, to the first one
/// that is not and in which it spends a positive length. Where it is in none of `material` at `from`, that is
/// the voxel it is in there (whose t may then lie before `from`). For a ray that is not in the world at
/// `from` only `left_world` means something (`hit.axis` is -1 and t = 0).
///
/// Crossings at the same t are taken together. Blocks that are solid through are crossed whole, so visits are
/// nodes of the tree, below 3 * 2^level of them. Given the ray that hit the medium and that hit's point, this
/// follows the same ray on, with nothing rounded: so a medium that bends nothing is seen through without a
/// trace (`closest_hit_from` then continues at the exit's point).
///
/// `kOk`; or as `closest_hit`, with `exit` untouched.
Status leave_medium(const CompactTree& tree, const Ray& ray, uint8_t material, MediumExit* exit,
                    const RayPoint& from = {}, const TraceOptions& options = {});

/// The first solid voxel in which `ray` spends a positive length after `from`: `closest_hit` for a ray that
/// has been followed so far. `hit->t` may lie before `from` when the ray is in that voxel there. Status as
/// `closest_hit`.
Status closest_hit_from(const CompactTree& tree, const Ray& ray, const RayPoint& from, Hit* hit,
                        const TraceOptions& options = {});

/// Whether something solid is entered at a t below `before` (t as the exact fraction; numerator and
/// denominator 0 .. INT32_MAX, denominator not 0): what shadows of point lights and occlusion within a reach
/// ask. `kind`: kHit, kMiss, or kStepLimit. `visits` may be null. Status as `closest_hit`.
Status any_hit_before(const CompactTree& tree, const Ray& ray, const RayPoint& before, HitKind* kind,
                      uint32_t* visits = nullptr, const TraceOptions& options = {});

/// The ray from `start` towards a point: its direction has at most `direction_bits` (2 .. 20) bits a
/// component, rounded to nearest (a turn below 2^-(direction_bits - 1) rad), and `place` gets the t at which
/// it is at the point, to that rounding. False when both are equal. Start and point lie where a ray may start
/// (`check_ray`) in a world of at most 2^kMaxLevel.
bool ray_towards(const Vec3Q8& start, const Vec3Q8& point, int direction_bits, Ray* ray, RayPoint* place);

}  // namespace thimble

#endif
