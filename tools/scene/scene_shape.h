/// What a scene occupies, as those who look for a place to see it from need it.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "thimble/base/vec.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

class BuiltScene;
class SceneSource;

struct SceneShape {
  int level = 1;
  VoxelBox bounds;
  /// Corners of voxels whose convex hull is that of everything occupied; the corners of `bounds` where no
  /// compact tree was built. Empty where nothing is occupied.
  std::vector<Vec3i> corners{};
  /// Null where another structure was built.
  const CompactTree* tree = nullptr;
  int threads = 1;                            ///< that may look for a place
  std::shared_ptr<const BuiltScene> owner{};  ///< of `tree`, where it was built for the shape
};

std::array<Vec3i, 8> box_corners(const VoxelBox& box);

/// One pass over the blocks. In worlds of more than 1,024 a side corners are rounded outwards, to a
/// thousandth of the world. Memory for a while: 8 bytes a column of voxels, at most 8 MiB.
/// The tree must live as long as the shape.
SceneShape shape_of(const CompactTree& tree);
SceneShape shape_of(const BuiltScene& built);
/// The same for a frame of `source`: what all frames show is built once more in one, outside any budget, so that no
/// frame is framed otherwise than another.
SceneShape shape_of(const SceneSource& source, const BuiltScene& built);
SceneShape shape_of(const SceneSource& source, const CompactTree& tree);

}  // namespace thimble::tools
