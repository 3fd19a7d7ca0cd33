// Rays in vectors give the core's answers: hard rays through random worlds, by every instruction set.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "support/wide_cases.h"
#include "thimble/trace/secondary_ray.h"
#include "wide/rays/ray_map.h"

namespace thimble::tests {
namespace {

struct MapUnderTest {
  std::unique_ptr<HeapBytes> bytes;
  wide::RayMap map;
};

MapUnderTest make_map(const CompactTree& tree) {
  MapUnderTest made;
  made.bytes = std::make_unique<HeapBytes>(wide::RayMap::bytes(tree));
  Arena arena(made.bytes->span());
  REQUIRE(wide::RayMap::make(tree, &arena, &made.map) == Status::kOk);
  return made;
}

// Rays, a bound for each, and what the core says of them.
struct RayBatch {
  std::vector<Ray> rays;
  std::vector<RayPoint> before;
  std::vector<RayPoint> from;
  std::vector<Hit> first;
  std::vector<Hit> first_from;
  std::uint8_t classes[256] = {};  // by material; few, 0 among them
};

bool is_before(const Hit& hit, const RayPoint& point) {
  return static_cast<std::int64_t>(hit.t_numerator) * point.t_denominator <
         static_cast<std::int64_t>(point.t_numerator) * hit.t_denominator;
}

RayPoint random_bound(std::mt19937_64& random, const Hit& hit) {
  switch (pick(random, 0, 5)) {
    case 0:
      return {pick_int(random, 0, 1), 1};
    case 1:
      return {INT32_MAX, pick_int(random, 1, INT32_MAX)};
    case 2:  // a reach of some voxels, about
      return {pick_int(random, 1, 1 << 12), pick_int(random, 1, 1 << 22)};
    default: {  // the hit itself, or just beside it
      const std::int32_t scale =
          pick_int(random, 1, INT32_MAX / std::max(hit.t_numerator, hit.t_denominator));
      return {std::max(hit.t_numerator * scale + pick_int(random, -1, 1), 0), hit.t_denominator * scale};
    }
  }
}

// A plane that the ray crosses, or its start.
RayPoint random_place(std::mt19937_64& random, const Ray& ray, const Hit& hit) {
  if (pick(random, 0, 2) == 0) {
    return point_of(hit);
  }
  const int axis = pick_int(random, 0, 2);
  const std::int32_t direction = ray.direction[axis];
  if (direction == 0 || pick(random, 0, 7) == 0) {
    return {};
  }
  const std::int64_t ahead = pick(random, 0, pick(random, 0, 1) == 0 ? 64 : 4096);
  const std::int64_t origin = ray.origin[axis].raw;
  const std::int64_t plane = (direction > 0 ? origin / 256 + ahead : origin / 256 - ahead) * 256;
  const std::int64_t way = direction > 0 ? plane - origin : origin - plane;
  if (way < 0 || way > 1 << 23) {
    return {};
  }
  return {static_cast<std::int32_t>(way), 256 * std::abs(direction)};
}

void add_ray(std::mt19937_64& random, const CompactTree& tree, const Ray& ray, RayBatch* batch) {
  Hit hit;
  REQUIRE(closest_hit(tree, ray, &hit) == Status::kOk);
  batch->rays.push_back(ray);
  batch->first.push_back(hit);
  batch->before.push_back(random_bound(random, hit));
  const RayPoint from = random_place(random, ray, hit);
  batch->from.push_back(from);
  REQUIRE(closest_hit_from(tree, ray, from, &hit) == Status::kOk);
  batch->first_from.push_back(hit);
}

// Hard rays, and secondary ones: in a third of the batches all go into one octant, mostly at one speed along an
// axis; in a third one way.
RayBatch make_batch(std::mt19937_64& random, const CompactTree& tree, std::size_t count) {
  const int side = 1 << tree.level();
  const auto within = [&](int low, int high) { return pick_int(random, low, high - 1); };
  std::vector<reference::Voxel> targets;
  const VoxelBox& bounds = tree.bounds();
  for (int i = 0; i < 8 && !tree.empty(); ++i) {
    targets.push_back({within(bounds.low.x, bounds.high.x), within(bounds.low.y, bounds.high.y),
                       within(bounds.low.z, bounds.high.z)});
  }
  RayCases cases(random(), {side, side, side}, targets);
  RayBatch batch;
  for (std::uint8_t& one : batch.classes) {
    one = static_cast<std::uint8_t>(pick(random, 0, 3));
  }
  const std::int64_t alike = pick(random, 0, 2);
  const Vec3i first = to_core(cases.next().ray).direction;
  const int common = pick_int(random, 0, 3);
  const auto add = [&](Ray ray) {
    for (int axis = 0; axis < 3 && alike == 1; ++axis) {
      const std::int32_t size = std::abs(ray.direction[axis]);
      ray.direction[axis] = axis == common ? first[axis] : first[axis] < 0 ? -std::max(size, 1) : size;
    }
    if (alike == 2 || ray.direction == Vec3i{0, 0, 0}) {
      ray.direction = first;
    }
    add_ray(random, tree, ray, &batch);
  };
  while (batch.rays.size() < count) {
    add(to_core(cases.next().ray));
    const Hit hit = batch.first.back();
    if (hit.kind != HitKind::kHit) {
      continue;
    }
    const Ray seen = batch.rays.back();
    for (std::int64_t more = pick(random, 0, 2); more > 0; --more) {
      Ray next;
      next.origin = start_on_face(seen, hit);
      next.direction = to_core(cases.next().ray).direction;
      if (hit.axis >= 0 && pick(random, 0, 1) == 0) {  // mirrored
        next.direction = seen.direction;
        next.direction[hit.axis] = -next.direction[hit.axis];
      }
      add(next);
    }
  }
  return batch;
}

template <class Same>
void check_each(const char* what, const RayBatch& batch, const Same& is_same) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    if (!is_same(i) && ++wrong == 1) {
      const Ray& ray = batch.rays[i];
      MESSAGE(what, " ray ", i, ": ", ray.origin.x.raw, " ", ray.origin.y.raw, " ", ray.origin.z.raw,
              " + t * ", ray.direction.x, " ", ray.direction.y, " ", ray.direction.z,
              "; core: ", describe(batch.first[i]));
    }
  }
  INFO(what);
  CHECK(wrong == 0);
}

void check_answers(const wide::RayMap& map, const RayBatch& batch) {
  const std::size_t count = batch.rays.size();
  const Span<const Ray> rays{batch.rays.data(), count};
  const Span<const RayPoint> before{batch.before.data(), count};
  const Span<const RayPoint> from{batch.from.data(), count};
  std::vector<std::uint8_t> any(count, 7);
  std::vector<Hit> hits(count);
  const Span<std::uint8_t> to_any{any.data(), count};
  const Span<Hit> to_hits{hits.data(), count};
  const auto hit_before = [&](std::size_t i) {
    return batch.first[i].kind == HitKind::kHit && is_before(batch.first[i], batch.before[i]);
  };
  CHECK(wide::any_hit(map, rays, to_any) == Status::kOk);
  check_each("any_hit", batch,
             [&](std::size_t i) { return any[i] == (batch.first[i].kind == HitKind::kHit); });
  CHECK(wide::any_hit_before(map, rays, before, to_any) == Status::kOk);
  check_each("any_hit_before", batch, [&](std::size_t i) { return any[i] == hit_before(i); });
  CHECK(wide::first_hit(map, rays, to_hits) == Status::kOk);
  check_each("first_hit", batch, [&](std::size_t i) { return same_hit(hits[i], batch.first[i]); });
  CHECK(wide::first_hit_from(map, rays, from, to_hits) == Status::kOk);
  check_each("first_hit_from", batch, [&](std::size_t i) { return same_hit(hits[i], batch.first_from[i]); });
  // One bound for all rays; of a merged block the t counts, not how it is written.
  const RayPoint reach = batch.before.front();
  for (const std::uint8_t* classes : {static_cast<const std::uint8_t*>(nullptr), batch.classes}) {
    std::vector<RayPoint> entries(count, RayPoint{7, 7});
    CHECK(wide::first_entry_before(map, rays, reach, {entries.data(), count}, classes) == Status::kOk);
    check_each("first_entry_before", batch, [&](std::size_t i) {
      const Hit& hit = batch.first[i];
      if (hit.kind != HitKind::kHit || !is_before(hit, reach) ||
          (classes != nullptr && classes[hit.material] == 0)) {
        return entries[i].t_denominator == 0;
      }
      return entries[i].t_denominator > 0 && std::int64_t{entries[i].t_numerator} * hit.t_denominator ==
                                                 std::int64_t{hit.t_numerator} * entries[i].t_denominator;
    });
  }
  const auto class_of = [&](std::size_t i) { return batch.classes[batch.first[i].material]; };
  std::fill(any.begin(), any.end(), std::uint8_t{7});
  CHECK(wide::any_hit(map, rays, to_any, batch.classes) == Status::kOk);
  check_each("any_hit by class", batch, [&](std::size_t i) {
    return any[i] == (batch.first[i].kind == HitKind::kHit ? class_of(i) : 0);
  });
  std::fill(any.begin(), any.end(), std::uint8_t{7});
  CHECK(wide::any_hit_before(map, rays, before, to_any, batch.classes) == Status::kOk);
  check_each("any_hit_before by class", batch,
             [&](std::size_t i) { return any[i] == (hit_before(i) ? class_of(i) : 0); });
  CHECK(wide::first_hit_before(map, rays, before, to_hits) == Status::kOk);
  check_each("first_hit_before", batch,
             [&](std::size_t i) { return same_hit(hits[i], hit_before(i) ? batch.first[i] : Hit{}); });
}

// Scenes of random_scene, and so many rays through each by each of the instruction sets: counts the rays.
std::uint64_t check_random_scenes(std::uint64_t first_seed, int scenes, std::size_t rays) {
  const BestInstructionSet after;
  const int sets = wide::instruction_set_count();
  std::uint64_t traced = 0;
  for (int i = 0; i < scenes; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    const WideScene scene = random_scene(random);
    CAPTURE(seed);
    CAPTURE(scene.what);
    CAPTURE(scene.level);
    const MapUnderTest made = make_map(scene.tree);
    const RayBatch batch = make_batch(random, scene.tree, rays);
    for (int set = 0; set < sets; ++set) {
      wide::use_instruction_set(set);
      CAPTURE(wide::instruction_set());
      check_answers(made.map, batch);
    }
    if (i % 4 == 0) {
      check_answers(wide::RayMap(scene.tree), batch);  // without a map: the core's
    }
    traced += batch.rays.size();
  }
  return traced;
}

}  // namespace

TEST_CASE("rays: hard rays through random worlds -> the core's answers by every instruction set") {
  CHECK(check_random_scenes(31000, many_or_few(300, 40), 300) > 10000);
}

TEST_CASE("rays: boxes -> empty where nothing solid is in them") {
  std::size_t empty = 0;
  std::size_t full = 0;
  for (int level = 1; level <= 7; ++level) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      CAPTURE(level);
      CAPTURE(seed);
      std::mt19937_64 random(seed);
      const int side = 1 << level;
      std::vector<Vec3i> solid;
      const WideScene scene = make_scene(level, [&](Octree* octree) {
        for (std::int64_t left = pick(random, 0, side); left > 0; --left) {
          solid.push_back(random_voxel(random, 0, side - 1));
          REQUIRE(octree->insert(solid.back(), 1) == Status::kOk);
        }
      });
      const MapUnderTest made = make_map(scene.tree);
      const auto holds = [&](const VoxelBox& box) {
        return std::any_of(solid.begin(), solid.end(), [&](const Vec3i& voxel) {
          return voxel.x >= box.low.x && voxel.x < box.high.x && voxel.y >= box.low.y &&
                 voxel.y < box.high.y && voxel.z >= box.low.z && voxel.z < box.high.z;
        });
      };
      for (int turn = 0; turn < 400; ++turn) {
        VoxelBox box;
        for (int axis = 0; axis < 3; ++axis) {
          box.low[axis] = pick_int(random, -3 - side, side + 3);
          box.high[axis] = box.low[axis] + pick_int(random, 1, turn % 2 == 0 ? 20 : 2 * side);
        }
        const bool is_empty = made.map.is_empty(box);
        CHECK(is_empty != holds(box));
        ++(is_empty ? empty : full);
      }
    }
  }
  CHECK(empty > 1000);
  CHECK(full > 1000);
  CHECK_FALSE(wide::RayMap(CompactTree()).is_empty({{0, 0, 0}, {1, 1, 1}}));  // without a map nobody knows
}

}  // namespace thimble::tests
