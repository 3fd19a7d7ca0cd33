#include "gpu/scene_words.h"

#include <algorithm>
#include <cstdlib>

#include "gpu/kernel/cpp.h"
#include "thimble/light/host/asked.h"
#include "thimble/light/host/optics.h"

namespace thimble::gpu {
namespace {

using namespace kernel;
static_assert(kParameterWords == kWordsOfParameters);
static_assert(kDirectLight == Effect::kDirectLight && kShadows == Effect::kShadows &&
              kAmbientOcclusion == Effect::kAmbientOcclusion && kEmission == Effect::kEmission &&
              kSkyEffect == Effect::kSky && kSmoothNormals == Effect::kSmoothNormals);
static_assert(kEmits == static_cast<std::uint32_t>(SurfaceKind::kEmit));
static_assert(kPrimaryRay == static_cast<int>(LitRayKind::kPrimary) &&
              kShadowRay == static_cast<int>(LitRayKind::kShadow) &&
              kOcclusionRay == static_cast<int>(LitRayKind::kOcclusion));
static_assert(kSurfaces + kSurfaceWords * int{kMaxSurfaces} == kLights &&
              kLights + kLightWords * int{kMaxLights} == kParameterWords);

std::uint32_t packed(Rgb8 color) {
  return std::uint32_t{color.r} | std::uint32_t{color.g} << 8 | std::uint32_t{color.b} << 16;
}

// Bytes as words, the lowest byte first.
void append_bytes(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint32_t>* words) {
  const std::size_t first = words->size();
  words->resize(first + (size + 3) / 4);
  for (std::size_t i = 0; i < size; ++i) {
    (*words)[first + i / 4] |= std::uint32_t{bytes[i]} << (8 * (i % 4));
  }
}

std::uint32_t word_at(const CompactTree& tree, std::size_t at) {
  const std::uint8_t* bytes = tree.bytes() + at;
  return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8 | std::uint32_t{bytes[2]} << 16 |
         std::uint32_t{bytes[3]} << 24;
}

// src/FORMAT.md has the layout of the compact tree.
void set_octree(const CompactTree& tree, SceneWords* scene) {
  Parameters& to = scene->parameters;
  append_bytes(tree.bytes(), tree.size_bytes(), &scene->words);
  const std::uint32_t nodes = tree.node_count();
  const auto shift = static_cast<std::uint32_t>(tree.rank_shift());
  const std::uint32_t blocks = (nodes >> shift) + ((nodes & ((1U << shift) - 1)) != 0 ? 1U : 0U);
  to[kRankShift] = shift;
  to[kNodes] = nodes;
  to[kSolidBlocks] = word_at(tree, 20);
  to[kVoxelBits] = word_at(tree, 24);
  to[kMasks] = kCompactHeaderBytes;
  to[kRanks] = to[kMasks] + ((nodes + 3) & ~3U);
  std::uint32_t next = to[kRanks] + 4 * blocks;
  if (tree.merged()) {
    to[kMerged] = next;
    next += ((nodes + 31) >> 5) * 4;
  }
  if (tree.many_materials() && to[kSolidBlocks] != 0) {
    to[kBlockRanks] = next;
    next += 4 * blocks;
  }
  to[kMaterials] = next;
}

void set_direction(std::int32_t component, std::int32_t* largest) {
  *largest = std::max(*largest, std::abs(component));
}

}  // namespace

SceneWords make_scene_words(const CompactTree& tree) {
  SceneWords scene;
  scene.level = tree.level();
  Parameters& to = scene.parameters;
  for (int axis = 0; axis < 3; ++axis) {
    const auto place = static_cast<std::size_t>(axis);
    to[kLow + place] = static_cast<std::uint32_t>(tree.bounds().low[axis]);
    to[kHigh + place] = static_cast<std::uint32_t>(tree.bounds().high[axis]);
  }
  // A step crosses a plane of a cell or goes down a level: damaged bytes take no more of them.
  const std::uint32_t planes = 3 * (std::uint32_t{2} << tree.level()) + 1;
  to[kMostSteps] = planes * static_cast<std::uint32_t>(tree.level() + 1);
  to[kLevel] = static_cast<std::uint32_t>(tree.level());
  to[kManyMaterials] = tree.many_materials() ? 1 : 0;
  to[kUniformMaterial] = tree.uniform_material();
  scene.words.assign(kSceneTree, 0);
  set_octree(tree, &scene);
  return scene;
}

void set_palette(Span<const Rgb8> palette, std::uint32_t* words) {
  for (std::size_t i = 0; i < std::min<std::size_t>(palette.size, kSceneTree); ++i) {
    words[i] = packed(palette[i]);
  }
}

void set_frame(const Camera& camera, const Shading& shading, Parameters* parameters) {
  Parameters& to = *parameters;
  const auto set_wide = [&to](std::size_t at, std::int64_t value) {
    to[at] = static_cast<std::uint32_t>(value);
    to[at + 1] = static_cast<std::uint32_t>(static_cast<std::uint64_t>(value) >> 32);
  };
  to[kWidth] = static_cast<std::uint32_t>(camera.width_px());
  to[kHeight] = static_cast<std::uint32_t>(camera.height_px());
  to[kMode] = static_cast<std::uint32_t>(shading.mode);
  to[kPerspective] = camera.is_perspective() ? 1 : 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto place = static_cast<std::size_t>(axis);
    to[kEye + place] = static_cast<std::uint32_t>(camera.eye()[axis].raw);
    to[kDirection + place] = static_cast<std::uint32_t>(camera.direction()[axis]);
    set_wide(kBase + 2 * place, camera.affine().base[axis]);
    set_wide(kStepX + 2 * place, camera.affine().step_x[axis]);
    set_wide(kStepY + 2 * place, camera.affine().step_y[axis]);
    to[kFaceLight + 2 * place] = shading.face_light[2 * axis];
    to[kFaceLight + 2 * place + 1] = shading.face_light[2 * axis + 1];
  }
  to[kDepthPerT] = static_cast<std::uint32_t>(camera.depth_per_t_q8());
  to[kNear] = static_cast<std::uint32_t>(shading.near_q8);
  to[kFar] = static_cast<std::uint32_t>(shading.far_q8);
  to[kBackground] = packed(shading.background);
  to[kDefaultColor] = packed(shading.default_color);
  to[kPaletteSize] = static_cast<std::uint32_t>(std::min<std::size_t>(shading.palette.size, kSceneTree));
}

namespace {

std::uint32_t packed(int x, int y, int z) {
  return packed(
      Rgb8{static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(z)});
}

void set_vector(const Vec3i& vector, std::uint32_t* words) {
  for (int axis = 0; axis < 3; ++axis) {
    words[axis] = static_cast<std::uint32_t>(vector[axis]);
  }
}

// What a face gets without lights.
void set_shares(const LitFrame& frame, Parameters* parameters) {
  Parameters& to = *parameters;
  const bool is_lit = (frame.effects & Effect::kDirectLight) != 0;
  LitScene even;  // whose faces get their shares of a brightness of 1
  even.ambient_q8[0] = 256;
  const lit::Frame of{{}, frame.camera, frame.shading, even, {}, frame.effects};
  for (int face = 0; face < 6; ++face) {
    lit::Spot spot;
    spot.face = {face / 2, face % 2 == 0};
    lit::Color light;
    lit::ambient_light(of, spot, &light);
    to[kShare + static_cast<std::size_t>(face)] =
        is_lit ? light.c[0] / (lit::kFullLight / 256) : frame.shading.face_light[face];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    to[kStrength + i] = is_lit ? frame.scene.ambient_q8[i] : 256;
  }
}

void set_surfaces(const LitFrame& frame, std::uint32_t* words) {
  const Shading& shading = frame.shading;
  for (std::size_t material = 0; material < kMaxSurfaces; ++material, words += kSurfaceWords) {
    Surface surface;
    surface.albedo = material < shading.palette.size ? shading.palette[material] : shading.default_color;
    surface = material < frame.scene.surfaces.size ? frame.scene.surfaces[material] : surface;
    words[0] = packed(surface.albedo) | static_cast<std::uint32_t>(surface.kind) << 24;
    words[1] = surface.emission_q8;
  }
}

void set_lights(const LitScene& scene, std::uint32_t* words) {
  for (const Light& light : scene.lights) {
    set_vector(light.is_point ? Vec3i(light.place) : shorten(light.place), words);
    std::copy_n(light.color_q8, 3, words + 3);
    words[6] = light.is_point ? std::uint32_t{light.reach} : kDistant;
    words += kLightWords;
  }
}

void set_backdrop(const Backdrop& backdrop, Parameters* parameters) {
  Parameters& to = *parameters;
  to[kBackdrop] = backdrop.has_ground ? 2 : 1;
  to[kGround] = static_cast<std::uint32_t>(backdrop.ground_z);
  to[kGroundReach] = backdrop.reach;
  set_vector(backdrop.toward_sun, &to[kSun]);
  for (std::size_t i = 0; i < kAroundRays && backdrop.around != nullptr; ++i) {
    const Vec3i& direction = backdrop.around[i];
    to[kAround + i] = packed(direction.x, direction.y, direction.z);
  }
}

}  // namespace

void set_light(const LitFrame& frame, Parameters* parameters) {
  Parameters& to = *parameters;
  to[kMode] = kModeLit;
  to[kEffects] = frame.effects;
  set_shares(frame, parameters);
  to[kSky] = packed(frame.scene.sky.zenith);
  to[kSky + 1] = packed(frame.scene.sky.horizon);
  to[kSky + 2] = packed(frame.scene.sky.ground);
  const Occlusion& occlusion = frame.scene.occlusion;
  to[kOcclusionRays] =
      occlusion.reach == 0 ? 0 : std::min<std::uint32_t>(occlusion.rays, kOcclusionDirections);
  to[kOcclusionStrength] = occlusion.strength;
  to[kOcclusionReach] = occlusion.reach;
  for (std::size_t i = 0; i < kOcclusionDirections; ++i) {
    to[kPattern + i] = packed(kOcclusionPattern[i].x, kOcclusionPattern[i].y, kOcclusionPattern[i].z);
  }
  set_surfaces(frame, &to[kSurfaces]);
  to[kLightCount] = static_cast<std::uint32_t>(frame.scene.lights.size);
  set_lights(frame.scene, &to[kLights]);
  if (frame.backdrop != nullptr) {
    set_backdrop(*frame.backdrop, parameters);
  }
}

void set_places(std::uint32_t count, std::uint32_t width, Parameters* parameters) {
  Parameters& to = *parameters;
  to[kPlaces] = count;
  to[kWidth] = width;
  to[kHeight] = (count + width - 1) / width;
}

void set_rays(std::uint32_t count, std::uint32_t width, Parameters* parameters) {
  Parameters& to = *parameters;
  to[kMode] = kModeRays;
  to[kRayCount] = count;
  to[kWidth] = width;
  to[kHeight] = (count + width - 1) / width;
}

void set_record(const Ray& ray, std::uint32_t* record) {
  for (int axis = 0; axis < 3; ++axis) {
    record[axis] = static_cast<std::uint32_t>(ray.origin[axis].raw);
    record[3 + axis] = static_cast<std::uint32_t>(ray.direction[axis]);
  }
}

Hit hit_of_record(const std::uint32_t* record) {
  Hit hit;
  hit.kind = static_cast<HitKind>(record[0] & 255U);
  hit.axis = static_cast<std::int8_t>(static_cast<int>(record[0] >> 8 & 255U) - 1);
  hit.material = static_cast<std::uint8_t>(record[0] >> 16);
  hit.block_level = static_cast<std::uint8_t>(record[0] >> 24);
  for (int axis = 0; axis < 3; ++axis) {
    hit.voxel[axis] = static_cast<std::int32_t>(record[1 + axis]);
  }
  hit.t_numerator = static_cast<std::int32_t>(record[4]);
  hit.t_denominator = static_cast<std::int32_t>(record[5]);
  hit.visits = record[6];
  return hit;
}

// An affine function has its extremes in the corners.
Vec3i largest_direction(const Camera& camera) {
  Vec3i largest;
  for (int corner = 0; corner < 4; ++corner) {
    const Ray ray = camera.ray((corner & 1) != 0 ? camera.width_px() - 1 : 0,
                               (corner & 2) != 0 ? camera.height_px() - 1 : 0);
    for (int axis = 0; axis < 3; ++axis) {
      set_direction(ray.direction[axis], &largest[axis]);
    }
  }
  return largest;
}

Vec3i largest_direction(Span<const Ray> rays) {
  Vec3i largest;
  for (std::size_t i = 0; i < rays.size; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      set_direction(rays[i].direction[axis], &largest[axis]);
    }
  }
  return largest;
}

Vec3i largest_direction(const LitFrame& frame) {
  Vec3i largest = largest_direction(frame.camera);
  for (int axis = 0; axis < 3; ++axis) {
    // No other direction of a pattern is longer, but those that are turned to a slope.
    set_direction((frame.effects & Effect::kSmoothNormals) != 0 ? kMaxShort : kOcclusionLength,
                  &largest[axis]);
    if (frame.backdrop != nullptr) {
      set_direction(frame.backdrop->toward_sun[axis], &largest[axis]);
    }
    for (const Light& light : frame.scene.lights) {
      set_direction(light.is_point ? kMaxShort : shorten(light.place)[axis], &largest[axis]);
    }
  }
  return largest;
}

bool needs_pairs(int level, const Vec3i& largest_direction) {
  std::int64_t components[3] = {largest_direction.x, largest_direction.y, largest_direction.z};
  std::sort(components, components + 3);
  return (components[1] + components[2]) << (level + 8) >= std::int64_t{1} << 32;
}

}  // namespace thimble::gpu
