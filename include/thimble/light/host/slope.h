/// @file slope.h
/// The slope of a surface of voxels: the gradient of what is solid around a point of it. What
/// Effect::kSmoothNormals asks for at every hit; src/light/README.md says how it was chosen.
#ifndef THIMBLE_LIGHT_HOST_SLOPE_H
#define THIMBLE_LIGHT_HOST_SLOPE_H

#include <stdint.h>

#include "../../base/memory.h"
#include "../../base/vec.h"
#include "../../picture/shading.h"
#include "../../tree/compact_tree.h"
#include "../scene.h"

namespace thimble::lit {

/// Voxels whose centres are this near to the point count, in 1/2 voxel.
inline constexpr int32_t kSlopeReachHalves = 11;
/// Where the surface leaves its course by so many voxels from one column to the next is an edge, which keeps
/// its faces: what turns from the level by more than this to 1, 71 degrees, at once.
inline constexpr int kEdgeStep = 3;
/// Nodes that `surface_normal` reads at most in a world of 2^level.
constexpr uint32_t most_slope_visits(int level) {
  // Of 2, 4 and 8 voxels a side 6, 4 and 3 each way; of all larger ones 2; the root.
  return 216 + 64 + 27 + 8 * static_cast<uint32_t>(level > 4 ? level - 4 : 0) + 1;
}

/// Which voxels belong to the body that has the surface.
struct Body {
  Span<const Surface> surfaces;
  EffectSet effects = Effect::kNone;  ///< which of them are clear
  uint16_t index_q12 = 0;             ///< 0: all that is not clear; else what is clear and has this index

  bool holds(uint8_t material) const;
  /// Whether all that is solid belongs to it.
  bool holds_all() const {
    return index_q12 == 0 && (surfaces.size == 0 || (effects & (Effect::kGlass | Effect::kMedia)) == 0);
  }
  bool has(const CompactTree& tree, const Vec3i& voxel) const;
};

/// The outward normal of the body at a point on one of its faces: a unit in Q14, the face's own exactly where
/// the surface is flat as far as it is looked at, and where an edge leaves nothing else. On a ball of radius 6
/// and more it is within 6 degrees of the true normal. The point counts to 1/64 voxel. Adds the nodes read,
/// at most `most_slope_visits`, some 100 on a bent surface, to `*visits`; some 15,000 instructions.
Vec3i surface_normal(const CompactTree& tree, const Body& body, const Vec3Q8& at, const Face& face,
                     uint32_t* visits);

}  // namespace thimble::lit

#endif
