#include "gpu/frame_words.h"

#include "gpu/kernel/parameters.h"
#include "thimble/light/host/asked.h"
#include "thimble/light/host/optics.h"

namespace thimble::gpu {
namespace {

using namespace kernel;
static_assert(4 * kParameterWords == sizeof(Parameters));
static_assert(kDirectLight == Effect::kDirectLight && kShadows == Effect::kShadows &&
              kAmbientOcclusion == Effect::kAmbientOcclusion && kEmission == Effect::kEmission &&
              kSkyEffect == Effect::kSky && kSmoothNormals == Effect::kSmoothNormals);
static_assert(kEmits == static_cast<uint32_t>(SurfaceKind::kEmit));
static_assert(kPrimaryRay == static_cast<int>(LitRayKind::kPrimary) &&
              kShadowRay == static_cast<int>(LitRayKind::kShadow) &&
              kOcclusionRay == static_cast<int>(LitRayKind::kOcclusion));
static_assert(kSurfaces + kSurfaceWords * int{kMaxSurfaces} == kLights &&
              kLights + kLightWords * int{kMaxLights} == kParameterWords);

uint32_t packed(Rgb8 color) {
  return uint32_t{color.r} | uint32_t{color.g} << 8 | uint32_t{color.b} << 16;
}

uint32_t word_at(const CompactTree& tree, size_t at) {
  const uint8_t* bytes = tree.bytes() + at;
  return uint32_t{bytes[0]} | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[3]} << 24;
}

void set_vector(const Vec3i& vector, uint32_t* words) {
  for (int axis = 0; axis < 3; ++axis) {
    words[axis] = static_cast<uint32_t>(vector[axis]);
  }
}

}  // namespace

// src/FORMAT.md has the layout of the compact tree.
void set_tree(const CompactTree& tree, Parameters* parameters) {
  Parameters& to = *parameters;
  set_vector(tree.bounds().low, &to[kLow]);
  set_vector(tree.bounds().high, &to[kHigh]);
  // A step crosses a plane of a cell or goes down a level: damaged bytes take no more of them.
  const uint32_t planes = 3 * (uint32_t{2} << tree.level()) + 1;
  to[kMostSteps] = planes * static_cast<uint32_t>(tree.level() + 1);
  to[kLevel] = static_cast<uint32_t>(tree.level());
  to[kManyMaterials] = tree.many_materials() ? 1 : 0;
  to[kUniformMaterial] = tree.uniform_material();
  const uint32_t nodes = tree.node_count();
  const auto shift = static_cast<uint32_t>(tree.rank_shift());
  const uint32_t blocks = (nodes >> shift) + ((nodes & ((1U << shift) - 1)) != 0 ? 1U : 0U);
  to[kRankShift] = shift;
  to[kNodes] = nodes;
  to[kSolidBlocks] = word_at(tree, 20);
  to[kVoxelBits] = word_at(tree, 24);
  to[kMasks] = kCompactHeaderBytes;
  to[kRanks] = to[kMasks] + ((nodes + 3) & ~3U);
  uint32_t next = to[kRanks] + 4 * blocks;
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

void set_frame(const Camera& camera, const Shading& shading, Parameters* parameters) {
  Parameters& to = *parameters;
  const auto set_wide = [&to](size_t at, int64_t value) {
    to[at] = static_cast<uint32_t>(value);
    to[at + 1] = static_cast<uint32_t>(static_cast<uint64_t>(value) >> 32);
  };
  to[kWidth] = static_cast<uint32_t>(camera.width_px());
  to[kHeight] = static_cast<uint32_t>(camera.height_px());
  to[kMode] = static_cast<uint32_t>(shading.mode);
  to[kPerspective] = camera.is_perspective() ? 1 : 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto place = static_cast<size_t>(axis);
    to[kEye + place] = static_cast<uint32_t>(camera.eye()[axis].raw);
    to[kDirection + place] = static_cast<uint32_t>(camera.direction()[axis]);
    set_wide(kBase + 2 * place, camera.affine().base[axis]);
    set_wide(kStepX + 2 * place, camera.affine().step_x[axis]);
    set_wide(kStepY + 2 * place, camera.affine().step_y[axis]);
    to[kFaceLight + 2 * place] = shading.face_light[2 * axis];
    to[kFaceLight + 2 * place + 1] = shading.face_light[2 * axis + 1];
  }
  to[kDepthPerT] = static_cast<uint32_t>(camera.depth_per_t_q8());
  to[kNear] = static_cast<uint32_t>(shading.near_q8);
  to[kFar] = static_cast<uint32_t>(shading.far_q8);
  to[kBackground] = packed(shading.background);
  to[kDefaultColor] = packed(shading.default_color);
  to[kPaletteSize] =
      static_cast<uint32_t>(shading.palette.size < kSceneTree ? shading.palette.size : kSceneTree);
}

namespace {

uint32_t packed(int x, int y, int z) {
  return packed(Rgb8{static_cast<uint8_t>(x), static_cast<uint8_t>(y), static_cast<uint8_t>(z)});
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
    to[kShare + static_cast<size_t>(face)] =
        is_lit ? light.c[0] / (lit::kFullLight / 256) : frame.shading.face_light[face];
  }
  for (size_t i = 0; i < 3; ++i) {
    to[kStrength + i] = is_lit ? frame.scene.ambient_q8[i] : 256;
  }
}

void set_surfaces(const LitFrame& frame, uint32_t* words) {
  const Shading& shading = frame.shading;
  for (size_t material = 0; material < kMaxSurfaces; ++material, words += kSurfaceWords) {
    Surface surface;
    surface.albedo = material < shading.palette.size ? shading.palette[material] : shading.default_color;
    surface = material < frame.scene.surfaces.size ? frame.scene.surfaces[material] : surface;
    words[0] = packed(surface.albedo) | static_cast<uint32_t>(surface.kind) << 24;
    words[1] = surface.emission_q8;
  }
}

void set_lights(const LitScene& scene, uint32_t* words) {
  for (const Light& light : scene.lights) {
    set_vector(light.is_point ? Vec3i(light.place) : shorten(light.place), words);
    for (int i = 0; i < 3; ++i) {
      words[3 + i] = light.color_q8[i];
    }
    words[6] = light.is_point ? uint32_t{light.reach} : kDistant;
    words += kLightWords;
  }
}

void set_backdrop(const Backdrop& backdrop, Parameters* parameters) {
  Parameters& to = *parameters;
  to[kBackdrop] = backdrop.has_ground ? 2 : 1;
  to[kGround] = static_cast<uint32_t>(backdrop.ground_z);
  to[kGroundReach] = backdrop.reach;
  set_vector(backdrop.toward_sun, &to[kSun]);
  for (size_t i = 0; i < kAroundRays && backdrop.around != nullptr; ++i) {
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
  to[kOcclusionRays] = occlusion.reach == 0                    ? 0
                       : occlusion.rays < kOcclusionDirections ? occlusion.rays
                                                               : kOcclusionDirections;
  to[kOcclusionStrength] = occlusion.strength;
  to[kOcclusionReach] = occlusion.reach;
  for (size_t i = 0; i < kOcclusionDirections; ++i) {
    to[kPattern + i] = packed(kOcclusionPattern[i].x, kOcclusionPattern[i].y, kOcclusionPattern[i].z);
  }
  set_surfaces(frame, &to[kSurfaces]);
  to[kLightCount] = static_cast<uint32_t>(frame.scene.lights.size);
  set_lights(frame.scene, &to[kLights]);
  if (frame.backdrop != nullptr) {
    set_backdrop(*frame.backdrop, parameters);
  }
}

namespace {

void set_direction(int32_t component, int32_t* largest) {
  const int32_t size = component < 0 ? -component : component;
  *largest = size > *largest ? size : *largest;
}

}  // namespace

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

bool needs_pairs(int level, const Vec3i& largest) {
  const int64_t all = int64_t{largest.x} + largest.y + largest.z;
  bool needs = false;  // for some two of them
  for (int axis = 0; axis < 3; ++axis) {
    needs = needs || (all - largest[axis]) << (level + 8) >= int64_t{1} << 32;
  }
  return needs;
}

}  // namespace thimble::gpu
