/// Where rays of occlusion can meet nothing, so that none needs to be sent: before wide floors and walls, and on the
/// side where a surface falls away.
#pragma once

#include <stdint.h>

#include "thimble/light/scene.h"
#include "wide/rays/ray_map.h"

namespace thimble::wide {

/// Looks at the space before a face once for each patch of 4 x 4 voxels, and remembers what it saw.
class OpenSpace {
 public:
  static constexpr unsigned kAll = 15;

  /// `around` are the rays of occlusion from each point.
  OpenSpace(const RayMap& map, const Occlusion& occlusion, uint32_t around);

  /// Which of the rays from a point of a face (2 * axis, and 1 more where it looks to larger coordinates) may meet
  /// something: bit n % 4 is set for ray n of kOcclusionPattern. Says kAll where looking costs more than it spares.
  unsigned rays_before(const Vec3Q8& at, uint8_t face) { return credit_ > 0 ? look_up(at, face) : kAll; }

 private:
  static constexpr int kKnownBits = 9;

  unsigned look_up(const Vec3Q8& at, uint8_t face);
  unsigned look(const Vec3i& corner, uint8_t face) const;

  const RayMap& map_;
  uint32_t around_;
  int32_t across_;  // how far the rays go, in voxels
  int32_t along_;   // the same along the face's axis
  int32_t credit_;
  uint64_t known_[1 << kKnownBits] = {};  // patches, and in the last four bits the rays
};

}  // namespace thimble::wide
