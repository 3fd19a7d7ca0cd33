/// Traces many rays at a time through one compact tree: shadows, occlusion, mirrors, rays from files.
///
/// Vectors of rays walk through a map of the tree, which is made once (README.md beside this file). Every answer is the
/// core's, for every instruction set: what is hit, where, by which face and at which t. A ray that the vectors do not
/// take is traced by the core, within the same call.
///
/// Everything here is const and reentrant: any number of threads may trace through one map, each a share of
/// the rays. Nothing is allocated; a call takes less than 64 KiB of stack.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/base/memory.h"
#include "thimble/base/status.h"
#include "thimble/trace/ray.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::wide {

/// What the vectors read.
///
/// The world is cut into cubes of 16^3 voxels. A cube that holds something is a chunk, which is cut into 4^3 leaves of
/// 4^3 voxels. In all three numberings x comes first and z last.
struct MapCells {
  /// A word for each cube, and one word more. In the word of an empty cube the four
  /// bits from 4 * o on are the side, in cubes, of the largest empty cube that begins there and extends along octant o
  /// (bit a: to smaller coordinates on axis a), 1 .. 15; outside of the world all is empty. The word of another cube is
  /// 16 times the place where its chunk begins.
  const uint32_t* top = nullptr;
  /// Chunks one after the other. A chunk has a word with a bit for each leaf that holds something; with `has_nodes` the
  /// number of the tree's node of this cube, or a number above all nodes'; then for each of these leaves a word with a
  /// bit for each voxel; and with `has_tags` for each of them a word that says where its materials are (leaf_tag.h).
  /// The first chunk is solid through, and serves all such cubes; with `has_tags` each material has such a chunk.
  const uint64_t* chunks = nullptr;
  int level = 0;           ///< the map's world is 2^level voxels a side: the tree's, or 16
  bool has_nodes = false;  ///< the tree has several materials, or blocks made by coarsening
  bool has_tags = false;   ///< several materials, and no such blocks

  /// Words of a chunk before its leaves.
  uint64_t header() const { return has_nodes ? 2 : 1; }
};

/// The map of one tree, in bytes that the caller gave; both outlive it. Copy it freely.
class RayMap {
 public:
  RayMap() = default;
  /// Has no map, so the core traces every ray: for trees that `make` refuses, and where there is no room.
  explicit RayMap(const CompactTree& tree) : tree_(tree) {}

  /// Makes the map; takes at most `bytes(tree)` from the arena. kOutOfMemory when that does not fit, kDamaged for a
  /// tree whose masks do not add up; nothing is taken then, and `map` is as it was.
  static Status make(const CompactTree& tree, Arena* arena, RayMap* map);
  /// The most bytes that `make` takes. Reads all masks.
  static size_t bytes(const CompactTree& tree);

  const CompactTree& tree() const { return tree_; }
  /// Null without a map.
  const MapCells* cells() const { return cells_.top == nullptr ? nullptr : &cells_; }
  /// As `thimble::material_at`: whether a voxel is solid, and then its material.
  bool material_at(const Vec3i& voxel, uint8_t* material) const;
  /// Whether no voxel of a box is solid; false without a map.
  bool is_empty(const VoxelBox& box) const;

 private:
  CompactTree tree_;
  MapCells cells_;
};

// For all functions that follow: `rays` are those of ray.h, and the spans of a call are equally long. A ray that
// `check_ray` refuses counts as a miss, and the call returns the status of the first such ray; the other rays are
// answered. Visits are steps of this engine, or nodes where the core answered.

/// Finds whether each ray meets anything: 1 or 0, as `thimble::any_hit`. With `classes`, one of 256, `classes[material]` of
/// the solid voxel that it enters first in place of 1: a shadow asks no more of materials.
Status any_hit(const RayMap& map, Span<const Ray> rays, Span<uint8_t> hit, const uint8_t* classes = nullptr);

/// The same for what each ray enters at a t below `before[i]`, as `thimble::any_hit_before`: for point lights.
Status any_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before, Span<uint8_t> hit,
                      const uint8_t* classes = nullptr);

/// Finds the solid voxel that each ray enters first, as `closest_hit` in kind, voxel, axis, t, material and block
/// level.
Status first_hit(const RayMap& map, Span<const Ray> rays, Span<Hit> hits);

/// The same from each ray's point `from[i]` on, as `closest_hit_from`.
Status first_hit_from(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> from, Span<Hit> hits);

/// Finds the hits of `first_hit`; a voxel that is entered at a t of `before[i]` or later is a miss.
Status first_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before, Span<Hit> hits);

/// The same with one bound for all rays, and with materials only if they are wanted.
Status first_hit_within(const RayMap& map, Span<const Ray> rays, const RayPoint& before, Span<Hit> hits,
                        bool with_materials);

/// Finds where each ray enters the first solid voxel, if before the point `before`: t as in `Hit`, without the voxel,
/// its face and its material; denominator 0 for a miss. Occlusion asks this: how far away is what is near? With
/// `classes`, a voxel whose material has 0 among the 256 counts as a miss.
Status first_entry_before(const RayMap& map, Span<const Ray> rays, RayPoint before, Span<RayPoint> entries,
                          const uint8_t* classes = nullptr);

}  // namespace thimble::wide
