// Rays that no path takes, and pools whose chains lead nowhere.
#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "support/scene_under_test.h"
#include "thimble/trace/ray.h"
#include "thimble/tree/octree.h"

namespace thimble::tests::trace_edges {
namespace {

Ray along_x(std::int32_t y_q8, std::int32_t z_q8, std::int32_t direction = 1) {
  Ray ray;
  ray.origin = {Q8::from_raw(-256), Q8::from_raw(y_q8), Q8::from_raw(z_q8)};
  ray.direction = {direction, 0, 0};
  return ray;
}

TEST_CASE("trace edges: the 32-bit path with rays it does not take -> a status, and the hit as it was") {
  OwnedPool pool(12);
  REQUIRE(pool.octree.insert({5, 1, 1}, 3) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const CompactTree tree = open_or_throw(bytes);
  Hit hit;
  hit.visits = 77;
  CHECK(closest_hit_32(tree, along_x(300, 300, 0), &hit) == Status::kBadArgument);
  Ray far = along_x(300, 300);
  far.origin.y = Q8::from_raw(5 * (256 << 12) + 1);
  CHECK(closest_hit_32(tree, far, &hit) == Status::kOutOfRange);
  // From 1 voxel before the world its far plane is 2^20 + 2^8 away, which takes 21 bits: 10 are left for the
  // direction.
  CHECK(closest_hit_32(tree, along_x(300, 300, 1024), &hit) == Status::kOutOfRange);
  CHECK(hit.visits == 77);
  CHECK(hit.kind == HitKind::kMiss);
  REQUIRE(closest_hit_32(tree, along_x(300, 300, 1023), &hit) == Status::kOk);
  CHECK(hit.kind == HitKind::kHit);
  CHECK(hit.voxel == Vec3i{5, 1, 1});
  CHECK(hit.t_numerator == 6 * 256);
  CHECK(hit.t_denominator == 1023 * 256);
  CHECK(closest_hit_32(tree, along_x(300, 300, 1023), &hit, 2) == Status::kOk);
  CHECK(hit.kind == HitKind::kStepLimit);
}

// Three voxels in a row of octants; what follows the cut in the chain is not there, and rays pass it.
TEST_CASE("trace edges: a pool whose chain breaks off -> what is left is hit, the rest is space") {
  for (int kept = 1; kept <= 3; ++kept) {
    OwnedPool pool(3);
    for (const Vec3i& at : {Vec3i{0, 0, 0}, Vec3i{4, 0, 0}, Vec3i{0, 4, 0}}) {
      REQUIRE(pool.octree.insert(at, 6) == Status::kOk);
    }
    std::uint32_t last = pool.octree.node(pool.octree.root()).first_child;
    for (int i = 1; i < kept; ++i) {
      last = pool.octree.node(last).next;
    }
    pool.cut_chain(last, Octree::kNone);
    const auto seen = [&](const Vec3i& voxel) {
      Hit hit;
      Ray ray = along_x(voxel.y * 256 + 100, voxel.z * 256 + 100);
      if (voxel.x != 0) {
        ray.origin.x = Q8::from_raw(2 * 256);
      }
      REQUIRE(closest_hit(pool.octree, ray, &hit) == Status::kOk);
      HitKind kind = HitKind::kStepLimit;
      REQUIRE(any_hit(pool.octree, ray, &kind) == Status::kOk);
      CHECK(kind == hit.kind);
      return hit.kind == HitKind::kHit && hit.voxel == voxel;
    };
    CAPTURE(kept);
    CHECK(seen({0, 0, 0}));
    CHECK(seen({4, 0, 0}) == (kept > 1));
    CHECK(seen({0, 4, 0}) == (kept > 2));
  }
}

}  // namespace
}  // namespace thimble::tests::trace_edges
