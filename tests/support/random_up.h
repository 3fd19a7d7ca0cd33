/// What is up in the pictures of random cameras.
#pragma once

#include <random>

#include "support/ray_cases.h"
#include "thimble/base/vec.h"

namespace thimble::tests {

/// A third of the cameras is rolled, along a lattice direction or any; all 0, the default, is up in the others. Where the
/// z axis is up every row of a picture keeps one z direction, so these alone show what forgets to step it.
inline Vec3i random_up(std::mt19937_64& random) {
  Vec3i up{};
  const int roll = pick_int(random, 0, 5);
  for (int axis = 0; axis < 3 && roll < 2; ++axis) {
    up[axis] = roll == 0 ? pick_int(random, -1, 1) : pick_int(random, -1000, 1000);
  }
  return up;
}

}  // namespace thimble::tests
