/// What must hold for any bytes whatever that are handed over as a baked scene: used by the tests and by the
/// fuzz target.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "support/compact_damage.h"
#include "thimble/bake/baked_scene.h"
#include "thimble/light/map_render.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"

namespace thimble::tests {

/// What opens of a lighting section keeps every limit of light/scene.h.
inline const char* use_lighting(const BakedLighting& lighting, int level) {
  const LitScene& scene = lighting.scene;
  const std::int32_t side = 1 << level;
  if ((lighting.effects & ~Effect::kAll) != 0 || scene.surfaces.size > kMaxSurfaces ||
      scene.lights.size > kMaxLights || scene.bounces > kMaxBounces) {
    return "lighting beyond its limits";
  }
  const auto sound = [](const Surface& surface) {
    return surface.kind <= SurfaceKind::kMedia && surface.index_q12 >= kMinIndexQ12 &&
           surface.index_q12 <= kMaxIndexQ12;
  };
  for (const Surface& surface : scene.surfaces) {
    if (!sound(surface)) {
      return "a surface beyond its limits";
    }
  }
  for (const Light& light : scene.lights) {
    if (light.reach == 0 || (!light.is_point && light.place == PackedVec3i())) {
      return "a light beyond its limits";
    }
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t at = light.place[axis];
      if (light.is_point ? at < -4 * 256 * side || at > 5 * 256 * side
                         : at < -kMaxLightComponent || at > kMaxLightComponent) {
        return "a light beyond its limits";
      }
    }
  }
  const WaterSurface& water = scene.water;
  if (!sound(scene.water_material) || water.heights_q16 != nullptr || water.corner.x < 0 ||
      water.corner.y < 0 || water.corner.z < 0 || water.corner.x + water.width > side ||
      water.corner.y + water.depth > side || water.highest_q8 < 0 ||
      water.highest_q8 > (side - water.corner.z) * 256 || scene.has_water != (water.width > 0)) {
    return "water beyond its limits";
  }
  return nullptr;
}

/// Draws a few pixels by the scene's brick map, of either version and maybe damaged, in as many bytes as it has.
inline const char* draw_by_damaged_map(const BakedScene& scene) {
  const ConstBytes section = scene.section(SectionKind::kBrickMap);
  const std::unique_ptr<std::uint8_t[]> own(new std::uint8_t[section.size]);
  std::copy(section.begin(), section.end(), own.get());
  const ConstBytes bytes{own.get(), section.size};
  const char* const fault = BrickMap::validate(bytes);
  BrickMap map;
  if (BrickMap::open(bytes, &map) != Status::kOk) {
    return fault == nullptr ? "a map that does not open is valid" : nullptr;
  }
  constexpr std::int32_t kWidth = 9;
  constexpr std::int32_t kHeight = 7;
  Camera camera;
  if (!scene.has_camera() ||
      set_camera(scene.camera(), kWidth, kHeight, scene.tree().level(), &camera) != Status::kOk) {
    return nullptr;
  }
  std::uint8_t pixels[kWidth * kHeight];
  RenderCounts counts;
  const Status status = render_band(scene.tree(), map, camera, Shading(),
                                    {{pixels, sizeof pixels}, PixelFormat::kGray8, 0, 0, kHeight}, &counts);
  const bool is_ours = map.belongs_to(scene.tree());
  if (status != (is_ours ? Status::kOk : Status::kDamaged) || counts.rays != (is_ours ? sizeof pixels : 0)) {
    return "a frame by a map is not drawn, or by one of another tree";
  }
  return nullptr;
}

/// Draws a few pixels in the scene's light, without its brick map and with it: all effects, and those that go through the
/// map.
inline const char* draw_damaged_light(const BakedScene& scene, const BakedLighting& lighting) {
  constexpr std::int32_t kWidth = 9;
  constexpr std::int32_t kHeight = 7;
  constexpr LitOptions kOptions{3000, true};
  Camera camera;
  if (!scene.has_camera() ||
      set_camera(scene.camera(), kWidth, kHeight, scene.tree().level(), &camera) != Status::kOk) {
    return nullptr;
  }
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = scene.palette();
  std::uint8_t pixels[3 * kWidth * kHeight];
  const Band band{{pixels, sizeof pixels}, PixelFormat::kRgb888, 0, 0, kHeight};
  BrickMap map;
  const bool has_map = BrickMap::open(scene.section(SectionKind::kBrickMap), &map) == Status::kOk;
  for (const EffectSet effects :
       {lighting.effects, lighting.effects & (Effect::kDirectLight | Effect::kShadows | Effect::kSky)}) {
    LitCounts counts;
    const Status status =
        render_lit_band(effects, scene.tree(), camera, shading, lighting.scene, band, &counts, kOptions);
    if (status == Status::kOk && counts.rays[0] < kWidth * kHeight) {
      return "pixels in light were left out";
    }
    if (!has_map) {
      continue;
    }
    const Status by_map = render_lit_band(effects, scene.tree(), map, camera, shading, lighting.scene, {},
                                          band, nullptr, kOptions);
    if (by_map != (map.belongs_to(scene.tree()) ? status : Status::kDamaged)) {
      return "light by a map has another status";
    }
  }
  return nullptr;
}

/// Opens `bytes` and does with the scene what a program may do: reads every section, makes the camera, traces
/// rays through the tree, draws by the brick map and in light. Returns a phrase when a promise is broken, else nullptr. Reads outside the bytes
/// are for AddressSanitizer to see, so `bytes` should end where their memory ends.
inline const char* use_damaged(ConstBytes bytes, const Vec3i& direction) {
  const char* fault = BakedScene::validate(bytes);
  BakedScene scene;
  if (BakedScene::open(bytes, &scene) != Status::kOk) {
    return fault == nullptr ? "what does not open is valid" : nullptr;
  }
  if (scene.validate() != (fault == nullptr ? Status::kOk : Status::kDamaged)) {
    return "the two validate differ";
  }
  std::uint32_t sum = 0;
  for (std::uint32_t kind = 0; kind < 8; ++kind) {
    for (const std::uint8_t byte : scene.section(static_cast<SectionKind>(kind))) {
      sum += byte;
    }
  }
  for (const Rgb8& color : scene.palette()) {
    sum += color.g;
  }
  if (scene.bytes().size > bytes.size || scene.palette().size > kMaxPaletteColors || sum == UINT32_MAX) {
    return "more than there is";
  }
  BakedLighting lighting;
  lighting.effects = UINT32_MAX;
  if (BakedLighting::open(scene.section(SectionKind::kLighting), scene.tree().level(), &lighting) ==
      Status::kOk) {
    if (const char* text = use_lighting(lighting, scene.tree().level())) {
      return text;
    }
    if (const char* text = draw_damaged_light(scene, lighting)) {
      return text;
    }
  } else if (lighting.effects != UINT32_MAX) {
    return "lighting that is refused was changed";
  }
  if (const char* text = draw_by_damaged_map(scene)) {
    return text;
  }
  if (scene.has_camera()) {
    Camera camera;
    // Square and one pixel: only what is wrong with the view itself could be refused.
    const Status status = set_camera(scene.camera(), 1, 1, scene.tree().level(), &camera);
    if (status == Status::kBadArgument) {
      return "a camera that makes no view";
    }
    if (status == Status::kOk) {
      if (const char* text = trace_damaged(scene.tree(), camera.ray(0, 0))) {
        return text;
      }
    }
  }
  const std::int32_t half = Q8::kOne << scene.tree().level() >> 1;
  Ray ray;
  for (int axis = 0; axis < 3; ++axis) {
    ray.direction[axis] = direction[axis] % (kMaxDirection + 1);
    ray.origin[axis] = Q8::from_raw(half - (ray.direction[axis] > 0 ? 3 * half : -3 * half));
  }
  if (check_ray(ray, scene.tree().level()) != Status::kOk) {
    return nullptr;  // no direction
  }
  return trace_damaged(scene.tree(), ray);
}

/// Puts the right checksums into a baked scene, into its tree where it has one that opens, and into its brick map of
/// either version, which then belongs to that tree; for damage that they are not to catch. Bytes shorter than a header
/// stay.
inline void repair_baked_checksums(Bytes bytes) {
  constexpr std::size_t kChecksumOffset = 8;
  BakedScene scene;
  if (BakedScene::open(bytes, &scene) == Status::kOk) {
    const auto own = [&](ConstBytes part) {
      return bytes.subspan(static_cast<std::size_t>(part.data - bytes.data), part.size);
    };
    const Bytes tree = own({scene.tree().bytes(), scene.tree().size_bytes()});
    repair_checksum(tree);
    const ConstBytes map = scene.section(SectionKind::kBrickMap);
    if (map.size >= kBrickMapHeaderBytes) {
      std::copy_n(tree.data + 12, 4, own(map).data + 16);
      repair_checksum(own(map));
    }
  }
  if (bytes.size < kBakedHeaderBytes) {
    return;
  }
  const std::size_t said = static_cast<std::size_t>(bytes[4]) | static_cast<std::size_t>(bytes[5]) << 8 |
                           static_cast<std::size_t>(bytes[6]) << 16 |
                           static_cast<std::size_t>(bytes[7]) << 24;
  const ConstBytes all = bytes.subspan(0, said);
  const std::uint32_t checksum =
      crc32(all.subspan(kChecksumOffset + 4), crc32(all.subspan(0, kChecksumOffset)));
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[kChecksumOffset + i] = static_cast<std::uint8_t>(checksum >> (8 * i));
  }
}

}  // namespace thimble::tests
