/// @file scene.h
/// What light does in a scene: surfaces, lights, sky, fog, water, and the set of effects that follows.
///
/// Plain data, without a tree: a few numbers a material, a few a light. An effect is a part of the renderer
/// that can be left out; `effects_of` reads off the data which ones the scene calls for. Everything is in
/// integers, so a lit picture is the same on every machine (render.h draws it).
#ifndef THIMBLE_LIGHT_SCENE_H
#define THIMBLE_LIGHT_SCENE_H

#include <stddef.h>
#include <stdint.h>

#include "../base/memory.h"
#include "../base/status.h"
#include "../base/vec.h"
#include "../picture/pixel.h"
#include "water.h"

namespace thimble {

// Numbers as the bytes of a file hold them: little-endian, at any address. A struct made of these and of
// bytes has the same layout on every machine and no padding, so tables in flash are used where they lie.
//
// They convert to plain integers and back by themselves. Reading one is a load a byte and a shift on chips
// that load only aligned words (Cortex-M0: 4 instructions for 16 bits, 10 for 32), else a single load.

/// 16 bits without a sign.
class PackedU16 {
 public:
  constexpr PackedU16() = default;
  constexpr PackedU16(uint16_t value)
      : low_(static_cast<uint8_t>(value)), high_(static_cast<uint8_t>(value >> 8)) {}
  constexpr operator uint16_t() const { return static_cast<uint16_t>(low_ | high_ << 8); }

 private:
  uint8_t low_ = 0;
  uint8_t high_ = 0;
};

/// 32 bits with a sign, in two's complement.
class PackedI32 {
 public:
  constexpr PackedI32() = default;
  constexpr PackedI32(int32_t value)
      : low_(static_cast<uint16_t>(static_cast<uint32_t>(value) & 0xFFFFU)),
        high_(static_cast<uint16_t>(static_cast<uint32_t>(value) >> 16)) {}
  constexpr operator int32_t() const {
    return static_cast<int32_t>(static_cast<uint32_t>(low_) | static_cast<uint32_t>(high_) << 16);
  }

 private:
  PackedU16 low_;
  PackedU16 high_;
};

/// Three of them.
struct PackedVec3i {
  PackedI32 x;
  PackedI32 y;
  PackedI32 z;

  constexpr PackedVec3i() = default;
  constexpr PackedVec3i(int32_t x_value, int32_t y_value, int32_t z_value)
      : x(x_value), y(y_value), z(z_value) {}
  constexpr PackedVec3i(const Vec3i& vector) : x(vector.x), y(vector.y), z(vector.z) {}
  constexpr operator Vec3i() const { return {x, y, z}; }
  /// Component `axis` (0 = x, 1 = y, 2 = z).
  constexpr int32_t operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend constexpr bool operator==(const PackedVec3i& a, const PackedVec3i& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
  }
};

static_assert(sizeof(PackedU16) == 2 && alignof(PackedU16) == 1);
static_assert(sizeof(PackedI32) == 4 && alignof(PackedI32) == 1);
static_assert(sizeof(PackedVec3i) == 12 && alignof(PackedVec3i) == 1);

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
struct Effect {
  static constexpr EffectSet kNone = 0;
  static constexpr EffectSet kDirectLight = 1U << 0;  ///< lights by angle; without it, faces by `face_light`
  static constexpr EffectSet kShadows = 1U << 1;      ///< a ray to each light; needs kDirectLight
  static constexpr EffectSet kAmbientOcclusion = 1U << 2;  ///< rays around a face: corners are darker
  static constexpr EffectSet kEmission = 1U << 3;          ///< materials that shine
  static constexpr EffectSet kMirror = 1U << 4;            ///< metal: a reflected ray, a few when rough
  static constexpr EffectSet kGlass = 1U << 5;      ///< clear solids: refraction, reflection, absorption
  static constexpr EffectSet kMedia = 1U << 6;      ///< cloudy solids: absorption without a surface
  static constexpr EffectSet kWater = 1U << 7;      ///< columns with a moving surface
  static constexpr EffectSet kFog = 1U << 8;        ///< the air itself
  static constexpr EffectSet kSky = 1U << 9;        ///< a gradient where rays leave the world
  static constexpr EffectSet kDepthCue = 1U << 10;  ///< the paper's: brightness falls with depth
  /// Light sees the slope of a surface, not the faces of its voxels. Off by default.
  static constexpr EffectSet kSmoothNormals = 1U << 11;
  /// What glows lights what is around it: lamps in `LitScene::lights` that whoever makes the scene puts where
  /// it glows. Drawn by kDirectLight and kShadows, which it needs; no code of its own.
  static constexpr EffectSet kEmitterLight = 1U << 12;
  /// Edges between faces of about the same grey are dark, for displays of few greys. Off by default.
  static constexpr EffectSet kEdges = 1U << 13;
  /// Small waves on the surface of water, which show the sun. Drawn with kWater. Off by default.
  static constexpr EffectSet kRipples = 1U << 14;
  static constexpr int kCount = 15;
  static constexpr EffectSet kAll = (1U << kCount) - 1;
  /// Those that send a ray on from a hit, with a state for each ray still to be followed.
  static constexpr EffectSet kBranching = kMirror | kGlass | kMedia | kWater;
};

/// The name of an effect as the command writes it ("shadows", "ambient-occlusion"); "" for other values.
const char* effect_name(EffectSet effect);

/// What a material does with light. 12 bytes at any address, the same on every machine: a table of them in
/// flash is used where it lies (`BakedLighting`).
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
  friend constexpr bool operator==(const Surface& a, const Surface& b) {
    return a.albedo == b.albedo && a.kind == b.kind && a.roughness == b.roughness && a.mirror == b.mirror &&
           a.index_q12 == b.index_q12 && a.density_q8 == b.density_q8 && a.emission_q8 == b.emission_q8;
  }
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
  friend constexpr bool operator==(const Light& a, const Light& b) {
    return a.is_point == b.is_point && a.place == b.place && a.color_q8[0] == b.color_q8[0] &&
           a.color_q8[1] == b.color_q8[1] && a.color_q8[2] == b.color_q8[2] && a.reach == b.reach;
  }
};
static_assert(sizeof(Light) == 21 && alignof(Light) == 1);

/// Where rays that leave the world end: `zenith` above, `horizon` at eye level, `ground` below.
struct Sky {
  Rgb8 zenith{70, 120, 190};
  Rgb8 horizon{200, 215, 230};
  Rgb8 ground{142, 138, 134};
  friend constexpr bool operator==(const Sky& a, const Sky& b) {
    return a.zenith == b.zenith && a.horizon == b.horizon && a.ground == b.ground;
  }
};

struct Fog {
  Rgb8 color{200, 205, 210};
  /// Light halves `density_q16 / 65536` times a voxel; 0 is no fog.
  uint32_t density_q16 = 0;
  friend constexpr bool operator==(const Fog& a, const Fog& b) {
    return a.color == b.color && a.density_q16 == b.density_q16;
  }
};

struct Occlusion {
  uint8_t rays = 0;        ///< 0 (none), 4, 8, 16 or 32 a hit, in a fixed pattern round the face
  uint8_t strength = 255;  ///< 255: a closed pit is black
  uint16_t reach = 8;      ///< voxels; what is farther away does not darken
  friend constexpr bool operator==(const Occlusion& a, const Occlusion& b) {
    return a.rays == b.rays && a.strength == b.strength && a.reach == b.reach;
  }
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
  /// Where the ripples are on their way (Effect::kRipples): they come round after 256.
  uint8_t ripple_phase = 0;
};

/// The effects that the scene calls for: those that at least one material or light needs. `used` (may be
/// null: all) tells which materials occur in the tree, so that one that only the palette holds calls for
/// nothing.
EffectSet effects_of(const LitScene& scene, const bool (*used)[256] = nullptr);

/// What a ray was sent for. kGlassRay and kWaterRay: reflected or refracted at such a boundary; kMediaRay:
/// not a ray of its own but a stretch of one, from where it left a cloud (or glass of index 1) straight on.
enum class LitRayKind : uint8_t {
  kPrimary,
  kShadow,
  kOcclusion,
  kMirrorRay,
  kGlassRay,
  kMediaRay,
  kWaterRay
};
inline constexpr int kLitRayKinds = 7;

/// What a renderer did. An effect that is not in the set counts 0.
struct LitCounts {
  uint64_t rays[kLitRayKinds] = {};
  /// Of all these, met something solid. What goes straight on through clear solids, which counts as a ray of glass,
  /// media or water, is counted here as the kind that it began as, so that only the sum is never more than the rays.
  uint64_t hits[kLitRayKinds] = {};
  /// Nodes whose mask was read (`Hit::visits`), cells walked through inside clear solids, columns of water.
  uint64_t node_visits[kLitRayKinds] = {};
  uint64_t step_limited = 0;        ///< rays stopped by `LitOptions::max_visits`; they count as misses
  uint32_t pending_high_water = 0;  ///< most rays of a pixel that waited to be followed at once
};

struct LitOptions {
  /// A ray is stopped where it would visit one more node than this.
  uint32_t max_visits = UINT32_MAX;
  /// Ordered dither (Bayer, 8 x 8) in formats with fewer than 8 bits a channel.
  bool dither = true;
};

// All this of a baked scene, opened where it lies (src/FORMAT.md has the bytes). A program that draws no light links
// none of it.
//
//     BakedLighting lighting;
//     const ConstBytes bytes = scene.section(SectionKind::kLighting);
//     if (BakedLighting::open(bytes, scene.tree().level(), &lighting) == Status::kOk) ...

/// The version of the section that is written, and the only one that is read (src/FORMAT.md, "Versions").
inline constexpr uint8_t kLightingVersion = 1;
/// Bytes before the tables of surfaces and lights.
inline constexpr size_t kLightingHeadBytes = 64;
/// Components of a distant light's direction are at most this.
inline constexpr int32_t kMaxLightComponent = int32_t{1} << 14;

/// Bytes of the section for `scene`: 64 + 12 a surface + 21 a light. 0 when there are too many of either.
size_t lighting_bytes(const LitScene& scene);

struct BakedLighting {
  /// `surfaces` and `lights` lie in the section's bytes; `water` is at rest. Every number is within the
  /// limits of scene.h.
  LitScene scene;
  /// What the scene was baked for: the effects that it calls for, or those that somebody chose. A firmware
  /// image reads the same set from the header that `thimble bake` generates, when it is compiled.
  EffectSet effects = Effect::kNone;

  /// Writes the section to the front of `to`. Water is written as it is at rest (`highest_q8`; its heights
  /// are not kept). `kOutOfMemory` when it does not fit, and nothing is written; `kBadArgument` when `open`
  /// would refuse it (the bytes are then of no use).
  static Status make(const BakedLighting& lighting, int level, Bytes to);

  /// Looks at every number of a section in a world of 2^level (1 .. kMaxLevel, in all three), at most 256
  /// surfaces and 100 lights.
  /// `kDamaged`, with `*lighting` as it was: no section (no bytes), another version, tables that are not as
  /// long as they should be, a number beyond its limits. Safe for any bytes.
  static Status open(ConstBytes section, int level, BakedLighting* lighting);

  /// The same, as a short English phrase that says what is wrong, or nullptr. `place` (may be null) gets the
  /// offset of the field concerned.
  static const char* validate(ConstBytes section, int level, uint32_t* place = nullptr);
};

}  // namespace thimble

#endif
