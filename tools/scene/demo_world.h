/// @file demo_world.h
/// The scene of the demonstration: a valley among mountains, a castle on a crag in a lake, a bridge, an
/// aqueduct, a village, a stone circle, trees and a boat.
///
/// It is made for a small screen: few tones that keep apart under the light of the faces, large plain shapes
/// (terraces, cliffs in layers), and mountains on all sides, so that a camera inside the valley sees hardly
/// any sky. It is laid out in 1/64 of the world: at depth 6 a unit is a voxel.
#ifndef THIMBLE_TOOLS_SCENE_DEMO_WORLD_H
#define THIMBLE_TOOLS_SCENE_DEMO_WORLD_H

#include <cstdint>

#include "readers/source.h"
#include "scene/lit_description.h"
#include "scene/voxel_sink.h"
#include "thimble/bake/baked_scene.h"

namespace thimble::tools {

/// Streams the world of 2^depth voxels a side, each solid voxel once, column by column. The seed moves hills,
/// shores, trees and rocks; what is built by hand stays where it is. No heap. Time grows with 8^depth.
void generate_demo_world(std::uint64_t seed, int depth, const VoxelSink& sink);

/// Colours of the materials; index 0 is the default material.
Palette demo_world_palette();

/// Where the demonstration's orbit begins: inside the valley, above the lake, looking at the castle.
SceneCamera demo_world_camera(int depth);

/// The sun and the light from everywhere, for whoever asks for effects; of itself the scene calls for none.
void demo_world_light(LitDescription* lit);

}  // namespace thimble::tools

#endif
