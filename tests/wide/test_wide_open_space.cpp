// Rays of occlusion that are not sent: the core says that they meet nothing within reach.
#include <doctest/doctest.h>

#include <random>

#include "support/wide_cases.h"
#include "thimble/light/host/optics.h"
#include "thimble/trace/secondary_ray.h"
#include "wide/lit/face_lights.h"

namespace thimble::tests {
namespace {

struct Place {
  Vec3Q8 at;
  std::uint8_t face;
};

// A point of a face of a voxel; of three in four on an edge of it, or on a corner.
Place random_place(std::mt19937_64& random, std::int64_t side) {
  Place place;
  place.face = static_cast<std::uint8_t>(pick(random, 0, 5));
  const Vec3i voxel = random_voxel(random, 0, side - 1);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t part = axis == place.face / 2 || pick(random, 0, 1) == 0 ? 0 : pick(random, 1, 255);
    place.at[axis] = Q8::from_raw(static_cast<std::int32_t>(voxel[axis] * 256 + part));
  }
  if (place.face % 2 != 0) {
    place.at[place.face / 2].raw += 256;
  }
  return place;
}

struct OpenCounts {
  int wrong = 0;
  int spared = 0;
  int sent = 0;
};

void check_place(const WideScene& scene, const Occlusion& occlusion, const Place& place, unsigned rays,
                 OpenCounts* counts) {
  for (int n = 0; n < occlusion.rays; ++n) {
    if ((rays >> n % 4 & 1U) != 0) {
      ++counts->sent;
      continue;
    }
    ++counts->spared;
    const Vec3i direction = occlusion_direction(n, place.face / 2, place.face % 2 == 0);
    HitKind kind = HitKind::kHit;
    const RayPoint end{occlusion.reach, kOcclusionLength};
    REQUIRE(any_hit_before(scene.tree, {place.at, direction}, end, &kind) == Status::kOk);
    counts->wrong += kind == HitKind::kHit ? 1 : 0;
  }
}

}  // namespace

TEST_CASE("wide: rays of occlusion that are not sent -> none would meet anything within reach") {
  std::mt19937_64 random(83);
  OpenCounts counts;
  for (int trial = 0; trial < 300; ++trial) {
    CAPTURE(trial);
    const int level = pick_int(random, 2, 8);
    const std::int64_t side = std::int64_t{1} << level;
    const WideScene scene = make_scene(level, [&](Octree* octree) {
      for (std::int64_t left = pick(random, 1, 2 * side); left > 0; --left) {
        REQUIRE(octree->insert(random_voxel(random, 0, side - 1), 1) == Status::kOk);
      }
    });
    const HeapBytes bytes(wide::RayMap::bytes(scene.tree));
    Arena arena(bytes.span());
    wide::RayMap map;
    REQUIRE(wide::RayMap::make(scene.tree, &arena, &map) == Status::kOk);
    Occlusion occlusion;
    occlusion.rays = static_cast<std::uint8_t>(4 << pick(random, 0, 3));
    occlusion.reach = static_cast<std::uint16_t>(pick(random, 1, pick(random, 0, 1) == 0 ? 8 : 200));
    wide::OpenSpace open(map, occlusion, occlusion.rays);
    // More than it remembers.
    for (int turn = 0; turn < 700; ++turn) {
      const Place place = random_place(random, side);
      check_place(scene, occlusion, place, open.rays_before(place.at, place.face), &counts);
    }
  }
  CHECK(counts.wrong == 0);
  CHECK(counts.spared > 500000);
  CHECK(counts.sent > 500000);
}

}  // namespace thimble::tests
