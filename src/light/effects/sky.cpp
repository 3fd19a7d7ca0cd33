// Where rays leave the world.
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {

Color sky_color(const Frame& frame, const Vec3i& direction) {
  const Sky& sky = frame.scene.sky;
  const uint32_t height = cosine_q14(direction, 2) >> 2;  // 2^12 = straight up or down
  const uint32_t rest = 4096 - height;
  if (direction.z >= 0) {
    // Haze near the horizon: 1 - (1 - h)^2.
    return mixed(color_of(sky.horizon), color_of(sky.zenith), 4096 - ((rest * rest) >> 12));
  }
  // The ground is soon reached: 1 - (1 - h)^8.
  const uint32_t square = (rest * rest) >> 12;
  const uint32_t fourth = (square * square) >> 12;
  return mixed(color_of(sky.horizon), color_of(sky.ground), 4096 - ((fourth * fourth) >> 12));
}

}  // namespace thimble::lit
