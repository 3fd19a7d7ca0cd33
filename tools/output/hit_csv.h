/// @file hit_csv.h
/// Hits as lines of CSV, the same columns wherever hits are written.
#ifndef THIMBLE_TOOLS_OUTPUT_HIT_CSV_H
#define THIMBLE_TOOLS_OUTPUT_HIT_CSV_H

#include <cmath>
#include <string>

#include "thimble/trace/ray.h"

namespace thimble::tools {

/// The column names: hit 0/1; voxel; t (17 significant digits; point = q-origin / 256 + t * q-direction, in
/// voxels); axis; nodes visited; q-origin in 1/256 voxel and q-direction as integers, both as traced; the voxel's index
/// in the palette, empty where what was traced keeps none; how far it is from the origin, in voxels, within 2 units of the last place.
inline constexpr const char* kHitColumns =
    "hit,vx,vy,vz,t,axis,nodes,qox,qoy,qoz,qdx,qdy,qdz,material,distance";

/// Appends one line's values for these columns and a line feed. Voxel, t, axis, material and distance of a miss are
/// empty.
void append_hit(std::string* text, const Ray& ray, const Hit& hit, bool has_material);

/// t as the nearest double: numerator and denominator are exact, so the division is the only rounding.
inline double hit_t(const Hit& hit) {
  return static_cast<double>(hit.t_numerator) / hit.t_denominator;
}

/// How far away it is, in voxels along the unit ray.
inline double hit_distance(const Ray& ray, const Hit& hit) {
  return hit_t(hit) * std::hypot(static_cast<double>(ray.direction.x), static_cast<double>(ray.direction.y),
                                 static_cast<double>(ray.direction.z));
}

}  // namespace thimble::tools

#endif
