/// @file slope_window.h
/// The window in which the slope of a surface is found (slope.h), for a host that keeps what many points of a
/// face share.
#ifndef THIMBLE_LIGHT_HOST_SLOPE_WINDOW_H
#define THIMBLE_LIGHT_HOST_SLOPE_WINDOW_H

#include <stdint.h>

#include "../../base/vec.h"
#include "../../picture/shading.h"
#include "../../tree/compact_tree.h"
#include "slope.h"

namespace thimble::lit {

inline constexpr int kSlopeSide = 12;    ///< of the window
inline constexpr int kSlopeShell = 3;    ///< voxels that a body is thick at least; what is thinner is a shell
inline constexpr int kSlopeColumns = 5;  ///< looked at to each side of the point's own
static_assert(kSlopeSide == 2 * kSlopeColumns + 2, "one more where the window begins before an odd voxel");
/// Distances are in 1/64 voxel: R^2 has 17 bits, a term 26, and all those of one sign, half a ball, 31 less a
/// tenth.
inline constexpr int32_t kSlopeUnit = 64;
inline constexpr int32_t kSlopeReachSquare =
    (kSlopeReachHalves * kSlopeUnit / 2) * (kSlopeReachHalves * kSlopeUnit / 2);

/// The voxels around a point, a bit each: bit x of a row.
struct SlopeWindow {
  Vec3i low;
  uint16_t rows[kSlopeSide][kSlopeSide] = {};  ///< z, y

  static constexpr bool is_inside(const Vec3i& at) {
    return at.x >= 0 && at.x < kSlopeSide && at.y >= 0 && at.y < kSlopeSide && at.z >= 0 && at.z < kSlopeSide;
  }
  bool is_solid(const Vec3i& at) const { return is_inside(at) && (rows[at.z][at.y] >> at.x & 1U) != 0; }
  void put(const Vec3i& at, bool solid) {
    if (is_inside(at)) {
      const unsigned bit = 1U << at.x;
      rows[at.z][at.y] = static_cast<uint16_t>(solid ? rows[at.z][at.y] | bit : rows[at.z][at.y] & ~bit);
    }
  }
};

/// Where the window of a voxel begins: at an even place.
constexpr int32_t slope_window_low(int32_t voxel) {
  return (voxel - kSlopeColumns) & ~1;
}

// --- The parts of surface_normal ------------------------------------------------------------------------

/// Reads the voxels of the window at `window->low`, which is even, off the tree; adds the nodes read to
/// `*visits`.
void read_slope_window(const CompactTree& tree, const Body& body, SlopeWindow* window, uint32_t* visits);
/// The axis along which the surface is followed where the gradient at a face is `normal`; -1: the normal is
/// the face's.
int slope_axis(const Vec3i& normal, const Face& face);
/// The unit normal of the gradient that is left after that.
Vec3i unit_of_slope(const Vec3i& normal, const Face& face);

}  // namespace thimble::lit

#endif
