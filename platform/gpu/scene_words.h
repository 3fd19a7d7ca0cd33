/// What the kernels read (kernel/parameters.inc), made from the core's tree, camera and shading. It needs no GPU: the
/// tests run the kernels on these words as C++.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "thimble/base/memory.h"
#include "thimble/light/scene.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::gpu {

inline constexpr std::size_t kWordsOfParameters = 1464;
using Parameters = std::array<std::uint32_t, kWordsOfParameters>;

struct SceneWords {
  int level = 0;
  Parameters parameters{};  ///< those of the scene; a frame's are added to a copy
  std::vector<std::uint32_t> words;
};

/// Room for a palette, then the bytes of `tree`.
SceneWords make_scene_words(const CompactTree& tree);

/// Writes the colours of `palette` to the front of a scene's words.
void set_palette(Span<const Rgb8> palette, std::uint32_t* words);

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
  std::int32_t ground_z = 0;
  std::uint16_t reach = 1;   ///< voxels within which what stands there darkens it
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
/// Single pixels of it instead: `count` of them, in rows of `width`.
void set_places(std::uint32_t count, std::uint32_t width, Parameters* parameters);
/// The same for a list of `count` rays, in rows of `width`.
void set_rays(std::uint32_t count, std::uint32_t width, Parameters* parameters);
/// A ray as a record of such a list, and the hit that the kernel puts in its place.
void set_record(const Ray& ray, std::uint32_t* record);
Hit hit_of_record(const std::uint32_t* record);

/// The largest components of the directions of a picture's rays, or of a list's.
Vec3i largest_direction(const Camera& camera);
Vec3i largest_direction(Span<const Ray> rays);
/// Of all rays of a lit picture.
Vec3i largest_direction(const LitFrame& frame);
/// Whether words of 32 bits order the planes that such rays cross, or pairs of them are needed (README.md).
bool needs_pairs(int level, const Vec3i& largest_direction);

}  // namespace thimble::gpu
