// The calls, and what they need ray by ray: the core's answers, and the face, t and material of a voxel.
#include "wide/rays/ray_map.h"

#include <algorithm>

#include "thimble/trace/trace.h"
#include "wide/rays/job.h"

namespace thimble::wide {
namespace {

Status run(Job* job) {
  if (job->any != nullptr) {
    std::fill_n(job->any, job->count, uint8_t{0});
  } else {
    std::fill_n(job->hits, job->count, Hit{});
  }
  if (job->map->cells() != nullptr) {
    trace_in_vectors(job);
  } else {
    for (size_t i = 0; i < job->count; ++i) {
      trace_by_core(job, i);
    }
  }
  return job->status;
}

// The solid block that holds a voxel: itself, or one that coarsening made.
struct Block {
  Vec3i corner;
  int level;
  uint8_t material;
};

Block block_at(const CompactTree& tree, const Vec3i& voxel) {
  Block block{voxel, 0, tree.uniform_material()};
  if (!tree.many_materials() && !tree.merged()) {
    return block;
  }
  uint32_t node = 0;
  for (int level = tree.level(); level >= 1 && node < tree.node_count(); --level) {
    const unsigned mask = tree.mask(node);
    if (mask == 0) {
      block.material = tree.block_material(node);
      if (tree.is_merged(node)) {
        const int32_t within = (int32_t{1} << level) - 1;
        block.corner = {voxel.x & ~within, voxel.y & ~within, voxel.z & ~within};
        block.level = level;
      }
      return block;
    }
    const unsigned octant = (static_cast<unsigned>(voxel.x) >> (level - 1) & 1U) |
                            (static_cast<unsigned>(voxel.y) >> (level - 1) & 1U) << 1 |
                            (static_cast<unsigned>(voxel.z) >> (level - 1) & 1U) << 2;
    node = tree.first_child(node) + static_cast<uint32_t>(__builtin_popcount(mask & ((1U << octant) - 1)));
  }
  block.material = tree.voxel_material(node);
  return block;
}

// The face by which a ray enters a block, and its t: the lower plane that it crosses last, of several the one of
// the lowest axis. Compares products of 23 and 20 bits.
void find_face(const Ray& ray, const Vec3i& corner, int32_t side, Hit* hit) {
  int64_t last = 0;
  int64_t speed = 1;
  int axis = -1;
  for (int a = 0; a < 3; ++a) {
    const int64_t direction = ray.direction[a];
    const int64_t origin = ray.origin[a].raw;
    const int64_t low = int64_t{corner[a]} * Q8::kOne;
    const int64_t way = direction < 0 ? origin - (low + int64_t{side} * Q8::kOne) : low - origin;
    const int64_t size = direction < 0 ? -direction : direction;
    if (way > 0 && (axis < 0 || way * speed > last * size)) {
      axis = a;
      last = way;
      speed = size;
    }
  }
  hit->axis = static_cast<int8_t>(axis);
  hit->t_numerator = axis < 0 ? 0 : static_cast<int32_t>(last);
  hit->t_denominator = axis < 0 ? 1 : static_cast<int32_t>(speed * Q8::kOne);
}

}  // namespace

void trace_by_core(Job* job, size_t ray) {
  const CompactTree& tree = job->map->tree();
  Hit hit;
  const Status status = job->bound == Bound::kFrom
                            ? closest_hit_from(tree, job->rays[ray], job->points[ray], &hit)
                            : closest_hit(tree, job->rays[ray], &hit);
  if (job->status == Status::kOk) {
    job->status = status;
  }
  if (hit.kind == HitKind::kHit && job->bound == Bound::kBefore &&
      !is_before(hit.t_numerator, hit.t_denominator, job->points[ray])) {
    const uint32_t visits = hit.visits;
    hit = Hit{};
    hit.visits = visits;
  }
  if (job->any != nullptr) {
    job->any[ray] = hit.kind == HitKind::kHit ? 1 : 0;
  } else {
    job->hits[ray] = hit;
  }
}

void put_hit(Job* job, size_t number, const Vec3i& cell, uint32_t visits) {
  const Ray& ray = job->rays[number];
  const int32_t last = (int32_t{1} << job->map->cells()->level) - 1;
  Vec3i voxel = cell;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] < 0) {
      voxel[axis] = last - cell[axis];
    }
  }
  Hit hit;
  hit.visits = visits;
  if (job->any != nullptr) {
    find_face(ray, voxel, 1, &hit);  // of a merged block it is entered at the same t
  } else {
    const Block block = block_at(job->map->tree(), voxel);
    hit.voxel = block.corner;
    hit.block_level = static_cast<uint8_t>(block.level);
    hit.material = block.material;
    find_face(ray, block.corner, int32_t{1} << block.level, &hit);
  }
  hit.kind = HitKind::kHit;
  if (job->bound == Bound::kBefore && !is_before(hit.t_numerator, hit.t_denominator, job->points[number])) {
    hit = Hit{};
    hit.visits = visits;
  }
  if (job->any != nullptr) {
    job->any[number] = hit.kind == HitKind::kHit ? 1 : 0;
  } else {
    job->hits[number] = hit;
  }
}

Status any_hit(const RayMap& map, Span<const Ray> rays, Span<uint8_t> hit) {
  Job job{&map, rays.data, rays.size, nullptr, Bound::kNone, hit.data, nullptr};
  return run(&job);
}

Status any_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before,
                      Span<uint8_t> hit) {
  Job job{&map, rays.data, rays.size, before.data, Bound::kBefore, hit.data, nullptr};
  return run(&job);
}

Status first_hit(const RayMap& map, Span<const Ray> rays, Span<Hit> hits) {
  Job job{&map, rays.data, rays.size, nullptr, Bound::kNone, nullptr, hits.data};
  return run(&job);
}

Status first_hit_before(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> before,
                        Span<Hit> hits) {
  Job job{&map, rays.data, rays.size, before.data, Bound::kBefore, nullptr, hits.data};
  return run(&job);
}

Status first_hit_from(const RayMap& map, Span<const Ray> rays, Span<const RayPoint> from, Span<Hit> hits) {
  Job job{&map, rays.data, rays.size, from.data, Bound::kFrom, nullptr, hits.data};
  return run(&job);
}

}  // namespace thimble::wide
