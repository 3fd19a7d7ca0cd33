#include "portable/scene.h"

namespace thimble::portable {

bool make_pool(Check& check, uint32_t nodes, int level) {
  const Bytes bytes = check.arena.take(Octree::octree_bytes(nodes));
  return check.equal(Octree::make(level, bytes, &check.world.pool), Status::kOk, THIMBLE_WHAT("pool.init")) &&
         check.equal(check.world.pool.capacity(), nodes, THIMBLE_WHAT("nodes of the pool"));
}

bool make_pool(Check& check, uint32_t nodes, int level, Span<const SolidBox> boxes, const Vec3i& corner) {
  if (!make_pool(check, nodes, level)) {
    return false;
  }
  for (const SolidBox& one : boxes) {
    VoxelBox box = one.box;
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] += corner[axis];
      box.high[axis] += corner[axis];
    }
    if (!check.equal(check.world.pool.insert_box(box, one.material), Status::kOk,
                     THIMBLE_WHAT("insert_box"))) {
      return false;
    }
  }
  return true;
}

bool make_compact(Check& check, int rank_shift) {
  const size_t size = compact_bytes(compact_shape(check.world.pool, rank_shift));
  const Bytes bytes = check.arena.take(size);
  size_t written = 0;
  return check.equal(CompactTree::make(check.world.pool, bytes, nullptr, &written, rank_shift), Status::kOk,
                     THIMBLE_WHAT("compact_from_octree")) &&
         check.equal(written, size, THIMBLE_WHAT("bytes of the compact tree")) &&
         check.equal(CompactTree::open(bytes, &check.world.compact), Status::kOk, THIMBLE_WHAT("open"));
}

bool make_grid(Check& check, const Vec3i& size) {
  const Bytes bytes = check.arena.take(dense_grid_bytes(size));
  return check.equal(DenseGrid::make(size, bytes, &check.world.grid), Status::kOk, THIMBLE_WHAT("grid.init"));
}

bool build(Check& check, const RayScene& scene) {
  const int32_t side = int32_t{1} << scene.level;
  const bool dense = scene.level <= kMaxDenseLevel;
  if ((dense && !make_grid(check, {side, side, side})) || !make_pool(check, scene.pool_nodes, scene.level)) {
    return false;
  }
  for (int i = 0; i < scene.box_count; ++i) {
    const RayScene::Box& box = scene.boxes[i];
    const VoxelBox bounds{{box.low[0], box.low[1], box.low[2]}, {box.high[0], box.high[1], box.high[2]}};
    if (!check.equal(check.world.pool.insert_box(bounds, 0), Status::kOk, THIMBLE_WHAT("insert_box"))) {
      return false;
    }
    for (int32_t z = bounds.low.z; dense && z < bounds.high.z; ++z) {
      for (int32_t y = bounds.low.y; y < bounds.high.y; ++y) {
        for (int32_t x = bounds.low.x; x < bounds.high.x; ++x) {
          if (check.world.grid.set({x, y, z}) != Status::kOk) {
            return check.that(false, THIMBLE_WHAT("grid.set"));
          }
        }
      }
    }
  }
  return make_compact(check);
}

void expect_hit(Check& check, const Hit& hit, const Vec3i& direction, const RayCase& wanted) {
  THIMBLE_EQUAL(hit.kind, wanted.axis == kMiss ? HitKind::kMiss : HitKind::kHit);
  if (hit.kind != HitKind::kHit || wanted.axis == kMiss) {
    return;
  }
  THIMBLE_EQUAL(hit.voxel, (Vec3i{wanted.voxel[0], wanted.voxel[1], wanted.voxel[2]}));
  THIMBLE_EQUAL(hit.axis, wanted.axis);
  THIMBLE_EQUAL(hit.block_level, 0);
  THIMBLE_EQUAL(hit.material, 0);
  const int32_t along = hit.axis < 0 ? 0 : direction[hit.axis];
  THIMBLE_EQUAL(hit.t_denominator, hit.axis < 0 ? 1 : 256 * (along < 0 ? -along : along));
  // Equal fractions: numerators below 2^28, denominators below 2^28.
  THIMBLE_EQUAL(int64_t{hit.t_numerator} * wanted.denominator, int64_t{wanted.numerator} * hit.t_denominator);
}

Status closest(Check& check, int structure, const Ray& ray, const TraceOptions& options) {
  if (structure == 0) {
    return closest_hit(check.world.grid, ray, &check.hit, options);
  }
  if (structure == 1) {
    return closest_hit(check.world.pool, ray, &check.hit, options);
  }
  return closest_hit(check.world.compact, ray, &check.hit, options);
}

Status any(Check& check, int structure, const Ray& ray, HitKind* kind, uint32_t* visits,
           const TraceOptions& options) {
  if (structure == 0) {
    return any_hit(check.world.grid, ray, kind, visits, options);
  }
  if (structure == 1) {
    return any_hit(check.world.pool, ray, kind, visits, options);
  }
  return any_hit(check.world.compact, ray, kind, visits, options);
}

bool same_hit(const Hit& one, const Hit& other) {
  if (one.kind != other.kind) {
    return false;
  }
  return one.kind != HitKind::kHit ||
         (one.axis == other.axis && one.material == other.material && one.block_level == other.block_level &&
          one.voxel == other.voxel && one.t_numerator == other.t_numerator &&
          one.t_denominator == other.t_denominator);
}

}  // namespace thimble::portable
