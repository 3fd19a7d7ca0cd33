/// A scene's words, and lists of rays, for the kernels. It needs no GPU: the tests run the kernels on these words as C++.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/frame_words.h"
#include "thimble/base/memory.h"
#include "thimble/trace/ray.h"

namespace thimble::gpu {

struct SceneWords {
  int level = 0;
  Parameters parameters;  ///< those of the scene; a frame's are added to a copy
  std::vector<std::uint32_t> words;
};

/// Room for a palette, then the bytes of `tree`.
SceneWords make_scene_words(const CompactTree& tree);

/// Writes the colours of `palette` to the front of a scene's words.
void set_palette(Span<const Rgb8> palette, std::uint32_t* words);

/// Single pixels of a lit picture instead of all: `count` of them, in rows of `width`.
void set_places(std::uint32_t count, std::uint32_t width, Parameters* parameters);
/// A list of `count` rays, in rows of `width`.
void set_rays(std::uint32_t count, std::uint32_t width, Parameters* parameters);
/// A ray as a record of such a list, and the hit that the kernel puts in its place.
void set_record(const Ray& ray, std::uint32_t* record);
Hit hit_of_record(const std::uint32_t* record);

/// The largest components of the directions of a list.
Vec3i largest_direction(Span<const Ray> rays);

}  // namespace thimble::gpu
