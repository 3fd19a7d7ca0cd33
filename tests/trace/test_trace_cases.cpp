// The rays worked out by hand (portable/rays.h) before the judges, and what must hold for all rays:
// reversal, symmetries, shifts, closed shells, merged blocks. Every ray is traced in every structure and
// width.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "portable/rays.h"
#include "reference/reference.h"
#include "support/counts.h"
#include "support/ray_cases.h"
#include "support/scene_under_test.h"
#include "thimble/trace/ray.h"

namespace {

using namespace thimble;
using namespace thimble::tests;
using Voxels = std::vector<reference::Voxel>;

const int kScale = thimble::tests::many_or_few(10, 1);

// A ray whose origin is given in 1/256 voxel.
Ray ray_q8(const Vec3i& origin_q8, const Vec3i& direction) {
  return {{Q8::from_raw(origin_q8.x), Q8::from_raw(origin_q8.y), Q8::from_raw(origin_q8.z)}, direction};
}
reference::Hit hit_at(const reference::Voxel& voxel, std::int64_t numerator, std::int64_t denominator,
                      int axis) {
  return {true, voxel, numerator, denominator, axis};
}

// A cube of 2^level voxels a side.
class Cube {
 public:
  Cube(int level, const Voxels& voxels)
      : scene_({1 << level, 1 << level, 1 << level}, voxels), voxels_(voxels) {}

  // Every structure and width, and both judges, give the answer worked out by hand.
  void expect(const Ray& ray, const reference::Hit& expected) const {
    SceneUnderTest::Tally tally;
    scene_.compare(ray, expected, tally);
    CHECK_MESSAGE(tally.mismatches == 0, tally.first);
    CHECK(tally.traced >= 2);
    CHECK(reference::same_answer(reference::brute_force(voxels_, to_reference(ray)), expected));
    CHECK(reference::same_answer(reference::walk(scene_.reference(), to_reference(ray)), expected));
  }
  void expect_miss(const Ray& ray) const { expect(ray, reference::Hit{}); }
  const SceneUnderTest& scene() const { return scene_; }

 private:
  SceneUnderTest scene_;
  Voxels voxels_;
};

Voxels all_voxels(int side) {
  Voxels voxels;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        voxels.push_back({x, y, z});
      }
    }
  }
  return voxels;
}

Hit closest(const CompactTree& tree, const Ray& ray, const TraceOptions& options = {}) {
  Hit hit;
  REQUIRE(closest_hit(tree, ray, &hit, options) == Status::kOk);
  return hit;
}

Voxels random_voxels(std::mt19937_64& random, int level, int count) {
  Voxels voxels;
  for (int i = 0; i < count; ++i) {
    reference::Voxel voxel{};
    for (int& component : voxel) {
      component = static_cast<int>(pick(random, 0, (1 << level) - 1));
    }
    voxels.push_back(voxel);
  }
  std::sort(voxels.begin(), voxels.end());
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

}  // namespace

TEST_CASE("trace: the rays worked out by hand -> so say the judges, and every structure and width") {
  for (const portable::RayCase& row : portable::ray_cases()) {
    CAPTURE(row.name);
    Voxels voxels;
    for (int i = 0; i < row.scene->box_count; ++i) {
      const portable::RayScene::Box& box = row.scene->boxes[i];
      for (int z = box.low[2]; z < box.high[2]; ++z) {
        for (int y = box.low[1]; y < box.high[1]; ++y) {
          for (int x = box.low[0]; x < box.high[0]; ++x) {
            voxels.push_back({x, y, z});
          }
        }
      }
    }
    const Cube cube(row.scene->level, voxels);
    if (row.axis == portable::kMiss) {
      cube.expect_miss(row.ray());
    } else {
      cube.expect(row.ray(), hit_at({row.voxel[0], row.voxel[1], row.voxel[2]}, row.numerator,
                                    row.denominator, row.axis));
    }
  }
}

TEST_CASE("trace: a ray too long for 32 bits by a bit -> refused with k32, the hit untouched") {
  const Cube cube(5, all_voxels(32));
  const TraceOptions narrow{UINT32_MAX, Width::k32};
  // 5 * 256 * 32 has 16 bits: with a direction of 15 the products still fit, with 16 they do not.
  const int32_t low = -4 * 256 * 32;
  const Ray fits = ray_q8({low, 300, 300}, {(1 << 15) - 1, 1, 1});
  const Ray too_long = ray_q8({low, 300, 300}, {1 << 15, 1, 1});
  const auto check = [&](const auto& structure) {
    Hit hit;
    CHECK(closest_hit(structure, fits, &hit, narrow) == Status::kOk);
    CHECK(closest_hit(structure, too_long, &hit) == Status::kOk);
    hit.visits = 77;
    HitKind kind = HitKind::kStepLimit;
    uint32_t visits = 78;
    CHECK(closest_hit(structure, too_long, &hit, narrow) == Status::kOutOfRange);
    CHECK(any_hit(structure, too_long, &kind, &visits, narrow) == Status::kOutOfRange);
    CHECK(hit.visits == 77);
    CHECK(visits == 78);
    CHECK(kind == HitKind::kStepLimit);
  };
  check(cube.scene().compact());
  check(cube.scene().pool());
  check(*cube.scene().dense());
}

TEST_CASE("trace: step limit -> reported when one visit more is needed, without effect when not") {
  std::mt19937_64 random(11);
  const SceneUnderTest scene({32, 32, 32}, random_voxels(random, 5, 300));
  RayCases cases(12, {32, 32, 32});
  const auto check = [&](const auto& structure, const Ray& ray, Width width) {
    Hit free;
    REQUIRE(closest_hit(structure, ray, &free, {UINT32_MAX, width}) == Status::kOk);
    for (uint32_t limit = 0; limit <= free.visits + 1;
         limit = limit < 2 ? limit + 1 : std::max(limit + 1, free.visits - 1)) {
      Hit hit;
      HitKind kind = HitKind::kMiss;
      uint32_t visits = 0;
      REQUIRE(closest_hit(structure, ray, &hit, {limit, width}) == Status::kOk);
      REQUIRE(any_hit(structure, ray, &kind, &visits, {limit, width}) == Status::kOk);
      CHECK(hit.kind == (limit < free.visits ? HitKind::kStepLimit : free.kind));
      CHECK(hit.visits == std::min(limit, free.visits));
      CHECK(kind == hit.kind);
      CHECK(visits == hit.visits);
    }
  };
  for (int i = 0; i < 200 * kScale; ++i) {
    const Ray ray = to_core(cases.next().ray);
    for (const Width width : {Width::k64, Width::k32}) {
      if (width == Width::k64 || accepts_32(ray, scene.level())) {
        check(scene.compact(), ray, width);
        check(scene.pool(), ray, width);
        check(*scene.dense(), ray, width);
      }
    }
  }
}

TEST_CASE("trace: the reversed ray -> the same voxels in the opposite order") {
  // All voxels that a ray meets: trace, remove what was hit, trace again. Removing the voxels of one line
  // leaves the others as they are, so this is every solid voxel in which the ray spends a positive length,
  // in order. The reversed ray starts where the first one has left the world; as a set of points within the
  // world it is the same line, and whether a length is positive does not depend on the way it is travelled.
  std::mt19937_64 random(21);
  for (int world = 0; world < 4; ++world) {
    const int level = 3 + world;
    const int side = 1 << level;
    const Voxels voxels = random_voxels(random, level, side * side * side / 3);
    std::vector<std::uint8_t> bytes(Octree::octree_bytes(200000));
    Octree pool;
    REQUIRE(Octree::make(level, {bytes.data(), bytes.size()}, &pool) == Status::kOk);
    for (const reference::Voxel& voxel : voxels) {
      REQUIRE(pool.insert({voxel[0], voxel[1], voxel[2]}) == Status::kOk);
    }
    const auto all_met = [&](const Ray& ray) {
      std::vector<Vec3i> met;
      for (;;) {
        Hit hit;
        REQUIRE(closest_hit(pool, ray, &hit) == Status::kOk);
        if (hit.kind != HitKind::kHit) {
          break;
        }
        met.push_back(hit.voxel);
        REQUIRE(pool.remove(hit.voxel) == Status::kOk);
      }
      for (const Vec3i& voxel : met) {
        REQUIRE(pool.insert(voxel) == Status::kOk);
      }
      return met;
    };
    RayCases cases(22 + static_cast<std::uint64_t>(world), {side, side, side});
    int compared = 0;
    for (int i = 0; i < 1000 * kScale && compared < 40 * kScale; ++i) {
      const Ray ray = to_core(cases.next().ray);
      // As many 1/256 steps of the direction as carry the origin to the other side, still within the limits;
      // skipped where the two ends are not both outside the world.
      Vec3i end;
      bool usable = false;
      for (int32_t steps = 1; steps <= 1 << 14 && !usable; steps *= 2) {
        bool within_limits = true;
        bool start_outside = false;
        bool end_outside = false;
        for (int axis = 0; axis < 3; ++axis) {
          const std::int64_t to = ray.origin[axis].raw + std::int64_t{steps} * ray.direction[axis];
          within_limits = within_limits && to >= -4 * 256 * side && to <= 5 * 256 * side;
          end[axis] = static_cast<int32_t>(to);
          // On the side that it comes from, and on the side that it goes to.
          const int direction = ray.direction[axis];
          const int from = ray.origin[axis].raw;
          start_outside =
              start_outside || (direction > 0 && from <= 0) || (direction < 0 && from >= 256 * side);
          end_outside = end_outside || (direction > 0 && to >= 256 * side) || (direction < 0 && to <= 0);
        }
        usable = within_limits && start_outside && end_outside;
        if (!within_limits) {
          break;
        }
      }
      if (!usable) {
        continue;
      }
      std::vector<Vec3i> forward = all_met(ray);
      const std::vector<Vec3i> backward =
          all_met(ray_q8(end, {-ray.direction.x, -ray.direction.y, -ray.direction.z}));
      std::reverse(forward.begin(), forward.end());
      CHECK_MESSAGE(forward == backward, reference::describe(to_reference(ray)));
      ++compared;
    }
    CHECK(compared >= 10);
  }
}

TEST_CASE("trace: the 48 symmetries of the cube -> the turned world gives the turned hit") {
  // Exchanging axes is always allowed. Reflecting an axis is, unless the ray runs within a lattice plane of
  // that axis (component 0, origin on a plane): the plane belongs to the voxel above it, and the reflection
  // would give it to the one below. The axis of a hit is the lowest of those entered at the same t, so it is
  // the lowest of their images.
  std::mt19937_64 random(31);
  const int level = 4;
  const int side = 1 << level;
  const Voxels voxels = random_voxels(random, level, 900);
  constexpr std::array<std::array<int, 3>, 6> kOrders = {
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  const SceneUnderTest plain({side, side, side}, voxels);
  int ties = 0;
  for (const auto& order : kOrders) {
    for (unsigned flips = 0; flips < 8; ++flips) {
      const auto flipped = [&](int axis) { return ((flips >> axis) & 1U) != 0; };
      const auto turn_voxel = [&](const reference::Voxel& voxel) {
        reference::Voxel turned{};
        for (int axis = 0; axis < 3; ++axis) {
          const int from = voxel[static_cast<std::size_t>(order[static_cast<std::size_t>(axis)])];
          turned[static_cast<std::size_t>(axis)] = flipped(axis) ? side - 1 - from : from;
        }
        return turned;
      };
      Voxels turned_voxels;
      for (const reference::Voxel& voxel : voxels) {
        turned_voxels.push_back(turn_voxel(voxel));
      }
      const SceneUnderTest turned({side, side, side}, turned_voxels);
      RayCases cases(32, {side, side, side});
      for (int i = 0; i < 100 * kScale; ++i) {
        const Ray ray = to_core(cases.next().ray);
        Ray image;
        bool allowed = true;
        for (int axis = 0; axis < 3; ++axis) {
          const int from = order[static_cast<std::size_t>(axis)];
          const int32_t origin = ray.origin[from].raw;
          allowed = allowed && !(flipped(axis) && ray.direction[from] == 0 && origin % 256 == 0);
          image.origin[axis] = Q8::from_raw(flipped(axis) ? 256 * side - origin : origin);
          image.direction[axis] = flipped(axis) ? -ray.direction[from] : ray.direction[from];
        }
        if (!allowed) {
          continue;
        }
        const Hit hit = closest(plain.compact(), ray);
        reference::Hit expected{hit.kind == HitKind::kHit,
                                turn_voxel({hit.voxel.x, hit.voxel.y, hit.voxel.z}), hit.t_numerator,
                                hit.t_denominator, -1};
        if (hit.kind == HitKind::kHit && hit.axis >= 0) {
          int tied = 0;
          for (int axis = 2; axis >= 0; --axis) {
            const int from = order[static_cast<std::size_t>(axis)];
            const std::int64_t direction = ray.direction[from];
            const std::int64_t plane = 256 * std::int64_t{hit.voxel[from] + (direction < 0 ? 1 : 0)};
            // (plane - origin) / (256 direction) against t.
            if (direction != 0 &&
                (plane - ray.origin[from].raw) * hit.t_denominator == 256 * direction * hit.t_numerator) {
              expected.axis = axis;
              ++tied;
            }
          }
          REQUIRE(tied > 0);
          ties += tied > 1 ? 1 : 0;
        }
        SceneUnderTest::Tally tally;
        turned.compare(image, expected, tally);
        CHECK_MESSAGE(tally.mismatches == 0, tally.first);
      }
    }
  }
  CHECK(ties > 48);
}

TEST_CASE("trace: shifted by whole voxels -> the same hit, shifted") {
  std::mt19937_64 random(41);
  const Voxels voxels = random_voxels(random, 3, 150);
  const SceneUnderTest plain({64, 64, 64}, voxels);
  RayCases cases(42, {8, 8, 8});
  for (int shift_case = 0; shift_case < 10; ++shift_case) {
    reference::Voxel shift{};
    for (int& component : shift) {
      component = static_cast<int>(pick(random, 0, 56));
    }
    Voxels moved_voxels = voxels;
    for (reference::Voxel& voxel : moved_voxels) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        voxel[axis] += shift[axis];
      }
    }
    const SceneUnderTest moved({64, 64, 64}, moved_voxels);
    for (int i = 0; i < 200 * kScale; ++i) {
      const Ray ray = to_core(cases.next().ray);
      Ray image = ray;
      for (int axis = 0; axis < 3; ++axis) {
        image.origin[axis] = ray.origin[axis] + Q8::saturate(shift[static_cast<std::size_t>(axis)]);
      }
      const Hit hit = closest(plain.compact(), ray);
      const reference::Hit expected{hit.kind == HitKind::kHit,
                                    {hit.voxel.x + shift[0], hit.voxel.y + shift[1], hit.voxel.z + shift[2]},
                                    hit.t_numerator,
                                    hit.t_denominator,
                                    hit.axis};
      SceneUnderTest::Tally tally;
      moved.compare(image, expected, tally);
      CHECK_MESSAGE(tally.mismatches == 0, tally.first);
    }
  }
}

TEST_CASE("trace: a closed shell -> no ray gets through it, from outside or from inside") {
  // A ball without its core, two voxels thick: so no voxel outside touches one inside, not by a corner
  // either. A kernel in its middle must never be seen from outside.
  constexpr int kSide = 32;
  const auto distance_2 = [](const reference::Voxel& voxel) {
    int sum = 0;
    for (const int component : voxel) {
      sum += (2 * component + 1 - kSide) * (2 * component + 1 - kSide);  // in half voxels, squared
    }
    return sum;
  };
  constexpr int kOuter2 = 26 * 26;  // 13 voxels
  constexpr int kInner2 = 22 * 22;
  Voxels voxels;
  for (const reference::Voxel& voxel : all_voxels(kSide)) {
    if ((distance_2(voxel) <= kOuter2 && distance_2(voxel) > kInner2) || distance_2(voxel) < 30) {
      voxels.push_back(voxel);
    }
  }
  const SceneUnderTest scene({kSide, kSide, kSide}, voxels);
  RayCases cases(51, {kSide, kSide, kSide});
  std::mt19937_64 random(52);
  int outside_hits = 0;
  for (int i = 0; i < 4000 * kScale; ++i) {
    Ray ray = to_core(cases.next().ray);
    const bool inside = (i & 1) == 0;
    if (inside) {  // between the kernel and the shell, on the lattice half of the time
      Vec3i origin{0, kSide * 128, kSide * 128};
      origin.x = static_cast<int32_t>(kSide * 128 + pick(random, 4 * 256, 10 * 256));
      if (pick(random, 0, 1) == 0) {
        origin.x = origin.x / 256 * 256;
      }
      ray = ray_q8(origin, ray.direction);
    }
    const Hit hit = closest(scene.compact(), ray);
    const bool hit_something = hit.kind == HitKind::kHit;
    if (inside) {
      CHECK_MESSAGE(hit_something, reference::describe(to_reference(ray)));
      if (hit_something) {
        CHECK(distance_2({hit.voxel.x, hit.voxel.y, hit.voxel.z}) <= kOuter2);
      }
      continue;
    }
    reference::Voxel start{};
    for (int axis = 0; axis < 3; ++axis) {
      start[static_cast<std::size_t>(axis)] = ray.origin[axis].floor();
    }
    // Two voxels of margin: the origin may lie on a face.
    if (hit_something && distance_2(start) > 30 * 30) {
      ++outside_hits;
      CHECK_MESSAGE(distance_2({hit.voxel.x, hit.voxel.y, hit.voxel.z}) > kInner2,
                    reference::describe(to_reference(ray)));
    }
    SceneUnderTest::Tally tally;
    scene.compare(ray, reference::walk(scene.reference(), to_reference(ray)), tally);
    CHECK_MESSAGE(tally.mismatches == 0, tally.first);
  }
  CHECK(outside_hits > 100);
}

namespace {

// The leaves of a pool: merged blocks as blocks, everything else as single voxels.
void leaves_of(const Octree& pool, uint32_t index, const Vec3i& corner, int level,
               std::vector<reference::Block>& blocks) {
  const Octree::NodeView node = pool.node(index);
  if (node.solid() && node.merged) {
    blocks.push_back({{corner.x, corner.y, corner.z}, level});
    return;
  }
  if (node.solid()) {
    for (const reference::Voxel& voxel : all_voxels(1 << level)) {
      blocks.push_back({{corner.x + voxel[0], corner.y + voxel[1], corner.z + voxel[2]}, 0});
    }
    return;
  }
  const int half = 1 << (level - 1);
  for (int octant = 0; octant < 8; ++octant) {
    if (((node.mask >> octant) & 1) == 0) {
      continue;
    }
    const Vec3i child{corner.x + ((octant & 1) != 0 ? half : 0), corner.y + ((octant & 2) != 0 ? half : 0),
                      corner.z + ((octant & 4) != 0 ? half : 0)};
    if (level == 1) {
      blocks.push_back({{child.x, child.y, child.z}, 0});
    } else {
      leaves_of(pool, pool.child(node, octant), child, level - 1, blocks);
    }
  }
}

// Pool and compact tree, each in the widths that take the ray, against the judge of blocks.
void check_blocks(const Octree& pool, const CompactTree& tree, const std::vector<reference::Block>& blocks,
                  const Ray& ray, int* merged_hits) {
  const reference::Hit expected = reference::judge_blocks(blocks, to_reference(ray));
  int block_level = 0;
  for (const reference::Block& block : blocks) {
    if (expected.hit && block.lowest == expected.voxel) {
      block_level = block.log2_side;
    }
  }
  const auto check = [&](const Hit& hit) {
    CHECK_MESSAGE(tests::same_answer(hit, expected), reference::describe(to_reference(ray))
                                                         << ": " << describe(hit) << ", expected "
                                                         << reference::describe(expected));
    if (expected.hit && hit.kind == HitKind::kHit) {
      CHECK(hit.block_level == block_level);
      CHECK(hit.material == pool.material(hit.voxel));
      *merged_hits += hit.block_level > 0 ? 1 : 0;
    }
  };
  for (const Width width : {Width::k64, Width::k32}) {
    if (width == Width::k32 && !accepts_32(ray, pool.level())) {
      continue;
    }
    Hit hit;
    REQUIRE(closest_hit(pool, ray, &hit, {UINT32_MAX, width}) == Status::kOk);
    check(hit);
    REQUIRE(closest_hit(tree, ray, &hit, {UINT32_MAX, width}) == Status::kOk);
    check(hit);
    HitKind kind = HitKind::kStepLimit;
    REQUIRE(any_hit(tree, ray, &kind, nullptr, {UINT32_MAX, width}) == Status::kOk);
    CHECK(kind == hit.kind);
  }
}

}  // namespace

TEST_CASE("trace: merged blocks of a coarsened tree -> lowest corner, exact t, the block's material") {
  std::mt19937_64 random(61);
  int merged_hits = 0;
  for (int world = 0; world < 30; ++world) {
    const int level = static_cast<int>(pick(random, 2, 5));
    const int side = 1 << level;
    const unsigned materials = world % 2 == 0 ? 1 : 3;
    std::vector<std::uint8_t> bytes(Octree::octree_bytes(40000));
    Octree pool;
    REQUIRE(Octree::make(level, {bytes.data(), bytes.size()}, &pool) == Status::kOk);
    for (const reference::Voxel& voxel :
         random_voxels(random, level, static_cast<int>(pick(random, 4, side * side * side / 4)))) {
      REQUIRE(pool.insert({voxel[0], voxel[1], voxel[2]}, material_at(voxel, materials, 61)) == Status::kOk);
    }
    // One block that is truly full among the merged ones.
    REQUIRE(pool.insert_block({0, 0, 0}, level - 1, 2) == Status::kOk);
    REQUIRE(pool.coarsen_to(std::max<std::size_t>(
                1, pool.nodes_used() * static_cast<std::size_t>(1 + world % 3) / 4)) == Status::kOk);
    std::vector<reference::Block> blocks;
    leaves_of(pool, pool.root(), {}, level, blocks);
    const HeapBytes compact = compact_of(pool, kMinRankShift + world % 8);
    CHECK(CompactTree::validate(compact.view()) == nullptr);
    const CompactTree tree = open_or_throw(compact);
    CHECK(tree.solid_added() == pool.solid_added());
    RayCases cases(62 + static_cast<std::uint64_t>(world), {side, side, side});
    for (int i = 0; i < 100 * kScale / 2; ++i) {
      check_blocks(pool, tree, blocks, to_core(cases.next().ray), &merged_hits);
    }
  }
  CHECK(merged_hits > 100);
}

TEST_CASE("trace: many materials -> the right one for voxels and for uniform blocks, in pool and compact") {
  std::mt19937_64 random(71);
  for (int world = 0; world < 10; ++world) {
    std::vector<std::uint8_t> bytes(Octree::octree_bytes(60000));
    Octree pool;
    REQUIRE(Octree::make(5, {bytes.data(), bytes.size()}, &pool) == Status::kOk);
    for (int i = 0; i < 30; ++i) {
      const int block_level = static_cast<int>(pick(random, 0, 3));
      const int side = 1 << block_level;
      const Vec3i corner{side * static_cast<int>(pick(random, 0, 31 >> block_level)),
                         side * static_cast<int>(pick(random, 0, 31 >> block_level)),
                         side * static_cast<int>(pick(random, 0, 31 >> block_level))};
      REQUIRE(pool.insert_block(corner, block_level, static_cast<uint8_t>(pick(random, 0, 255))) ==
              Status::kOk);
    }
    std::vector<reference::Block> blocks;
    leaves_of(pool, pool.root(), {}, 5, blocks);
    const HeapBytes compact = compact_of(pool, kMinRankShift + world % 8);
    const CompactTree tree = open_or_throw(compact);
    CHECK(tree.many_materials());
    RayCases cases(72 + static_cast<std::uint64_t>(world), {32, 32, 32});
    int merged_hits = 0;
    for (int i = 0; i < 20 * kScale; ++i) {
      check_blocks(pool, tree, blocks, to_core(cases.next().ray), &merged_hits);
    }
    CHECK(merged_hits == 0);
  }
}
