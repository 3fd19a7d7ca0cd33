// Clouds: they bend nothing, take light away, and are seen in what they take.
#include "../arithmetic.h"
#include "thimble/light/detail/pixel.h"

namespace thimble::lit {
namespace {

// Light within a cloud, from all around: the ambient one and half of what distant lights send.
void cloud_light(const Frame& frame, uint32_t (&light)[3]) {
  const bool lit = (frame.effects & Effect::kDirectLight) != 0;
  for (int i = 0; i < 3; ++i) {
    uint32_t sum = lit ? frame.scene.ambient_q8[i] : 256U;
    for (size_t number = 0; lit && number < frame.scene.lights.size; ++number) {
      sum += frame.scene.lights[number].is_point ? 0U : frame.scene.lights[number].color_q8[i] / 2U;
    }
    light[i] = sum < 1024 ? sum : 1024;
  }
}

}  // namespace

void scatter(const Frame& frame, const PendingRay& now, const Leg& leg, const Meeting& meeting,
             Weight* weight, Color* sum) {
  if (leg.medium.kind != Medium::kSolid || !meeting.found) {
    return;
  }
  const Surface surface = surface_of(frame, leg.medium.material);
  if (surface.kind != SurfaceKind::kMedia) {
    return;
  }
  const uint32_t length = stretch_q8(now.ray, leg, meeting);
  uint32_t light[3];
  cloud_light(frame, light);
  Weight taken;
  Color color;
  for (int i = 0; i < 3; ++i) {
    const uint16_t left = weighed(weight->c[i], left_q16(surface, i, length));
    taken.c[i] = static_cast<uint16_t>(weight->c[i] - left);
    weight->c[i] = left;
    const uint32_t channel = channel_of(surface.albedo, i) * light[i] / (256 / kLevel);
    color.c[i] = channel < kMaxChannel ? channel : kMaxChannel;
  }
  add(color, taken, sum);
}

}  // namespace thimble::lit
