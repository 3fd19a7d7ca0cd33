/// @file backdrop.h
/// What stands behind a scene: a colour, a gradient or nothing, and a ground of which only the shadow is seen.
#ifndef THIMBLE_TOOLS_SCENE_BACKDROP_H
#define THIMBLE_TOOLS_SCENE_BACKDROP_H

#include <cstdint>

#include "scene/default_look.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

class LitStreams;

/// The gradient behind a scene, from top to bottom.
inline constexpr Rgb8 kSoftTop{150, 168, 190};
inline constexpr Rgb8 kSoftBottom{226, 224, 218};
inline constexpr Rgb8 kSoftMiddle{188, 196, 204};

/// Light that a ray finds behind the scene: kFullShare as it is, less in shadow.
inline constexpr std::uint8_t kFullShare = 254;

/// The backdrop's colour at a pixel.
Rgb8 backdrop_color(const Background& background, std::int32_t x, std::int32_t y, std::int32_t width_px,
                    std::int32_t height_px);

/// Whether `ray` of a camera misses everything; then how much light the ground that it meets has, if any:
/// kFullShare less the sun's exact shadow, and less what the model closes off above. Up to 34 rays.
/// False where it hits. Integers only.
bool light_behind(const CompactTree& tree, const Look& look, const Ray& ray, std::uint8_t* share);

/// A share for a ray that hits.
inline constexpr std::uint8_t kNothingBehind = 255;

/// The same of many rays, kNothingBehind where they hit; by the vectors of `streams`, unless it is null.
void find_light_behind(const CompactTree& tree, const Look& look, const LitStreams* streams,
                       Span<const Ray> rays, std::uint8_t* shares);

}  // namespace thimble::tools

#endif
