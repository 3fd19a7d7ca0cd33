#include "readers/vox_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace thimble::tools {

namespace {

constexpr double kUnbounded = std::numeric_limits<double>::max();

/// `value` between `low` and `high`; `fallback` where there is none or it is NaN.
double in_range(std::optional<double> value, double low, double high, double fallback) {
  return value && !std::isnan(*value) ? std::clamp(*value, low, high) : fallback;
}

/// Material ids are colour indices; newer files count 1 to 256, older ones 0 to 255, and both ends mean the
/// unused entry.
Material& material_of(std::int32_t id, const ByteReader& chunk, Palette& palette) {
  if (id < 0 || id > 256) {
    chunk.fail("material ", id, " is outside 0 to 256");
  }
  return palette[static_cast<std::size_t>(id) & 0xff];
}

}  // namespace

Palette vox_default_palette() {
  Palette palette{};
  std::size_t next = 1;
  // A cube of six levels an axis, white first, blue fastest; its last colour, black, is left to the ramps.
  const auto level = [](int step) { return static_cast<std::uint8_t>(255 - 51 * step); };
  for (int red = 0; red < 6; ++red) {
    for (int green = 0; green < 6; ++green) {
      for (int blue = 0; blue < 6; ++blue) {
        palette[next++].color = {level(red), level(green), level(blue)};
      }
    }
  }
  --next;
  // Ramps of red, green, blue and grey through the multiples of 17 that the cube does not have.
  for (int ramp = 0; ramp < 4; ++ramp) {
    for (int step = 14; step >= 1; --step) {
      if (step % 3 == 0) {
        continue;
      }
      const auto value = static_cast<std::uint8_t>(17 * step);
      const auto channel = [&](int own) { return ramp == own || ramp == 3 ? value : std::uint8_t{0}; };
      palette[next++].color = {channel(0), channel(1), channel(2)};
    }
  }
  return palette;
}

void vox_read_rgba(ByteReader& chunk, Palette& palette) {
  for (std::size_t index = 1; index < palette.size() && (index == 1 || chunk.remaining() != 0); ++index) {
    Material& material = palette[index];
    material.color.r = chunk.u8();
    material.color.g = chunk.u8();
    material.color.b = chunk.u8();
    material.alpha = chunk.u8();
  }
}

void vox_read_matt(ByteReader& chunk, Palette& palette) {
  Material& material = material_of(chunk.i32(), chunk, palette);
  constexpr std::array kKinds{SurfaceKind::kDiffuse, SurfaceKind::kMetal, SurfaceKind::kGlass,
                              SurfaceKind::kEmit};
  const std::uint32_t kind = chunk.u32();
  if (kind < kKinds.size()) {
    material.kind = kKinds[kind];
  }
  material.weight = in_range(static_cast<double>(chunk.f32()), 0, 1, material.weight);
  const std::uint32_t present = chunk.u32();
  // Bits: 0 plastic, 1 roughness, 2 specular, 3 index of refraction, 4 attenuation, 5 power, 6 glow, 7 "power
  // is total". Only bit 7 comes with or without a value, and being last it does not move the others.
  for (unsigned bit = 0; bit < 7; ++bit) {
    if ((present >> bit & 1u) == 0) {
      continue;
    }
    const double value = static_cast<double>(chunk.f32());
    switch (bit) {
      case 1:
        material.roughness = in_range(value, 0, 1, material.roughness);
        break;
      case 2:
        material.specular = in_range(value, 0, 1, material.specular);
        break;
      case 3:  // stored as what exceeds 1
        material.ior = 1 + in_range(value, 0, kUnbounded, material.ior - 1);
        break;
      case 4:
        material.attenuation = in_range(value, 0, kUnbounded, material.attenuation);
        break;
      case 5:
        material.flux = in_range(value, 0, kUnbounded, material.flux);
        break;
      case 6:
        material.emission = in_range(value, 0, 1, material.emission);
        break;
      default:  // plastic only says that the specular layer is there
        break;
    }
  }
}

void vox_read_matl(ByteReader& chunk, Palette& palette) {
  Material& material = material_of(chunk.i32(), chunk, palette);
  // Newer names win over older ones for the same thing, whatever their order: `_ri` is the index itself,
  // `_ior` what exceeds 1; `_d` became `_density`, and `_alpha` `_trans`.
  std::optional<double> ior_excess, ior, old_density, density, old_transparency, transparency;
  vox_dictionary(chunk, [&](std::string_view key, std::string_view text) {
    if (key == "_type") {
      material.kind = text == "_metal"   ? SurfaceKind::kMetal
                      : text == "_glass" ? SurfaceKind::kGlass
                      : text == "_emit"  ? SurfaceKind::kEmit
                      : text == "_media" ? SurfaceKind::kMedia
                                         : SurfaceKind::kDiffuse;
      return;
    }
    const std::optional<double> value = vox_number<double>(text);
    if (!value || std::isnan(*value)) {
      return;
    }
    if (key == "_weight") {
      material.weight = in_range(value, 0, 1, material.weight);
    } else if (key == "_rough") {
      material.roughness = in_range(value, 0, 1, material.roughness);
    } else if (key == "_spec" || key == "_sp") {
      material.specular = in_range(value, 0, 1, material.specular);
    } else if (key == "_ior") {
      ior_excess = value;
    } else if (key == "_ri") {
      ior = value;
    } else if (key == "_att") {
      material.attenuation = in_range(value, 0, kUnbounded, material.attenuation);
    } else if (key == "_flux") {
      material.flux = in_range(value, 0, kUnbounded, material.flux);
    } else if (key == "_emit") {
      material.emission = in_range(value, 0, 1, material.emission);
    } else if (key == "_d") {
      old_density = value;
    } else if (key == "_density") {
      density = value;
    } else if (key == "_metal") {
      material.metalness = in_range(value, 0, 1, material.metalness);
    } else if (key == "_alpha") {
      old_transparency = value;
    } else if (key == "_trans") {
      transparency = value;
    }
  });
  if (ior || ior_excess) {
    material.ior = in_range(ior ? *ior : 1 + *ior_excess, 1, kUnbounded, material.ior);
  }
  material.density = in_range(density ? density : old_density, 0, kUnbounded, material.density);
  material.transparency =
      in_range(transparency ? transparency : old_transparency, 0, 1, material.transparency);
}

}  // namespace thimble::tools
