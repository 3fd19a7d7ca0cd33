// The section of a baked scene that says what light does: checking, opening, writing. src/FORMAT.md is the
// specification; the offsets below are its constants.
#include "thimble/light/scene.h"

#include "../base/bits.h"
#include "../base/fault.h"
#include "thimble/trace/ray.h"

namespace thimble {
namespace {

constexpr uint32_t kVersion = 0;
constexpr uint32_t kFlags = 1;
constexpr uint32_t kBounces = 2;
constexpr uint32_t kOcclusionRays = 3;
constexpr uint32_t kOcclusionStrength = 4;
constexpr uint32_t kNothing = 5;  // 0
constexpr uint32_t kOcclusionReach = 6;
constexpr uint32_t kEffects = 8;
constexpr uint32_t kAmbient = 12;
constexpr uint32_t kZenith = 18;
constexpr uint32_t kHorizon = 21;
constexpr uint32_t kGround = 24;
constexpr uint32_t kFogColor = 27;
constexpr uint32_t kFogDensity = 30;
constexpr uint32_t kWaterCorner = 34;
constexpr uint32_t kWaterWidth = 40;
constexpr uint32_t kWaterDepth = 42;
constexpr uint32_t kWaterHeight = 44;
constexpr uint32_t kWaterMaterial = 48;
constexpr uint32_t kSurfaceCount = 60;
constexpr uint32_t kLightCount = 62;
static_assert(kLightCount + 2 == kLightingHeadBytes);

constexpr unsigned kHasShadows = 1;
constexpr unsigned kHasSky = 2;
constexpr unsigned kHasDepthCue = 4;
constexpr unsigned kHasWater = 8;
constexpr unsigned kAllFlags = 15;

// A surface and a light; what the structs of scene.h look like in memory.
constexpr uint32_t kKind = 3;
constexpr uint32_t kIndex = 6;
constexpr uint32_t kSurfaceBytes = 12;
constexpr uint32_t kIsPoint = 0;
constexpr uint32_t kPlace = 1;
constexpr uint32_t kColor = 13;
constexpr uint32_t kReach = 19;
constexpr uint32_t kLightBytes = 21;
static_assert(sizeof(Surface) == kSurfaceBytes && sizeof(Light) == kLightBytes);
static_assert(offsetof(Surface, kind) == kKind && offsetof(Surface, index_q12) == kIndex);
static_assert(offsetof(Light, is_point) == kIsPoint && offsetof(Light, place) == kPlace &&
              offsetof(Light, color_q8) == kColor && offsetof(Light, reach) == kReach);
static_assert(sizeof(bool) == 1);

bool is_surface(const uint8_t* bytes) {
  const uint32_t index = bits::load16(bytes + kIndex);
  return bytes[kKind] <= static_cast<uint8_t>(SurfaceKind::kMedia) && index >= kMinIndexQ12 &&
         index <= kMaxIndexQ12;
}

bool is_light(const uint8_t* bytes, int level) {
  if (bytes[kIsPoint] > 1 || bits::load16(bytes + kReach) == 0) {
    return false;
  }
  const bool is_point = bytes[kIsPoint] == 1;
  const int32_t side = Q8::kOne << level;
  const int32_t least = is_point ? kMinOriginWorlds * side : -kMaxLightComponent;
  const int32_t most = is_point ? kMaxOriginWorlds * side : kMaxLightComponent;
  bool is_zero = true;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const int32_t component = static_cast<int32_t>(bits::load32(bytes + kPlace + 4 * axis));
    if (component < least || component > most) {
      return false;
    }
    is_zero = is_zero && component == 0;
  }
  return is_point || !is_zero;
}

// Columns within the world, up to its top.
bool is_water(const uint8_t* bytes, int level) {
  const uint32_t side = uint32_t{1} << level;
  const uint32_t x = bits::load16(bytes + kWaterCorner);
  const uint32_t y = bits::load16(bytes + kWaterCorner + 2);
  const uint32_t z = bits::load16(bytes + kWaterCorner + 4);
  const uint32_t width = bits::load16(bytes + kWaterWidth);
  const uint32_t depth = bits::load16(bytes + kWaterDepth);
  return width != 0 && depth != 0 && x + width <= side && y + depth <= side && z < side &&
         bits::load32(bytes + kWaterHeight) <= (side - z) << 8;
}

bool is_occlusion(uint32_t rays) {
  return rays == 0 || rays == 4 || rays == 8 || rays == 16 || rays == 32;
}

Rgb8 load_color(const uint8_t* bytes) {
  return {bytes[0], bytes[1], bytes[2]};
}
void store_color(uint8_t* bytes, Rgb8 color) {
  bytes[0] = color.r;
  bytes[1] = color.g;
  bytes[2] = color.b;
}

void store_surface(uint8_t* to, const Surface& surface) {
  store_color(to, surface.albedo);
  to[3] = static_cast<uint8_t>(surface.kind);
  to[4] = surface.roughness;
  to[5] = surface.mirror;
  bits::store16(to + 6, surface.index_q12);
  bits::store16(to + 8, surface.density_q8);
  bits::store16(to + 10, surface.emission_q8);
}

void store_light(uint8_t* to, const Light& light) {
  to[kIsPoint] = light.is_point ? 1 : 0;
  for (int axis = 0; axis < 3; ++axis) {
    bits::store32(to + kPlace + 4 * axis, static_cast<uint32_t>(light.place[axis]));
    bits::store16(to + kColor + 2 * axis, light.color_q8[axis]);
  }
  bits::store16(to + kReach, light.reach);
}

}  // namespace

const char* BakedLighting::validate(ConstBytes section, int level, uint32_t* place) {
  const uint8_t* base = section.data;
  if (section.size < kLightingHeadBytes) {
    return fault(place, 0, "lighting shorter than its head");
  }
  if (base[kVersion] != kLightingVersion) {
    return fault(place, kVersion, kAnotherVersion);
  }
  const uint32_t surfaces = bits::load16(base + kSurfaceCount);
  const uint32_t lights = bits::load16(base + kLightCount);
  if (surfaces > kMaxSurfaces || lights > kMaxLights ||
      section.size != kLightingHeadBytes + kSurfaceBytes * surfaces + kLightBytes * lights) {
    return fault(place, kSurfaceCount, "surfaces and lights that are not as many as there are bytes");
  }
  if (base[kFlags] > kAllFlags || base[kBounces] > kMaxBounces || !is_occlusion(base[kOcclusionRays]) ||
      base[kNothing] != 0 || (bits::load32(base + kEffects) & ~Effect::kAll) != 0) {
    return fault(place, kFlags, "lighting with a flag or number that does not exist");
  }
  if ((base[kFlags] & kHasWater) != 0 && !is_water(base, level)) {
    return fault(place, kWaterCorner, "water outside the world");
  }
  if (!is_surface(base + kWaterMaterial)) {
    return fault(place, kWaterMaterial, "a surface beyond its limits");
  }
  uint32_t at = kLightingHeadBytes;
  for (uint32_t i = 0; i < surfaces; ++i, at += kSurfaceBytes) {
    if (!is_surface(base + at)) {
      return fault(place, at, "a surface beyond its limits");
    }
  }
  for (uint32_t i = 0; i < lights; ++i, at += kLightBytes) {
    if (!is_light(base + at, level)) {
      return fault(place, at, "a light beyond its limits");
    }
  }
  return nullptr;
}

Status BakedLighting::open(ConstBytes section, int level, BakedLighting* lighting) {
  if (validate(section, level) != nullptr) {
    return Status::kDamaged;
  }
  const uint8_t* base = section.data;
  const uint32_t surfaces = bits::load16(base + kSurfaceCount);
  const uint32_t lights = bits::load16(base + kLightCount);
  // Both are made of bytes, without padding, and every value that their types cannot hold has been refused.
  const uint8_t* tables = base + kLightingHeadBytes;
  lighting->effects = bits::load32(base + kEffects);
  LitScene& scene = lighting->scene;
  scene.surfaces = {reinterpret_cast<const Surface*>(tables), surfaces};
  scene.lights = {reinterpret_cast<const Light*>(tables + kSurfaceBytes * surfaces), lights};
  for (uint32_t channel = 0; channel < 3; ++channel) {
    scene.ambient_q8[channel] = static_cast<uint16_t>(bits::load16(base + kAmbient + 2 * channel));
  }
  scene.has_shadows = (base[kFlags] & kHasShadows) != 0;
  scene.has_sky = (base[kFlags] & kHasSky) != 0;
  scene.has_depth_cue = (base[kFlags] & kHasDepthCue) != 0;
  scene.sky = {load_color(base + kZenith), load_color(base + kHorizon), load_color(base + kGround)};
  scene.fog = {load_color(base + kFogColor), bits::load32(base + kFogDensity)};
  scene.occlusion.rays = base[kOcclusionRays];
  scene.occlusion.strength = base[kOcclusionStrength];
  scene.occlusion.reach = static_cast<uint16_t>(bits::load16(base + kOcclusionReach));
  scene.has_water = (base[kFlags] & kHasWater) != 0;
  scene.water = WaterSurface{};
  if (scene.has_water) {
    const auto word = [&](uint32_t at) { return static_cast<int32_t>(bits::load16(base + at)); };
    scene.water =
        still_water({word(kWaterCorner), word(kWaterCorner + 2), word(kWaterCorner + 4)}, word(kWaterWidth),
                    word(kWaterDepth), static_cast<int32_t>(bits::load32(base + kWaterHeight)));
  }
  scene.water_material = *reinterpret_cast<const Surface*>(base + kWaterMaterial);
  scene.bounces = base[kBounces];
  return Status::kOk;
}

size_t lighting_bytes(const LitScene& scene) {
  if (scene.surfaces.size > kMaxSurfaces || scene.lights.size > kMaxLights) {
    return 0;
  }
  return kLightingHeadBytes + kSurfaceBytes * scene.surfaces.size + kLightBytes * scene.lights.size;
}

Status BakedLighting::make(const BakedLighting& lighting, int level, Bytes to) {
  const LitScene& scene = lighting.scene;
  const size_t size = lighting_bytes(scene);
  if (size == 0) {
    return Status::kBadArgument;
  }
  if (to.size < size) {
    return Status::kOutOfMemory;
  }
  uint8_t* base = to.data;
  for (size_t i = 0; i < kLightingHeadBytes; ++i) {
    base[i] = 0;
  }
  base[kVersion] = kLightingVersion;
  base[kFlags] =
      static_cast<uint8_t>((scene.has_shadows ? kHasShadows : 0U) | (scene.has_sky ? kHasSky : 0U) |
                           (scene.has_depth_cue ? kHasDepthCue : 0U) | (scene.has_water ? kHasWater : 0U));
  base[kBounces] = scene.bounces;
  base[kOcclusionRays] = scene.occlusion.rays;
  base[kOcclusionStrength] = scene.occlusion.strength;
  bits::store16(base + kOcclusionReach, scene.occlusion.reach);
  bits::store32(base + kEffects, lighting.effects);
  for (uint32_t channel = 0; channel < 3; ++channel) {
    bits::store16(base + kAmbient + 2 * channel, scene.ambient_q8[channel]);
  }
  store_color(base + kZenith, scene.sky.zenith);
  store_color(base + kHorizon, scene.sky.horizon);
  store_color(base + kGround, scene.sky.ground);
  store_color(base + kFogColor, scene.fog.color);
  bits::store32(base + kFogDensity, scene.fog.density_q16);
  if (scene.has_water) {
    const WaterSurface& water = scene.water;
    const int32_t numbers[] = {water.corner.x, water.corner.y, water.corner.z, water.width, water.depth};
    for (uint32_t i = 0; i < 5; ++i) {
      if (numbers[i] < 0 || numbers[i] > 0xFFFF) {
        return Status::kBadArgument;
      }
      bits::store16(base + kWaterCorner + 2 * i, static_cast<uint32_t>(numbers[i]));
    }
    bits::store32(base + kWaterHeight, static_cast<uint32_t>(water.highest_q8));
  }
  store_surface(base + kWaterMaterial, scene.water_material);
  bits::store16(base + kSurfaceCount, static_cast<uint32_t>(scene.surfaces.size));
  bits::store16(base + kLightCount, static_cast<uint32_t>(scene.lights.size));
  uint8_t* at = base + kLightingHeadBytes;
  for (const Surface& surface : scene.surfaces) {
    store_surface(at, surface);
    at += kSurfaceBytes;
  }
  for (const Light& light : scene.lights) {
    store_light(at, light);
    at += kLightBytes;
  }
  return validate({base, size}, level) == nullptr ? Status::kOk : Status::kBadArgument;
}

}  // namespace thimble
