// A plane on which each ray of a distant light is a point. In worlds of level 9 and 10 a byte for each cell of it, as wide as
// a brick, says how far along the light's fastest axis c a ray may meet something. Internal to src/.
//
// A ray keeps u = a - c * slope, and likewise v of b, mirrored so that it goes up on all axes. The slope is rounded down to
// 1/2^16, by which u grows by less than 1/256 brick on the way through the world; a cell's bricks are those of rays with
// that u, with 1/64 to spare.
#pragma once

#include <stdint.h>

namespace thimble::bricks {
namespace {

struct SunPlane {
  // In place of a number of layers: nothing is proven, or it has more bits.
  static constexpr uint8_t kAll = 255;

  int32_t slope[2];
  int32_t lead[2];  // cells before that of the box's corner
  int32_t count[2];

  // On a (0) or b (1), for a box of so many bricks there and along c.
  void set(int k, int32_t slope_q16, int32_t side, int32_t layers) {
    slope[k] = slope_q16;
    lead[k] = (layers * slope_q16 + 0xFFFF) >> 16;
    count[k] = side + lead[k] + 1;
  }
  // The cell of a ray through a point, which is given on a or b and along c, in 1/256 voxel.
  int32_t cell_of(int k, int32_t across, int32_t along) const {
    const int32_t moved = (along >> 8) * slope[k] + ((along & 255) * slope[k] >> 8);
    return (across * 256 - moved + (lead[k] << 18)) >> 18;
  }
  // The first and the last brick that rays of a cell may pass in a layer, maybe outside of the box.
  int32_t first(int k, int32_t cell, int32_t layer) const {
    return ((cell - lead[k]) * (1 << 16) + layer * slope[k] - kSpare) >> 16;
  }
  int32_t last(int k, int32_t cell, int32_t layer) const {
    return ((cell + 1 - lead[k]) * (1 << 16) + (layer + 1) * slope[k] + kSpare) >> 16;
  }

 private:
  static constexpr int32_t kSpare = 1 << 10;
};

}  // namespace
}  // namespace thimble::bricks
