/// Large worlds that are solid through, and a crowded one: what lists of surfaces are for. Each is a compact
/// tree's bytes, the same at every call.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "thimble/tree/compact_tree.h"

namespace thimble::tests {

/// A ball that fills the world of 2^level voxels a side.
std::vector<std::uint8_t> full_ball(int level);
/// Hills on ground: 200 voxels of it in a world of 1024, less in smaller ones.
std::vector<std::uint8_t> thick_terrain(int level);
/// Blocks of houses along streets, with ledges and recessed windows, on thin ground.
std::vector<std::uint8_t> city(int level);
/// What a tree's voxels enclose is filled too: all that cannot be reached from outside through faces.
std::vector<std::uint8_t> filled(const CompactTree& tree);
/// Points in a world of 1024: nine in ten in 48 Plummer spheres (middles uniform in the world, radii uniform in
/// 8 to 48 voxels, shares proportional to a uniform number), the rest uniform. What falls outside is left out.
std::vector<std::uint8_t> plummer_spheres(std::uint64_t points);

}  // namespace thimble::tests
