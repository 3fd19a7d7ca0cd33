/// What the cases of several topics share: worlds of boxes in all three structures, and a ray traced in every
/// way that takes it.
#pragma once

#include "portable/case.h"
#include "portable/rays.h"

namespace thimble::portable {

/// The largest level of which a dense grid is built beside the trees.
inline constexpr int kMaxDenseLevel = 5;

/// Bytes that `build` takes for a world: the octree's pool, the compact tree, and the dense grid up to
/// kMaxDenseLevel.
constexpr uint32_t scene_bytes(int level, uint32_t pool_nodes) {
  const uint32_t dense = level > kMaxDenseLevel ? 0 : (uint32_t{1} << (3 * level)) / 8;
  // A mask, a share of the directory and at most two voxels with materials a node.
  const uint32_t compact = 80 + 4 * pool_nodes;
  return ((dense + 7) & ~7U) + ((8 * pool_nodes + 3 + 7) & ~7U) + ((compact + 7) & ~7U);
}

/// An empty octree of `nodes` in `check.world.pool`, in bytes of the case's arena.
bool make_pool(Check& check, uint32_t nodes, int level);
/// The same with boxes in it.
struct SolidBox {
  VoxelBox box;
  uint8_t material;
};
bool make_pool(Check& check, uint32_t nodes, int level, Span<const SolidBox> boxes, const Vec3i& corner = {});
/// `check.world.compact` from `check.world.pool`.
bool make_compact(Check& check, int rank_shift = kDefaultRankShift);
/// An empty dense grid in `check.world.grid`.
bool make_grid(Check& check, const Vec3i& size);
/// All of them from boxes; the grid up to kMaxDenseLevel.
bool build(Check& check, const RayScene& scene);

/// Whether `hit` is what a ray with `direction` is to meet; the denominator is also held to its definition.
void expect_hit(Check& check, const Hit& hit, const Vec3i& direction, const RayCase& wanted);
/// A structure of `check.world` traced by number: 0 dense, 1 pool, 2 compact. Into `check.hit`.
Status closest(Check& check, int structure, const Ray& ray, const TraceOptions& options);
Status any(Check& check, int structure, const Ray& ray, HitKind* kind, uint32_t* visits,
           const TraceOptions& options);
/// Whether two hits are the same in all but the number of visits.
bool same_hit(const Hit& one, const Hit& other);

/// Two cameras along x in a world of level 6: of 2 x 2 pixels at 90 degrees, and of 4 x 2 pixels of a voxel each.
constexpr PerspectiveView simple_perspective() {
  PerspectiveView view{
      {Q8::saturate(32), Q8::saturate(32), Q8::saturate(32)}, {1, 0, 0}, {}, Q16::saturate(90), 2, 2};
  return view;
}
constexpr OrthographicView simple_orthographic() {
  OrthographicView view{
      {Q8::saturate(32), Q8::saturate(32), Q8::saturate(32)}, {1, 0, 0}, {}, Q14::saturate(4), 4, 2};
  return view;
}

/// A ray whose origin is in 1/256 voxel.
constexpr Ray ray_q8(const Vec3i& origin_q8, const Vec3i& direction) {
  return {{Q8::from_raw(origin_q8.x), Q8::from_raw(origin_q8.y), Q8::from_raw(origin_q8.z)}, direction};
}
constexpr Vec3Q8 point_q8(int32_t x, int32_t y, int32_t z) {
  return {Q8::from_raw(x), Q8::from_raw(y), Q8::from_raw(z)};
}

}  // namespace thimble::portable
