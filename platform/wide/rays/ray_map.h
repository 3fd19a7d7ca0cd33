/// @file ray_map.h
/// Many rays at a time through one compact tree: shadows, occlusion, mirrors, rays from files.
///
/// A map of the tree, made once, is what vectors of rays walk through (README.md beside this file). Every
/// answer is the core's, for every instruction set: what is hit, where, by which face and at which t. A ray
/// that the vectors do not take is traced by the core, within the same call.
///
/// Everything here is const and reentrant: any number of threads may trace through one map, each a share of
/// the rays. Nothing is allocated; a call takes less than 64 KiB of stack.
#ifndef THIMBLE_PLATFORM_WIDE_RAYS_RAY_MAP_H
#define THIMBLE_PLATFORM_WIDE_RAYS_RAY_MAP_H

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
/// The world is cut into cubes of 16^3 voxels, a cube that holds something (a brick) into 4^3 leaves of 4^3
/// voxels. In all three numberings x comes first and z last.
struct MapCells {
  /// A word a cube, in one numbering after the other, and one more. Of an empty one, the four bits from 4 * o
  /// on are the side, in cubes, of the largest empty cube that begins there and extends along octant o (bit
  /// a: to smaller coordinates on axis a), 1 .. 15; what lies outside the world is empty. Else 16 times where
  /// its brick begins.
  const uint32_t* top = nullptr;
  /// Bricks one after the other: a bit for each leaf that holds something; with `has_nodes` the number of the
  /// tree's node of this cube, or more than any of them; then for each of these leaves its voxels, a bit
  /// each, and with `has_tags` for each where its materials are (leaf_tag.h). The first brick is solid
  /// through, and serves all such cubes; with `has_tags` there is one for each material.
  const uint64_t* bricks = nullptr;
  int level = 0;           ///< the map's world is 2^level voxels a side: the tree's, or 16
  bool has_nodes = false;  ///< the tree has several materials, or blocks made by coarsening
  bool has_tags = false;   ///< several materials, and no such blocks

  /// Words of a brick before its leaves.
  uint64_t header() const { return has_nodes ? 2 : 1; }
};

/// So many materials of a map, at most, have a layer, and in worlds of so many levels.
inline constexpr size_t kMostMedia = 15;
inline constexpr int kMostMediaLevel = 11;

/// The map of one tree, in bytes that the caller gave; both outlive it. Copy it freely.
class RayMap {
 public:
  RayMap() = default;
  /// Without a map: the core traces every ray. For trees that `make` refuses, and where there is no room.
  explicit RayMap(const CompactTree& tree) : tree_(tree) {}

  /// Makes the map; takes at most `bytes(tree)` from the arena. kOutOfMemory when that does not fit, kDamaged
  /// for a tree whose masks do not add up; nothing is taken then, and `map` is as it was.
  /// `media` are materials that rays go through: those that the tree holds, kMostMedia of them and in worlds
  /// to kMostMediaLevel, get a layer each, 4 bytes for each 16^3 voxels of the world and bricks where they
  /// end: so `first_change` finds in vectors where rays leave them.
  static Status make(const CompactTree& tree, Arena* arena, RayMap* map, Span<const uint8_t> media = {});
  /// What `make` takes at most. Reads all masks; with `media` the tree twice more.
  static size_t bytes(const CompactTree& tree, Span<const uint8_t> media = {});

  const CompactTree& tree() const { return tree_; }
  /// Null without a map.
  const MapCells* cells() const { return cells_.top == nullptr ? nullptr : &cells_; }
  /// As `thimble::material_at`: whether a voxel is solid, and then its material.
  bool material_at(const Vec3i& voxel, uint8_t* material) const;
  /// The numbering of cubes in which all but the material is solid; 0: there is none.
  uint8_t layer_of(uint8_t material) const { return layers_[material]; }

 private:
  CompactTree tree_;
  MapCells cells_;
  uint8_t layers_[256] = {};
};

// In all that follow, `rays` are those of ray.h and the spans of a call are equally long. A ray that
// `check_ray` refuses counts as a miss, and the call returns its status (the first such ray's); the others
// are answered. Visits are steps of this engine, or nodes where the core answered.

/// Whether each ray meets anything: 1 or 0, as `thimble::any_hit`.
Status any_hit(const RayMap& map, Span<const Ray> rays, Span<uint8_t> hit);

/// Whether each ray enters anything solid at a t below `before[i]` (as `thimble::any_hit_before`): point
/// lights, occlusion within a reach.
Status any_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before,
                      Span<uint8_t> hit);

/// The solid voxel that each ray enters first: as `closest_hit` in kind, voxel, axis, t, material and block
/// level.
Status first_hit(const RayMap& map, Span<const Ray> rays, Span<Hit> hits);

/// The same without materials (0), where `unnamed_material` knows them: so each is looked up where it is
/// wanted.
Status first_unnamed_hit(const RayMap& map, Span<const Ray> rays, Span<Hit> hits);

/// The material of a kHit of `first_unnamed_hit`.
uint8_t unnamed_material(const RayMap& map, const Hit& hit);

/// The hits of `first_hit`, where what is entered at a t of `before[i]` or later is a miss.
Status first_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before, Span<Hit> hits);

/// The same within one bound, and without materials unless they are wanted.
Status first_hit_within(const RayMap& map, Span<const Ray> rays, const RayPoint& before, Span<Hit> hits,
                        bool with_materials);

/// `classes[material]`, one of 256, of the solid voxel that each ray enters first, 0 for a miss: what a shadow
/// asks of materials.
Status first_class(const RayMap& map, Span<const Ray> rays, const uint8_t* classes, Span<uint8_t> found);

/// The same, where what is entered at a t of `before[i]` or later is a miss.
Status first_class_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before,
                          const uint8_t* classes, Span<uint8_t> found);

/// Where each ray enters the first solid voxel, if before the point `before`: t as in `Hit`, without the
/// voxel, its face and material; denominator 0 for a miss. For occlusion, which asks how far away what is
/// near is. With `classes`, a voxel whose material has 0 among the 256 counts as a miss.
Status first_entry_before(const RayMap& map, Span<const Ray> rays, RayPoint before, Span<RayPoint> entries,
                          const uint8_t* classes = nullptr);

/// The first solid voxel in which each ray spends a positive length after `from[i]`: as `closest_hit_from`.
/// So a ray goes on behind glass that it passed.
Status first_hit_from(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> from, Span<Hit> hits);

/// What rays are in that go on, for `first_change`: a material, or nothing solid.
inline constexpr uint16_t kInAir = 256;

/// Where each ray comes to something else, from `from[i]` on: in a material `in[i]` the `leave_medium` of it,
/// in kInAir the `closest_hit_from`, which leaves `into_solid` true with a hit.
Status first_change(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> from,
                    Span<const uint16_t> in, Span<MediumExit> exits);

}  // namespace thimble::wide

#endif
