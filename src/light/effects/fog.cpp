// The air: on its way light halves with the distance and takes on the fog's colour.
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {
namespace {

// A ray that leaves the world passes the air above it: as far as to the height of one world, at most
// so many worlds.
constexpr uint32_t kWorldsOfAir = 4;

uint32_t way_out_q8(const Frame& frame, const Vec3i& direction) {
  const uint32_t side_q8 = uint32_t{256} << frame.tree.level();
  const uint32_t longest_q8 = side_q8 * kWorldsOfAir;
  if (direction.z <= 0) {
    return longest_q8;
  }
  const uint32_t sine = cosine_q14(direction, 2);
  const uint32_t least = kUnitQ14 / kWorldsOfAir;
  return sine <= least ? longest_q8 : (side_q8 << 8) / (sine >> 6);  // 2^28 by 6 to 8 bits
}

}  // namespace

void fade_in_fog(const Frame& frame, const Ray& ray, const Leg& leg, const Meeting& meeting, Weight* weight,
                 Color* sum) {
  if (leg.medium.kind != Medium::kAir) {
    return;
  }
  const uint32_t length = meeting.found ? stretch_q8(ray, leg, meeting) : way_out_q8(frame, ray.direction);
  const uint32_t density = frame.scene.fog.density_q16;
  constexpr uint32_t kMostDensity = 1U << 24;
  const uint32_t halvings = halvings_q16(density < kMostDensity ? density : kMostDensity, length);
  Weight taken = *weight;
  const uint32_t left = transmittance_q16(halvings);
  for (int i = 0; i < 3; ++i) {
    weight->c[i] = weighed(weight->c[i], left);
    taken.c[i] = static_cast<uint16_t>(taken.c[i] - weight->c[i]);
  }
  add(color_of(frame.scene.fog.color), taken, sum);
}

}  // namespace thimble::lit
