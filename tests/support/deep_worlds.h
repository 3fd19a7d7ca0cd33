/// Worlds of level 9 and 10 with their brick maps, of every kind that a directory of two levels tells apart.
#pragma once

#include <random>

#include "support/chip_worlds.h"

namespace thimble::tests {

/// kTerrain and kShell are patches near a corner, a side or the middle; kMerged has blocks that coarsening made.
enum class DeepWorld { kDust, kBlocks, kTerrain, kShell, kCorners, kMerged };
inline constexpr int kDeepWorldKinds = 6;

/// How far from a world's sides an eye may be for a frame by the map, in 1/256 voxel.
inline constexpr int kMostDeepDistanceQ8 = (1 << 19) - 512;

/// The bytes of such a tree. Materials 0 .. 9, or any, or one.
HeapBytes make_deep_tree(std::mt19937_64& random, DeepWorld world, int level);
/// The same with its map.
MappedTree make_deep_scene(std::mt19937_64& random, DeepWorld world, int level);

/// As hard_chip_camera; and eyes within the world, close by what is solid, at its sides and as far away as frames by the
/// map go, that mostly look at what is solid.
Camera hard_deep_camera(std::mt19937_64& random, const CompactTree& tree);

}  // namespace thimble::tests
