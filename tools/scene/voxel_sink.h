/// @file voxel_sink.h
/// Where voxels go: everything in `scene/` streams into one of these and keeps no list of voxels.
#ifndef THIMBLE_TOOLS_SCENE_VOXEL_SINK_H
#define THIMBLE_TOOLS_SCENE_VOXEL_SINK_H

#include <cstdint>
#include <functional>

namespace thimble::tools {

/// One solid voxel with its palette index. A position may come more than once; the last call decides its
/// material. May throw, which ends the streaming; the streaming functions hold nothing that would leak.
using VoxelSink = std::function<void(std::int32_t x, std::int32_t y, std::int32_t z, std::uint8_t material)>;

}  // namespace thimble::tools

#endif
