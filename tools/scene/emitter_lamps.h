/// What glows as lamps (Effect::kEmitterLight): a fixed set of places for a scene, so that a point is lit by
/// one ray to each.
#pragma once

#include <cstddef>
#include <vector>

#include "thimble/light/scene.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

/// Lamps that a scene's glow is put together to, at the most.
inline constexpr std::size_t kMostGlowLamps = 16;

/// Lamps, at most `most`, for the faces of glowing voxels (SurfaceKind::kEmit) that show: one for each cube of
/// 2^k voxels a side that has such faces, k the least with which they are few enough. A lamp stands in the
/// middle of its faces, or before them where they look one way; has reach 1, the brightness A / pi * (1 +
/// the share in which they look one way) for A faces of brightness 1; and shines alike all around. That is
/// four times the light that such faces send: one for what arrives straight, three for what a room's walls
/// throw to and fro, which is not traced. Brightness above 255 is cut off.
std::vector<Light> glow_lamps(const CompactTree& tree, const std::vector<Surface>& surfaces,
                              std::size_t most = kMostGlowLamps);

}  // namespace thimble::tools
