// Every public function of trace with any rays, limits and damaged trees: refused, or answered within the
// bytes.
#include <doctest/doctest.h>

#include <cstdint>

#include "misuse/odd_worlds.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

template <class Structure>
void trace_in(OddValues& odd, const Structure& structure, int level) {
  const Ray ray = odd_ray(odd, level);
  const TraceOptions options = odd_options(odd);
  Hit hit;
  hit.visits = 77;
  const Status status = closest_hit(structure, ray, &hit, options);
  if (check_ray(ray, level) != Status::kOk) {
    CHECK(status == check_ray(ray, level));
    CHECK(hit.visits == 77);
  } else if (status == Status::kOk) {
    CHECK(hit.visits <= options.max_visits);
  }
  HitKind kind = HitKind::kMiss;
  std::uint32_t visits = 0;
  const Status any = any_hit(structure, ray, &kind, odd.one_in(2) ? &visits : nullptr, options);
  CHECK(any == status);
  if (any == Status::kOk) {
    CHECK(kind == hit.kind);
  }
}

// A point of `ray`, as its hits have them: within the terms that the header names.
RayPoint odd_point(OddValues& odd, const Ray& ray) {
  if (odd.one_in(3)) {
    return {};
  }
  const int axis = odd.between_32(0, 2);
  const std::int32_t speed = ray.direction[axis];
  return speed == 0 ? RayPoint{} : RayPoint{odd.between_32(0, 1 << 23), 256 * (speed < 0 ? -speed : speed)};
}

void go_on_in(OddValues& odd, const CompactTree& tree) {
  const int level = tree.level();
  const Ray ray = good_ray(odd, level);
  const TraceOptions options = odd_options(odd);
  const RayPoint from = odd_point(odd, ray);
  MediumExit exit;
  Hit hit;
  HitKind kind = HitKind::kMiss;
  (void)leave_medium(tree, ray, odd.any<std::uint8_t>(), &exit, from, options);
  (void)closest_hit_from(tree, ray, from, &hit, options);
  (void)any_hit_before(tree, ray, {odd.between_32(0, INT32_MAX), odd.between_32(1, INT32_MAX)}, &kind,
                       nullptr, options);
  (void)closest_hit_32(tree, odd_ray(odd, level), &hit, options.max_visits);
  (void)accepts_32(ray, level);
  (void)material_at(tree, odd.any_vector(), nullptr);
  (void)starting_voxel(ray);
  if (closest_hit(tree, ray, &hit) == Status::kOk && hit.kind == HitKind::kHit) {
    const Vec3Q8 start = start_on_face(ray, hit);
    const Vec3Q8 other = good_ray(odd, level).origin;
    Ray next;
    RayPoint place;
    if (ray_towards(start, other, odd.between_32(2, 20), &next, &place)) {
      CHECK(check_ray(next, level) == Status::kOk);
      (void)any_hit_before(tree, next, place, &kind, nullptr, options);
    }
  }
}

}  // namespace

TEST_CASE("misuse: any ray in sound, empty and damaged trees -> refused, or answered") {
  misuse(10, 500, [](OddValues& odd) {
    const int level = odd.between_32(kMinLevel, 6);
    OddWorld world(odd, level);
    for (int pass = 0; pass < 2; ++pass) {
      for (int i = 0; i < 40; ++i) {
        trace_in(odd, world.octree, level);
        trace_in(odd, world.grid, level);
        trace_in(odd, world.compact, level);
        trace_in(odd, world.shared, level);
        go_on_in(odd, world.compact);
      }
      world.damage(odd);
    }
  });
}

TEST_CASE("misuse: structures that were never made -> every ray misses or is refused") {
  const Octree octree;
  const CompactTree compact;
  const SharedTree shared;
  const DenseGrid grid;
  misuse(11, 2000, [&](OddValues& odd) {
    trace_in(odd, octree, octree.level());
    trace_in(odd, compact, compact.level());
    trace_in(odd, shared, shared.level());
    trace_in(odd, grid, grid.level());
    go_on_in(odd, compact);
  });
}
