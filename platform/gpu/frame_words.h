/// What the kernels read of a frame (kernel/parameters.inc), made from the core's tree, camera, shading and light. It
/// needs no GPU and nothing of a system: the page's frames are made by it, too.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/light/scene.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::gpu {

/// A kernel's uniform buffer.
struct Parameters {
  uint32_t words[1464] = {};
  uint32_t& operator[](size_t i) { return words[i]; }
  const uint32_t& operator[](size_t i) const { return words[i]; }
};

/// Writes the parameters of the scene, whose words are room for a palette and then the bytes of `tree`.
void set_tree(const CompactTree& tree, Parameters* parameters);
/// Adds a frame's parameters.
void set_frame(const Camera& camera, const Shading& shading, Parameters* parameters);
/// The effects that kernels draw.
inline constexpr EffectSet kEffectsInKernels = Effect::kDirectLight | Effect::kShadows |
                                               Effect::kAmbientOcclusion | Effect::kEmission | Effect::kSky |
                                               Effect::kSmoothNormals | Effect::kEmitterLight;
/// What stands behind a lit picture: pixels get the share of its light that comes past the scene. 254: all of it; 255:
/// there is something before it.
struct Backdrop {
  bool has_ground = false;  ///< a level one, of which only shadows are seen
  int32_t ground_z = 0;
  uint16_t reach = 1;        ///< voxels within which what stands there darkens it
  Vec3i toward_sun;          ///< whose shadows it shows, unless that stands below
  const Vec3i* around = {};  ///< 32 directions, of components up to 127, that look for what darkens it
};
/// A lit picture. What it refers to outlives it.
struct LitFrame {
  EffectSet effects;
  const Camera& camera;
  const Shading& shading;
  const LitScene& scene;
  const Backdrop* backdrop = nullptr;
};
/// Adds its parameters.
void set_light(const LitFrame& frame, Parameters* parameters);

/// The largest components of the directions of a picture's rays.
Vec3i largest_direction(const Camera& camera);
/// Of all rays of a lit picture.
Vec3i largest_direction(const LitFrame& frame);
/// Whether words of 32 bits order the planes that such rays cross, or pairs of them are needed (README.md).
bool needs_pairs(int level, const Vec3i& largest_direction);

}  // namespace thimble::gpu
