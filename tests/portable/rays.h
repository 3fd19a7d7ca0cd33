/// Rays whose answers were worked out by hand from the definition (ray.h), and the small scenes they are
/// traced in. Plain data: every structure and width is held to them on every machine (cases_rays.cpp), and on
/// a desktop the exact reference is (test_trace_cases.cpp).
#pragma once

#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/base/vec.h"
#include "thimble/trace/ray.h"

namespace thimble::portable {

/// A small world made of solid boxes.
struct RayScene {
  uint8_t level;
  uint8_t box_count;
  uint16_t pool_nodes;  ///< what its octree needs at its fullest
  struct Box {
    int16_t low[3];
    int16_t high[3];
  };
  const Box* boxes;
};

/// `RayCase::axis` of a ray that hits nothing.
inline constexpr int8_t kMiss = -2;

struct RayCase {
  const char* name;
  const RayScene* scene;
  int16_t unit_q8;  ///< the origin is given in this many 1/256 voxel
  int8_t axis;      ///< of the face entered, -1 for a start inside, or kMiss
  int32_t origin[3];
  int32_t direction[3];
  int16_t voxel[3];  ///< what is hit
  /// t of the hit as a fraction.
  int32_t numerator;
  int32_t denominator;  ///< any multiple, above 0

  constexpr Ray ray() const {
    return {{Q8::from_raw(origin[0] * unit_q8), Q8::from_raw(origin[1] * unit_q8),
             Q8::from_raw(origin[2] * unit_q8)},
            {direction[0], direction[1], direction[2]}};
  }
};

inline constexpr int kRayCaseCount = 125;
Span<const RayCase> ray_cases();

}  // namespace thimble::portable
