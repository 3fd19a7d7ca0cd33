/// Rays that somebody gives in numbers, as the core traces them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "output/units.h"
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
inline std::string quantised_ray(const std::array<double, 6>& numbers, const RayRules& rules, Ray* to) {
  const double low = static_cast<double>(kMinOriginWorlds) * (1 << rules.level);
  const double high = static_cast<double>(kMaxOriginWorlds) * (1 << rules.level);
  for (const double number : numbers) {
    if (!std::isfinite(number)) {
      return "a ray has a coordinate that is not a finite number";
    }
  }
  Ray& ray = *to;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = numbers[static_cast<std::size_t>(axis)];
    if (value < low || value > high) {
      return "the origin's " + shortest(value) + " is outside the accepted " + shortest(low) + " to " +
             shortest(high) + " (-4 to 5 world sizes)";
    }
    ray.origin[axis] = Q8::from_raw(static_cast<std::int32_t>(std::lround(value * Q8::kOne)));
  }
  double largest = 0;
  bool whole = true;
  for (std::size_t i = 3; i < 6; ++i) {
    largest = std::max(largest, std::abs(numbers[i]));
    whole = whole && numbers[i] == std::trunc(numbers[i]);
  }
  if (largest == 0) {
    return "the direction is zero";
  }
  const double limit = rules.direction_bits == 0 ? kMaxDirection : (1 << rules.direction_bits) - 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = numbers[static_cast<std::size_t>(axis) + 3];
    const double scaled = whole && largest <= limit ? value : value / largest * limit;
    ray.direction[axis] = static_cast<std::int32_t>(std::lround(scaled));
  }
  if (rules.only_32 && !accepts_32(ray, rules.level)) {
    return "--engine ray32 does not take this ray; auto does";
  }
  return {};
}

}  // namespace thimble::tools
