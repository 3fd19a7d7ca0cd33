/// The loops of lit pictures. They are compiled for several instruction sets, as those of wide/raster/kernels.h.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "wide/kernel.h"

namespace thimble::wide {

/// So many numbers behind the last one may be read and written.
inline constexpr size_t kMostLightLanes = 8;

/// Finds for rays of these directions, none of them zero, the share in 1/4096 that lit::sky_color mixes into the
/// horizon's colour: of the zenith's where z is not below 0, else of the ground's.
extern const Kernel<void(const int32_t* x, const int32_t* y, const int32_t* z, size_t count, int32_t* shares)>
    find_sky_shares;

/// A lamp, and points on faces that look the same way. Of three axes the faces' own comes first.
struct LampRays {
  int32_t place[3];       ///< the lamp's, in 1/256 voxel
  const int32_t* at[3];   ///< the points', in 1/256 voxel
  bool is_negative;       ///< the faces look to smaller coordinates
  uint16_t reach;         ///< the lamp's, not 0
  uint16_t color_q8[3];   ///< the lamp's
  int32_t* direction[3];  ///< gets the rays' directions
  int32_t* numerator;     ///< gets 256 times the t of the lamp on each
  /// Gets the light that arrives if nothing is in the way: 0, 0, 0 where the face is turned away.
  int32_t* brightness[3];
};

/// Does as lit::light_ray for many points. Where a brightness is 0 the other results mean nothing.
extern const Kernel<void(const LampRays& lamp, size_t count)> aim_at;

/// Finds the gradient at a point as lit::surface_normal adds it up, from the rows of a slope's window. `point` is in 1/64
/// voxel of the window, on each axis in the sixth or seventh voxel.
extern const Kernel<void(const uint16_t* rows, const int32_t* point, int32_t* gradient)> find_gradient;

/// How many lanes of words `turn_words` turns.
inline constexpr size_t kTurnLanes = 16;

/// Turns 16 words of 16 bits in each lane: bit j of word k and bit k of word j change places.
extern const Kernel<void(uint16_t (*words)[kTurnLanes])> turn_words;

}  // namespace thimble::wide
