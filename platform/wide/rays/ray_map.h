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
  /// A word for each cube, in one numbering after the other, and one word more. In the word of an empty cube the four
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

/// At most so many materials of a map have a layer, and only in worlds of at most so many levels.
inline constexpr size_t kMostMedia = 15;
inline constexpr int kMostMediaLevel = 11;

/// The map of one tree, in bytes that the caller gave; both outlive it. Copy it freely.
class RayMap {
 public:
  RayMap() = default;
  /// Has no map, so the core traces every ray: for trees that `make` refuses, and where there is no room.
  explicit RayMap(const CompactTree& tree) : tree_(tree) {}

  /// Makes the map; takes at most `bytes(tree)` from the arena. kOutOfMemory when that does not fit, kDamaged for a
  /// tree whose masks do not add up; nothing is taken then, and `map` is as it was. `media` are materials that rays
  /// go through. Those that the tree holds get a layer each, up to kMostMedia of them and in worlds of up to
  /// kMostMediaLevel, so that `first_change` finds in vectors where rays leave them. A layer takes 4 bytes for each
  /// 16^3 voxels of the world, and chunks where the medium ends.
  static Status make(const CompactTree& tree, Arena* arena, RayMap* map, Span<const uint8_t> media = {});
  /// The most bytes that `make` takes. Reads all masks, and with `media` the tree twice more.
  static size_t bytes(const CompactTree& tree, Span<const uint8_t> media = {});

  const CompactTree& tree() const { return tree_; }
  /// Null without a map.
  const MapCells* cells() const { return cells_.top == nullptr ? nullptr : &cells_; }
  /// As `thimble::material_at`: whether a voxel is solid, and then its material.
  bool material_at(const Vec3i& voxel, uint8_t* material) const;
  /// Whether no voxel of a box is solid; false without a map.
  bool is_empty(const VoxelBox& box) const;
  /// The number of the layer in which all but the material is solid; 0: the material has no layer.
  uint8_t layer_of(uint8_t material) const { return layers_[material]; }

 private:
  CompactTree tree_;
  MapCells cells_;
  uint8_t layers_[256] = {};
};

// For all functions that follow: `rays` are those of ray.h, and the spans of a call are equally long. A ray that
// `check_ray` refuses counts as a miss, and the call returns the status of the first such ray; the other rays are
// answered. Visits are steps of this engine, or nodes where the core answered.

/// Finds whether each ray meets anything: 1 or 0, as `thimble::any_hit`.
Status any_hit(const RayMap& map, Span<const Ray> rays, Span<uint8_t> hit);

/// Finds whether each ray enters anything solid at a t below `before[i]`, as `thimble::any_hit_before`: for point
/// lights, and for occlusion within a reach.
Status any_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before,
                      Span<uint8_t> hit);

/// Finds the solid voxel that each ray enters first, as `closest_hit` in kind, voxel, axis, t, material and block
/// level.
Status first_hit(const RayMap& map, Span<const Ray> rays, Span<Hit> hits);

/// The same, where nothing that a ray could hit comes before its point `from[i]`, at which it crosses a voxel's plane.
Status first_hit_from(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> from, Span<Hit> hits);

/// Finds the hits of `first_hit`; a voxel that is entered at a t of `before[i]` or later is a miss.
Status first_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before, Span<Hit> hits);

/// The same with one bound for all rays, and with materials only if they are wanted.
Status first_hit_within(const RayMap& map, Span<const Ray> rays, const RayPoint& before, Span<Hit> hits,
                        bool with_materials);

/// Finds `classes[material]`, one of 256, of the solid voxel that each ray enters first, or 0 for a miss: a shadow asks
/// no more of materials.
Status first_class(const RayMap& map, Span<const Ray> rays, const uint8_t* classes, Span<uint8_t> found);

/// The same, but a voxel that is entered at a t of `before[i]` or later is a miss.
Status first_class_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before,
                          const uint8_t* classes, Span<uint8_t> found);

/// Finds where each ray enters the first solid voxel, if before the point `before`: t as in `Hit`, without the voxel,
/// its face and its material; denominator 0 for a miss. Occlusion asks this: how far away is what is near? With
/// `classes`, a voxel whose material has 0 among the 256 counts as a miss.
Status first_entry_before(const RayMap& map, Span<const Ray> rays, RayPoint before, Span<RayPoint> entries,
                          const uint8_t* classes = nullptr);

/// For `first_change`: the ray is in nothing solid. (Other numbers are the material that it is in.)
inline constexpr uint16_t kInAir = 256;

/// Finds where each ray, from `from[i]` on, comes to something else: in a material `in[i]` as `leave_medium`, in
/// kInAir as `closest_hit_from`, where a hit sets `into_solid` to true.
Status first_change(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> from,
                    Span<const uint16_t> in, Span<MediumExit> exits);

}  // namespace thimble::wide
