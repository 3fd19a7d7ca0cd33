// Rays from a point on: each limit of the narrow path from both sides, and points out of the world.
#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "support/scene_under_test.h"
#include "thimble/trace/secondary_ray.h"
#include "thimble/tree/octree.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// 8 voxels a side, solid in x = 4 .. 5.
HeapBytes slab() {
  OwnedPool octree_pool(3, 600);
  Octree& octree = octree_pool.octree;
  REQUIRE(octree.insert_box({{4, 0, 0}, {6, 8, 8}}, 7) == Status::kOk);
  return compact_of(octree);
}

CompactTree opened(const HeapBytes& bytes) {
  CompactTree tree;
  REQUIRE(CompactTree::open(bytes.view(), &tree) == Status::kOk);
  return tree;
}

Vec3Q8 at_q8(std::int32_t x, std::int32_t y, std::int32_t z) {
  return {Q8::from_raw(x), Q8::from_raw(y), Q8::from_raw(z)};
}

}  // namespace

TEST_CASE("from a point: numerator and each component alone -> 31 bits together are narrow, 32 are not") {
  const HeapBytes bytes = slab();
  const CompactTree tree = opened(bytes);
  TraceOptions narrow;
  narrow.width = Width::k32;
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::int32_t sign : {-1, 1}) {
      CAPTURE(axis);
      Ray ray;
      ray.origin = at_q8(1024, 1024, 1024);
      ray.direction = {1, 1, 1};
      ray.direction[axis] = sign * 32768;  // 16 bits
      Hit hit;
      MediumExit exit;
      // 15 bits and 16 bits; 16 and 16.
      for (const std::int32_t numerator : {32767, 32768}) {
        const RayPoint from = {numerator, 256};
        const Status wanted = numerator == 32767 ? Status::kOk : Status::kOutOfRange;
        CHECK(closest_hit_from(tree, ray, from, &hit, narrow) == wanted);
        CHECK(leave_medium(tree, ray, 7, &exit, from, narrow) == wanted);
      }
    }
  }
}

TEST_CASE(
    "from a point before the world -> hits what lies ahead of it; from one behind -> nothing, outside") {
  const HeapBytes bytes = slab();
  const CompactTree tree = opened(bytes);
  for (const bool mirrored : {false, true}) {
    for (int axis = 0; axis < 3; ++axis) {
      // Along the axis through the middle; only along x it meets the slab, from either side.
      Ray ray;
      ray.origin = at_q8(1152, 1152, 1152);
      ray.origin[axis] = Q8::from_raw(mirrored ? 8 * 256 + 512 : -512);
      ray.direction = {0, 0, 0};
      ray.direction[axis] = mirrored ? -1 : 1;
      CAPTURE(axis);
      CAPTURE(mirrored);
      Hit first;
      REQUIRE(closest_hit(tree, ray, &first) == Status::kOk);
      REQUIRE(first.kind == HitKind::kHit);
      CHECK(first.t_numerator / first.t_denominator == (axis != 0 ? 2 : mirrored ? 4 : 6));
      for (const Width width : {Width::k64, Width::k32}) {
        TraceOptions options;
        options.width = width;
        const auto hit_from = [&](const RayPoint& from) {
          Hit hit;
          CHECK(closest_hit_from(tree, ray, from, &hit, options) == Status::kOk);
          return hit;
        };
        const auto exit_from = [&](const RayPoint& from, std::uint8_t material) {
          MediumExit exit;
          CHECK(leave_medium(tree, ray, material, &exit, from, options) == Status::kOk);
          return exit;
        };
        // t = 1, a voxel before the world.
        const Hit ahead = hit_from({256, 256});
        CHECK(ahead.kind == HitKind::kHit);
        CHECK(ahead.voxel == first.voxel);
        CHECK(ahead.t_numerator == first.t_numerator);
        CHECK(ahead.visits > 0);
        const MediumExit before = exit_from({256, 256}, 7);
        CHECK(before.left_world);
        CHECK_FALSE(before.into_solid);
        CHECK(before.hit.kind == HitKind::kHit);
        CHECK(before.hit.axis == -1);
        CHECK(before.hit.voxel == starting_voxel(ray));
        // t = 11, a voxel behind it.
        CHECK(hit_from({11 * 256, 256}).kind == HitKind::kMiss);
        CHECK(exit_from({11 * 256, 256}, 7).left_world);
        // In the world, from t = 2 on: through what is not of that material to the first that is not air.
        const MediumExit inside = exit_from({512, 256}, 9);
        CHECK_FALSE(inside.left_world);
        CHECK(inside.into_solid == (axis != 0));
      }
    }
  }
}

TEST_CASE("from a point in an empty world -> nothing, whatever lies behind the tree's bytes") {
  OwnedPool octree_pool(3, 8);
  Octree& octree = octree_pool.octree;
  const HeapBytes exact = compact_of(octree);
  for (const int behind : {0x00, 0x01, 0x80, 0xFF}) {
    HeapBytes bytes(exact.view().size + 64);
    std::memset(bytes.span().data, behind, bytes.view().size);
    std::memcpy(bytes.span().data, exact.view().data, exact.view().size);
    const CompactTree tree = opened(bytes);
    Ray ray;
    ray.origin = at_q8(1000, 1000, 1000);
    ray.direction = {3, 2, -1};
    Hit hit;
    REQUIRE(closest_hit_from(tree, ray, {0, 1}, &hit) == Status::kOk);
    CHECK(hit.kind == HitKind::kMiss);
    MediumExit exit;
    REQUIRE(leave_medium(tree, ray, 0, &exit) == Status::kOk);
    CHECK(exit.hit.kind == HitKind::kHit);
    CHECK_FALSE(exit.into_solid);
    CHECK_FALSE(exit.left_world);
    CHECK(exit.hit.voxel == Vec3i{3, 3, 3});
  }
}
