/// @file lit_scene.h
/// What light does in a scene: surfaces, lights, sky, fog, water, and the set of effects that follows.
///
/// Plain data, without a tree: a few numbers a material, a few a light. An effect is a part of the renderer
/// that can be left out; `effects_of` reads off the data which ones the scene calls for. Everything is in
/// integers, so a lit picture is the same on every machine (lit_render.h draws it).
#ifndef THIMBLE_LIT_SCENE_H
#define THIMBLE_LIT_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "thimble/fixed.h"
#include "thimble/packed.h"
#include "thimble/pixel.h"
#include "thimble/span.h"
#include "thimble/vec.h"
#include "thimble/water_surface.h"

namespace thimble {

enum class SurfaceKind : uint8_t {
  kDiffuse,
  kMetal,  ///< mixes its own colour with what it mirrors
  kGlass,  ///< clear: light goes through, bent and filtered
  kEmit,   ///< shines with its own colour
  kMedia,  ///< a cloud: takes light away by distance, bends none
};

/// Effects, as bits of a set. Each is a part of its own: a renderer made for a set holds the others neither
/// in its code nor in its state.
using EffectSet = uint32_t;
inline constexpr EffectSet kNoEffects = 0;
inline constexpr EffectSet kDirectLight = 1U << 0;  ///< lights by angle; without it, faces by `face_light`
inline constexpr EffectSet kShadows = 1U << 1;      ///< a ray to each light; needs kDirectLight
inline constexpr EffectSet kAmbientOcclusion = 1U << 2;  ///< rays around a face: corners are darker
inline constexpr EffectSet kEmission = 1U << 3;          ///< materials that shine
inline constexpr EffectSet kMirror = 1U << 4;            ///< metal: a reflected ray, a few when rough
inline constexpr EffectSet kGlass = 1U << 5;             ///< clear solids: refraction, reflection, absorption
inline constexpr EffectSet kMedia = 1U << 6;             ///< cloudy solids: absorption without a surface
inline constexpr EffectSet kWater = 1U << 7;             ///< columns with a moving surface
inline constexpr EffectSet kFog = 1U << 8;               ///< the air itself
inline constexpr EffectSet kSky = 1U << 9;               ///< a gradient where rays leave the world
inline constexpr EffectSet kDepthCue = 1U << 10;         ///< the paper's: brightness falls with depth
inline constexpr int kEffectCount = 11;
inline constexpr EffectSet kAllEffects = (1U << kEffectCount) - 1;
/// Those that send a ray on from a hit, with a state for each ray still to be followed.
inline constexpr EffectSet kBranchingEffects = kMirror | kGlass | kMedia | kWater;

/// The name of an effect as the command writes it ("shadows", "ambient-occlusion"); "" for other values.
const char* effect_name(EffectSet effect);

/// What a material does with light. 12 bytes at any address, the same on every machine: a table of them in
/// flash is used where it lies (baked_lighting.h).
struct Surface {
  Rgb8 albedo{230, 230, 230};
  SurfaceKind kind = SurfaceKind::kDiffuse;
  uint8_t roughness = 0;  ///< kMetal: 0 a mirror .. 255
  uint8_t mirror = 255;   ///< kMetal: share mirrored, 255 all of it
  /// kGlass: index of refraction, 4096 = 1: kMinIndexQ12 .. kMaxIndexQ12.
  PackedU16 index_q12 = 5325;
  /// kGlass and kMedia: optical density. Light in a channel halves `density_q8 / 256 * (1 - albedo / 255)`
  /// times a voxel (kMedia: `density_q8 / 256` times, and takes on the albedo).
  PackedU16 density_q8 = 64;
  /// kEmit: brightness added, 256 = the albedo itself.
  PackedU16 emission_q8 = 256;
  friend constexpr bool operator==(const Surface&, const Surface&) = default;
};
static_assert(sizeof(Surface) == 12 && alignof(Surface) == 1);
inline constexpr uint16_t kMinIndexQ12 = 4096;      ///< 1: vacuum
inline constexpr uint16_t kMaxIndexQ12 = 4 * 4096;  ///< 4: beyond everything clear that exists
inline constexpr uint16_t kWaterIndexQ12 = 5460;    ///< 1.333
inline constexpr size_t kMaxSurfaces = 256;
inline constexpr size_t kMaxLights = 100;
inline constexpr uint8_t kMaxBounces = 8;
inline constexpr uint8_t kDefaultBounces = 4;

/// A distant light (the sun) or a point in the world. 21 bytes at any address, as `Surface`.
struct Light {
  bool is_point = false;
  /// Distant: towards the light, any length up to 2^14 a component, not all 0. Point: its place in 1/256
  /// voxel, within the limits of a ray's origin.
  PackedVec3i place{-5, -9, 16};
  /// Brightness of the three channels, 256 = 1: what a white surface that faces the light gets.
  PackedU16 color_q8[3] = {256, 256, 256};
  /// Point: the distance in voxels at which a quarter is left (brightness = color / (1 + d / reach)^2).
  PackedU16 reach = 32;
  friend constexpr bool operator==(const Light&, const Light&) = default;
};
static_assert(sizeof(Light) == 21 && alignof(Light) == 1);

/// Where rays that leave the world end: `zenith` above, `horizon` at eye level, `ground` below.
struct Sky {
  Rgb8 zenith{70, 120, 190};
  Rgb8 horizon{200, 215, 230};
  Rgb8 ground{142, 138, 134};
  friend constexpr bool operator==(const Sky&, const Sky&) = default;
};

struct Fog {
  Rgb8 color{200, 205, 210};
  /// Light halves `density_q16 / 65536` times a voxel; 0 is no fog.
  uint32_t density_q16 = 0;
  friend constexpr bool operator==(const Fog&, const Fog&) = default;
};

struct Occlusion {
  uint8_t rays = 0;        ///< 0 (none), 4, 8, 16 or 32 a hit, in a fixed pattern round the face
  uint8_t strength = 255;  ///< 255: a closed pit is black
  uint16_t reach = 8;      ///< voxels; what is farther away does not darken
  friend constexpr bool operator==(const Occlusion&, const Occlusion&) = default;
};

/// Everything besides tree, camera and `Shading`. A default one is a plain scene: `effects_of` gives none.
struct LitScene {
  Span<const Surface> surfaces;  ///< by material index; may be empty; an index beyond takes `Surface{}`
  Span<const Light> lights;      ///< at most kMaxLights
  uint16_t ambient_q8[3] = {72, 80, 96};  ///< light from everywhere, 256 = 1
  bool has_shadows = false;
  bool has_sky = false;
  bool has_depth_cue = false;  ///< planes and brightness: `Shading::near_q8`, `far_q8`
  Sky sky;
  Fog fog;
  Occlusion occlusion;
  bool has_water = false;
  WaterSurface water;
  Surface water_material{{70, 170, 190}, SurfaceKind::kGlass, 0, 255, kWaterIndexQ12, 16, 0};
  /// Rays that follow one another from a pixel, the first one not counted: 0 .. kMaxBounces.
  uint8_t bounces = kDefaultBounces;
};

/// The effects that the scene calls for: those that at least one material or light needs. `used` (may be
/// null: all) tells which materials occur in the tree, so that one that only the palette holds calls for
/// nothing.
EffectSet effects_of(const LitScene& scene, const bool (*used)[256] = nullptr);

}  // namespace thimble

#endif
