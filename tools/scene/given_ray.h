/// Rays that somebody gives in numbers, as the core traces them.
#pragma once

#include <array>
#include <string>

#include "thimble/trace/ray.h"

namespace thimble::tools {

/// How numbers become rays.
struct RayRules {
  int level = 0;           ///< of the world
  int direction_bits = 0;  ///< 0: as the core allows
  bool only_32 = false;    ///< refuses rays that 32-bit products do not take
};

/// The ray of ox, oy, oz, dx, dy, dz, in voxels: origin to the nearest 1/256 voxel; a direction of integers within the
/// limit as it is, any other scaled so that its largest component is the limit. A zero component stays zero.
/// Returns what is wrong with it, else an empty sentence.
std::string quantised_ray(const std::array<double, 6>& numbers, const RayRules& rules, Ray* to);

}  // namespace thimble::tools
