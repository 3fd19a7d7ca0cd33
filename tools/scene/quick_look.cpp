#include "scene/quick_look.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace thimble::tools {
namespace {

double mean(const PackedU16 (&channels)[3]) {
  return (channels[0] + channels[1] + channels[2]) / 3.0;
}

}  // namespace

void quick_light(const LitScene& scene, std::uint16_t (&face_light)[6]) {
  constexpr double kLamps = 100;
  double lights[6];
  for (int face = 0; face < 6; ++face) {
    double& light = lights[face];
    light = (scene.ambient_q8[0] + scene.ambient_q8[1] + scene.ambient_q8[2]) / 3.0;
    bool has_lamps = scene.lights.size == 0;
    for (const Light& each : scene.lights) {
      const Vec3i place = each.place;
      const double length = std::hypot(static_cast<double>(place.x), place.y, place.z);
      const double along = (face % 2 == 0 ? -1.0 : 1.0) * place[face / 2];
      has_lamps = has_lamps || each.is_point;
      light += each.is_point || length == 0 ? 0 : std::max(0.0, along / length) * mean(each.color_q8);
    }
    light += has_lamps ? kLamps : 0;
  }
  const double most = std::max(256.0, *std::max_element(std::begin(lights), std::end(lights)));
  std::transform(std::begin(lights), std::end(lights), std::begin(face_light),
                 [most](double light) { return static_cast<std::uint16_t>(256 * light / most); });
}

ToneTable quick_tone(const Look& look, std::uint32_t exposure_q8) {
  return tone_table(exposure_q8 * (look.has_backdrop ? 7U : 8U) / 8);
}

QuickLook quick_look(const Look& look, const ToneTable& tone) {
  QuickLook quick{};
  quick_light(look.lit_scene(), quick.face_light);
  const unsigned most =
      std::max<unsigned>(1, *std::max_element(std::begin(quick.face_light), std::end(quick.face_light)));
  for (std::uint16_t& light : quick.face_light) {
    light = static_cast<std::uint16_t>(256U * light / most);
  }
  const auto toned = [&](std::uint8_t channel) { return tone[channel * most / 256]; };
  for (const Rgb8 color : look.palette) {
    quick.palette.push_back({toned(color.r), toned(color.g), toned(color.b)});
  }
  return quick;
}

}  // namespace thimble::tools
