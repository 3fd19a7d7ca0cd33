/// Scenes that need no file.
///
///   points:N    N voxels uniformly random in the world, repetitions allowed: the paper's workload
///   cluster:N   N voxels of a mixture of Plummer spheres, as star clusters have them
///   spheres     solid balls of several sizes and colours: the paper's Figure 2
///   water       a basin with an island and floating bodies of glass and metal, in the sun; the water itself
///               is no voxels but a still surface (water_surface.h), which only effects show
///   demo        a castle in a valley (demo_world.cpp): what the firmware shows
///
/// each followed by `,seed=S` and `,depth=L` in any order, as in `points:1000000,seed=7,depth=10`. N may be
/// written as 1e6 or 2.5e6.
///
/// A scene is a function of kind, count, seed and depth: integer arithmetic and a random generator of
/// our own make it the same on every machine. It is laid out in fractions of the world, so another depth
/// shows the same scene finer or coarser. World axes are right-handed, z up.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "readers/source.h"
#include "scene/lit_description.h"
#include "thimble/bake/baked_scene.h"

namespace thimble::tools {

enum class GeneratorKind : std::uint8_t { kPoints, kCluster, kSpheres, kWater, kDemo };
/// Whether it has a number of points.
constexpr bool is_counted(GeneratorKind kind) {
  return kind == GeneratorKind::kPoints || kind == GeneratorKind::kCluster;
}

inline constexpr std::uint64_t kMaxGeneratorPoints = 1'000'000'000;

struct GeneratorSpec {
  GeneratorKind kind = GeneratorKind::kPoints;
  std::uint64_t count = 0;  ///< points and cluster: 0 .. kMaxGeneratorPoints; else not used
  std::uint64_t seed = 1;
  int depth = 10;  ///< 1..12; unless given 10 for points and cluster, 6 for the others
};

/// What `text` asks for. Nothing when the part before the first `:` or `,` is not one of the five names, so
/// that it may be a file (`points.xyz`). InputError when the name is one of them and the rest is wrong.
std::optional<GeneratorSpec> parse_generator(const std::string& text);

/// Each generator as one may write it: points:1000000, cluster:1000000, spheres, ...
std::vector<std::string> generator_examples();

/// Streams the scene. `points` and `cluster` call `sink` exactly `count` times, positions may repeat, all
/// material 0. The others call it for solid voxels: `spheres` once for each ball that holds the
/// voxel (few touch), `water` and `demo` once. Time grows with the calls; the solid scenes have roughly an
/// eighth (spheres) to a quarter of the world's 8^depth voxels, so depths above 9 take long. No heap.
void generate(const GeneratorSpec& spec, const VoxelSink& sink);

/// Where a scene wants to be looked at from; nothing for those that are framed by what they hold.
std::optional<SceneCamera> generator_camera(const GeneratorSpec& spec);

/// The palette that the material numbers refer to; index 0 is the default material.
Palette generator_palette(GeneratorKind kind);

/// What light does in the scene: `water` has its surface, a sun and a sky; the others only surfaces.
LitDescription generator_lighting(const GeneratorSpec& spec);

/// The largest whole number whose square is not above `value`.
std::uint64_t integer_sqrt(std::uint64_t value);

// The scene of the demonstration: a valley among mountains, a castle on a crag in a lake, a bridge, an
// aqueduct, a village, a stone circle, trees and a boat.
//
// It is made for a small screen: few tones that keep apart under the light of the faces, large plain shapes
// (terraces, cliffs in layers), and mountains on all sides, so that a camera inside the valley sees hardly
// any sky. It is laid out in 1/64 of the world: at depth 6 a unit is a voxel.

/// Streams the world of 2^depth voxels a side, each solid voxel once, column by column. The seed moves hills,
/// shores, trees and rocks; what is built by hand stays where it is. No heap. Time grows with 8^depth.
void generate_demo_world(const GeneratorSpec& spec, const VoxelSink& sink);

/// Colours of the materials; index 0 is the default material.
Palette demo_world_palette();

/// Where the demonstration's orbit begins: inside the valley, above the lake, looking at the castle.
SceneCamera demo_world_camera(int depth);

/// The sun and the light from everywhere, for whoever asks for effects; of itself the scene calls for none.
void demo_world_light(LitDescription* lit);

}  // namespace thimble::tools
