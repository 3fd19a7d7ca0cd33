/// @file backdrop.h
/// The light behind a scene (behind.h) for many pixels at a time, in vectors where there are any.
#ifndef THIMBLE_TOOLS_SCENE_BACKDROP_H
#define THIMBLE_TOOLS_SCENE_BACKDROP_H

#include <cstdint>

#include "scene/default_look.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

class LitStreams;

/// `light_behind` of many rays, kNothingBehind where they hit; by the vectors of `streams`, unless it is null.
void find_light_behind(const CompactTree& tree, const Look& look, const LitStreams* streams,
                       Span<const Ray> rays, std::uint8_t* shares);

}  // namespace thimble::tools

#endif
