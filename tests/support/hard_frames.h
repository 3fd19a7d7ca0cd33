/// Solid worlds, and cameras whose rays run along the lattice, through its points, along its diagonals and from inside
/// what is solid: what paths through a scene never show.
#pragma once

#include <random>

#include "support/wide_cases.h"

namespace thimble::tests {

/// Something solid within some forty voxels, around where cubes of entries meet if the world has several: boxes, balls
/// and stairs, now and then with holes.
WideScene solid_scene(std::mt19937_64& random, int level, wide::ListKind kind = wide::ListKind::kFastest);

/// A camera on the lattice or off it, in what is solid or near; false where the core refuses what was drawn.
bool hard_camera(std::mt19937_64& random, const WideScene& scene, Camera* camera);

}  // namespace thimble::tests
