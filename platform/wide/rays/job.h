/// What one call of ray_map.h asks of the vectors, and what these ask of plain code for a single ray.
#pragma once

#include "wide/kernel.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

enum class Bound : uint8_t {
  kNone,
  kBefore,  ///< hits count below the points
  kFrom,    ///< rays begin at the points
};

struct Job {
  const RayMap* map = nullptr;
  const Ray* rays = nullptr;
  size_t count = 0;
  const RayPoint* points = nullptr;  ///< only with a bound
  Bound bound = Bound::kNone;
  size_t point_step = 1;  ///< from a ray's point to the next ray's; 0: all rays share one
  // One of these is wanted and not null; before the call all its elements say "a miss".
  uint8_t* any = nullptr;
  Hit* hits = nullptr;
  RayPoint* entries = nullptr;
  bool names = true;  ///< whether hits want materials
  /// By material: with `any`, the value that `any` gets; with `entries`, 0 where the voxel counts as a miss.
  const uint8_t* classes = nullptr;
  Status status = Status::kOk;  ///< the first error
};

/// Traces all rays of a job that has a map. kernels/trace.cpp.
extern const Kernel<void(Job* job)> trace_job;

/// Traces one ray by the core.
void trace_by_core(Job* job, size_t ray);

/// Stores the hit of ray number `ray`, after `visits` steps. `cell` is the voxel of the map's world, mirrored along the
/// ray's negative components.
void put_hit(Job* job, size_t ray, const Vec3i& cell, uint32_t visits);

}  // namespace thimble::wide
