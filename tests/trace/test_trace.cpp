// Every structure and every width of the core's tracer, held to the exact reference over random rays.
//
// THIMBLE_RAYS sets the number of rays, THIMBLE_SEED the seed of all of them.
#include <doctest/doctest.h>

#include <algorithm>

#include "reference/reference.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/trace/ray.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// Solid aligned blocks of several sizes among single voxels: trees with leaves on many levels.
std::vector<reference::Voxel> block_world(int level, std::mt19937_64& random) {
  std::vector<reference::Voxel> voxels;
  const std::int64_t blocks = pick(random, 1, 40);
  for (std::int64_t i = 0; i < blocks && voxels.size() < 60000; ++i) {
    const int block_level = pick_int(random, 0, std::min(level - 1, 4));
    const int side = 1 << block_level;
    reference::Voxel corner{};
    for (int& component : corner) {
      component = side * pick_int(random, 0, (1 << (level - block_level)) - 1);
    }
    add_box(corner, {corner[0] + side, corner[1] + side, corner[2] + side}, &voxels);
  }
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

// Rays up to what the 32-bit path takes: origins at most `worlds` world sizes away from the world, directions
// with all the bits that this leaves.
RayLimits narrow_limits(int level, std::int64_t worlds) {
  RayLimits limits;
  const std::int64_t side_q8 = std::int64_t{256} << level;
  const std::int64_t reach = worlds * side_q8 + side_q8;
  int bits = 0;
  while ((reach >> bits) > 0) {
    ++bits;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    limits.origin_low_q8[axis] = -worlds * side_q8;
    limits.origin_high_q8[axis] = reach;
  }
  limits.direction = std::min(reference::kMaxDirection, (std::int64_t{1} << (31 - bits)) - 1);
  return limits;
}

RayLimits wide_limits(int level) {
  return full_limits({1 << level, 1 << level, 1 << level});
}

struct RunTotals {
  reference::Statistics statistics;
  SceneUnderTest::Tally tally;
  std::int64_t aimed = 0;
  std::int64_t brute_forced = 0;
  std::int64_t judge_mismatches = 0;
  std::int64_t different_bytes = 0;
};

void run_world(std::uint64_t seed, std::int64_t rays, RunTotals& totals) {
  std::mt19937_64 random(seed);
  // Of six worlds two are cubes, two boxes of any sides, one large and thinly settled, one made of blocks.
  const std::int64_t family = pick(random, 0, 5);
  World world;
  int level = 0;
  if (family < 2) {
    level = pick_int(random, 1, 6);
    const auto kind = static_cast<WorldKind>(pick(random, 0, std::int64_t{kWorldKinds} - 1));
    world = make_world(kind, {1 << level, 1 << level, 1 << level}, random);
  } else if (family < 4) {
    const auto kind = static_cast<WorldKind>(pick(random, 0, std::int64_t{kWorldKinds} - 1));
    const std::int64_t longest = pick(random, 0, 1) == 0 ? 8 : 50;
    reference::Voxel size{};
    for (int& side : size) {
      side = pick_int(random, 1, longest);
    }
    world = make_world(kind, size, random);
  } else if (family < 5) {
    level = pick_int(random, 7, 12);
    const WorldKind kinds[3] = {WorldKind::kSingle, WorldKind::kSparse, WorldKind::kCorners};
    world = make_world(kinds[pick(random, 0, 2)], {1 << level, 1 << level, 1 << level}, random);
  } else {
    level = pick_int(random, 2, 9);
    world.name = "blocks";
    world.size = {1 << level, 1 << level, 1 << level};
    world.voxels = block_world(level, random);
  }
  const unsigned materials = pick(random, 0, 2) == 0 ? static_cast<unsigned>(pick(random, 2, 5)) : 1;
  const int rank_shift = pick_int(random, kMinRankShift, kMaxRankShift);
  const SceneUnderTest scene(world.size, world.voxels, materials, seed, rank_shift);
  totals.different_bytes += scene.same_bytes() ? 0 : 1;

  std::vector<reference::Voxel> targets;
  for (std::size_t i = 0; i < std::min<std::size_t>(world.voxels.size(), 64); ++i) {
    targets.push_back(world.voxels[i * world.voxels.size() / 64 % world.voxels.size()]);
  }
  RayCases wide(seed * 2 + 1, world.size, wide_limits(scene.level()), targets);
  RayCases narrow(seed * 2 + 2, world.size, narrow_limits(scene.level(), pick(random, 0, 4)), targets);
  reference::Statistics statistics;
  SceneUnderTest::Tally tally;
  for (std::int64_t i = 0; i < rays; ++i) {
    const RayCase ray_case = (i & 1) == 0 ? wide.next() : narrow.next();
    totals.aimed += ray_case.aimed() ? 1 : 0;
    const reference::Hit expected = reference::walk(scene.reference(), ray_case.ray, &statistics);
    if (i % 512 == 0 && world.voxels.size() <= 8192) {
      ++totals.brute_forced;
      const reference::Hit brute = reference::brute_force(world.voxels, ray_case.ray);
      totals.judge_mismatches += reference::same_answer(brute, expected) ? 0 : 1;
    }
    scene.compare(tests::to_core(ray_case.ray), expected, tally);
  }
  if (tally.mismatches != 0) {
    tally.first = "\nworld " + world.name + ", seed " + std::to_string(seed) + ", rank shift " +
                  std::to_string(rank_shift) + ", materials " + std::to_string(materials) + tally.first;
  }
  totals.tally += tally;
  totals.statistics += statistics;
}

}  // namespace

TEST_CASE("trace: random rays in random worlds -> every structure and width gives the reference's answer") {
  const std::int64_t rays = number_from_environment("THIMBLE_RAYS", many_or_few(10000000, 200000));
  const std::int64_t seed = number_from_environment("THIMBLE_SEED", 20240611);
  // Many worlds at the least, and few enough that most of the time goes into rays.
  const std::int64_t rays_per_world = std::clamp(rays / 500, std::int64_t{250}, std::int64_t{10000});
  RunTotals totals;
  for (std::int64_t done = 0, world = 0; done < rays; done += rays_per_world, ++world) {
    run_world(static_cast<std::uint64_t>(seed + world), std::min(rays_per_world, rays - done), totals);
  }
  CHECK_MESSAGE(totals.tally.mismatches == 0, totals.tally.first);
  CHECK(totals.judge_mismatches == 0);
  CHECK(totals.different_bytes == 0);
  CHECK(totals.statistics.rays == rays);
  CHECK(totals.aimed * 4 >= rays);
  CHECK(totals.statistics.tied_crossings > 0);
  CHECK(totals.tally.narrow * 4 >= rays);
  CHECK(totals.brute_forced > 0);
}
