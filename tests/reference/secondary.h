/// The exact reference for secondary rays: where they start, and the first voxel from a point of
/// a ray on that is of some kind. Worked out the plain way, a voxel at a time, in exact fractions.
///
/// Definitions, besides those of reference.h:
///  - A secondary ray starts on the face that was entered. The coordinate across the face is that of the
///    face's plane; each of the others is that of the point of the hit, rounded down to a multiple of 1/256
///    and then brought to low .. high - 1/256 of the block that was hit. Where the ray started inside, it is
///    its origin.
///  - From a point of a ray on, a voxel counts when the ray spends a positive length in it after that point.
///  Such
///    voxels are disjoint in t, so one comes first.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "reference/reference.h"

namespace thimble::reference {

/// t as an exact fraction; denominator > 0.
struct Time {
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;
};

/// A point in 1/256 voxel.
using PointQ8 = std::array<std::int64_t, 3>;

/// Where a ray from `hit` of `ray` starts; the block hit is a cube of `side` voxels at `hit.voxel`.
PointQ8 start_on_face(const Ray& ray, const Hit& hit, int side = 1);

/// The voxel that the ray is in right after `time`.
Voxel voxel_after(const Ray& ray, const Time& time);

/// The first voxel after `from` that `stops`, with t and axis as the ray enters it (before `from`, where it
/// is in it there). The walk ends without a hit at the first voxel that is `beyond`; it must come to one or
/// the other.
Hit first_voxel(const Ray& ray, const Time& from, const std::function<bool(const Voxel&)>& stops,
                const std::function<bool(const Voxel&)>& beyond);

}  // namespace thimble::reference
