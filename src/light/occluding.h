// What occlusion makes of the rays that it sends. Internal to src/.
#ifndef THIMBLE_SRC_LIGHT_OCCLUDING_H
#define THIMBLE_SRC_LIGHT_OCCLUDING_H

#include <stdint.h>

#include "thimble/light/detail/pixel.h"
#include "thimble/light/host/optics.h"

namespace thimble::lit {

/// How much light comes by a ray that meets nothing.
inline constexpr uint32_t kOpenShare = 1U << 12;

/// How many rays a point sends.
constexpr int occlusion_rays(const Occlusion& occlusion) {
  return occlusion.rays < kOcclusionDirections ? occlusion.rays : kOcclusionDirections;
}

/// How open the way of one is that meets something at `way` (1/256 voxel) along an axis of which its direction has
/// `component`.
/// All directions of the pattern have one length, 7 bits; the way has 23.
[[gnu::always_inline]] inline uint32_t share_of_way(const Occlusion& occlusion, uint32_t way,
                                                    uint32_t component) {
  const uint32_t distance_q8 = way * kOcclusionLength / component;
  const uint32_t reach_q8 = uint32_t{occlusion.reach} << 8;
  return distance_q8 < reach_q8 ? (distance_q8 << 4) / occlusion.reach : kOpenShare;  // 24 bits by 4
}

/// Lets a face have as much light as its rays, of which `open` is the sum.
[[gnu::always_inline]] inline void darken(const Occlusion& occlusion, uint32_t open, int rays, Color* light) {
  const uint32_t closed = kOpenShare - open / static_cast<uint32_t>(rays);
  const uint32_t factor = kOpenShare - closed * occlusion.strength / 255;
  for (uint32_t& channel : light->c) {
    channel = ((channel < UINT16_MAX ? channel : UINT16_MAX) * factor) >> 12;
  }
}

}  // namespace thimble::lit

#endif
