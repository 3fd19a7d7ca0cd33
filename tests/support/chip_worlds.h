/// Worlds of every kind with their brick maps, and cameras that make ties: what frames on a chip are held to those of the
/// tree with.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "support/counts.h"
#include "support/scene_under_test.h"
#include "thimble/picture/camera.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/compact_tree.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {

/// How many pixels a run draws: a million, fewer where that takes long; with THIMBLE_LONG `longest`.
std::uint64_t pixels_to_draw(std::uint64_t longest = 100'000'000, std::uint64_t slowly = 100'000);

enum class ChipWorld { kHills, kBlocks, kDust, kRoom, kMerged, kTower, kCorners };
inline constexpr ChipWorld kChipWorlds[] = {ChipWorld::kHills,  ChipWorld::kBlocks, ChipWorld::kDust,
                                            ChipWorld::kRoom,   ChipWorld::kMerged, ChipWorld::kTower,
                                            ChipWorld::kCorners};

/// Materials 0 .. 9, or any, or one. At levels 9 and 10 hills and walls are patches near a corner, a side or the middle.
HeapBytes make_chip_tree(std::mt19937_64& random, ChipWorld world, int level);
/// The same with its map.
MappedTree make_chip_scene(std::mt19937_64& random, ChipWorld world, int level);
/// These voxels, all of material 1.
MappedTree make_chip_scene(int level, const std::vector<Vec3i>& voxels);

/// How far from a world's sides an eye may be for a frame by the map of level 9 and 10, in 1/256 voxel.
inline constexpr int kMostDeepDistanceQ8 = (1 << 19) - 512;

/// A coordinate of an eye in 1/256 voxel: often the least or the greatest from which frames by bricks take directions of
/// `bits` bits, whatever the box of what is solid; and beyond.
int far_coordinate(std::mt19937_64& random, int level, int bits);
/// Whether distances from the eye to the world's sides and directions have 31 bits together.
bool takes_31_bits(const Camera& camera);

/// On lattice points and beside them, on diagonals, inside solids, outside, as far away as `far_coordinate`; 1 to 120
/// degrees.
Camera hard_chip_camera(std::mt19937_64& random, int level);
/// As that; and eyes within the world, close by what is solid, at its sides and as far away as frames by the map go, that
/// mostly look at what is solid.
Camera hard_deep_camera(std::mt19937_64& random, const CompactTree& tree);

}  // namespace thimble::tests
