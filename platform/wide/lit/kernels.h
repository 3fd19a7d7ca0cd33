/// @file kernels.h
/// The loops of lit pictures that are compiled for several instruction sets, as those of wide/kernels.h.
#ifndef THIMBLE_PLATFORM_WIDE_LIT_KERNELS_H
#define THIMBLE_PLATFORM_WIDE_LIT_KERNELS_H

#include <stddef.h>
#include <stdint.h>

namespace thimble::wide {

/// So many numbers behind the last are read, and written.
inline constexpr size_t kMostSkyLanes = 8;

/// Of rays of these directions, none zero, the share in 1/4096 that lit::sky_color mixes into the horizon: of the
/// zenith where z is not below 0, else of the ground.
void find_sky_shares(const int32_t* x, const int32_t* y, const int32_t* z, size_t count, int32_t* shares);

}  // namespace thimble::wide

#endif
