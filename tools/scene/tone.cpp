#include "scene/tone.h"

#include <algorithm>

namespace thimble::tools {
namespace {

std::uint16_t two_thirds(std::uint16_t value) {
  return static_cast<std::uint16_t>((2U * value + 1) / 3);
}
Rgb8 two_thirds(Rgb8 color) {
  const auto one = [](std::uint8_t value) { return static_cast<std::uint8_t>((2U * value + 1) / 3); };
  return {one(color.r), one(color.g), one(color.b)};
}

}  // namespace

void dim(LitDescription* lighting, const UsedMaterials* used) {
  for (std::vector<Light>* const lights : {&lighting->lights, &lighting->lights_and_glow}) {
    for (Light& light : *lights) {
      for (PackedU16& channel : light.color_q8) {
        channel = two_thirds(channel);
      }
    }
  }
  LitScene& rest = lighting->rest;
  for (std::uint16_t& channel : rest.ambient_q8) {
    channel = two_thirds(channel);
  }
  for (std::size_t i = 0; i < lighting->surfaces.size(); ++i) {
    Surface& surface = lighting->surfaces[i];
    if (used != nullptr && !used->is[i]) {
      continue;
    }
    surface.emission_q8 = two_thirds(surface.emission_q8);
    if (surface.kind == SurfaceKind::kMedia) {
      surface.albedo = two_thirds(surface.albedo);
    }
  }
  rest.sky = {two_thirds(rest.sky.zenith), two_thirds(rest.sky.horizon), two_thirds(rest.sky.ground)};
  rest.fog.color = two_thirds(rest.fog.color);
}

void expose_light(std::uint32_t exposure_q8, const UsedMaterials& used, LitDescription* lighting) {
  const auto scaled = [exposure_q8](std::uint32_t value, std::uint32_t most) {
    return std::min((value * exposure_q8 + 128) >> 8, most);
  };
  const auto scale_16 = [&](std::uint16_t value) {
    return static_cast<std::uint16_t>(scaled(value, UINT16_MAX));
  };
  const auto scale_rgb = [&](Rgb8 color) {
    const auto one = [&](std::uint8_t value) { return static_cast<std::uint8_t>(scaled(value, 255)); };
    return Rgb8{one(color.r), one(color.g), one(color.b)};
  };
  for (std::vector<Light>* const lights : {&lighting->lights, &lighting->lights_and_glow}) {
    for (Light& light : *lights) {
      for (PackedU16& channel : light.color_q8) {
        channel = scale_16(channel);
      }
    }
  }
  LitScene& rest = lighting->rest;
  for (std::uint16_t& channel : rest.ambient_q8) {
    channel = scale_16(channel);
  }
  for (std::size_t i = 0; i < lighting->surfaces.size(); ++i) {
    Surface& surface = lighting->surfaces[i];
    if (used.is[i] && surface.kind == SurfaceKind::kEmit) {
      surface.emission_q8 = scale_16(surface.emission_q8);
    }
    if (used.is[i] && surface.kind == SurfaceKind::kMedia) {
      surface.albedo = scale_rgb(surface.albedo);
    }
  }
  rest.sky = {scale_rgb(rest.sky.zenith), scale_rgb(rest.sky.horizon), scale_rgb(rest.sky.ground)};
  rest.fog.color = scale_rgb(rest.fog.color);
}

}  // namespace thimble::tools
