// The judges judge one another here, and cases worked out by hand judge both: those that portable/rays.h does not have,
// whose rays test_trace_cases.cpp shows both judges.
#include <doctest/doctest.h>

#include <map>
#include <stdexcept>

#include "reference/reference.h"
#include "support/ray_cases.h"

using namespace thimble::reference;
using namespace thimble::tests;

namespace {

const int kScale = thimble::tests::many_or_few(8, 1);

Hit expect_hit(const Voxel& voxel, std::int64_t numerator, std::int64_t denominator, int axis) {
  return {true, voxel, numerator, denominator, axis};
}

// Holds both judges to one answer worked out by hand, in a grid of 4096 voxels a side.
void expect(const std::vector<Voxel>& voxels, const Ray& ray, const Hit& expected) {
  const BitGrid grid({4096, 4096, 4096}, voxels);
  const Hit by_force = brute_force(voxels, ray);
  const Hit by_walk = walk(grid, ray);
  const Hit by_long_walk = walk(grid, ray, nullptr, EmptyBlocks::kWalk);
  CHECK_MESSAGE(same_answer(by_force, expected), describe(ray), ": brute force: ", describe(by_force),
                ", expected: ", describe(expected));
  CHECK_MESSAGE(same_answer(by_walk, expected), describe(ray), ": walk: ", describe(by_walk),
                ", expected: ", describe(expected));
  CHECK_MESSAGE(same_answer(by_long_walk, expected), describe(ray),
                ": walk without skipping: ", describe(by_long_walk), ", expected: ", describe(expected));
}

Voxel random_size(std::mt19937_64& random, int largest) {
  Voxel size{};
  for (int& side : size) {
    side = pick_int(random, 1, largest);
  }
  return size;
}

}  // namespace

TEST_CASE("reference: the largest world at the limits -> exact") {
  constexpr std::int64_t kWorldQ8 = 4096 * 256;
  // From -4 worlds to the last voxel at the smallest direction: t = 4 * 4096 + 4095.
  expect({{4095, 4095, 4095}}, {{-4 * kWorldQ8, kWorldQ8 - 1, kWorldQ8 - 1}, {1, 0, 0}},
         expect_hit({4095, 4095, 4095}, 20479, 1, 0));
  // The main diagonal from 5 worlds: every crossing is a corner.
  expect({{0, 0, 0}},
         {{5 * kWorldQ8, 5 * kWorldQ8, 5 * kWorldQ8}, {-kMaxDirection, -kMaxDirection, -kMaxDirection}},
         expect_hit({0, 0, 0}, 5 * 4096 - 1, kMaxDirection, 0));
  // y reaches 1 at t = 1/256, when x is 4096 - 1/256: still inside the last voxel of the row.
  expect({{4095, 1, 0}}, {{0, 255, 0}, {kMaxDirection, 1, 0}}, expect_hit({4095, 1, 0}, 1, 256, 1));
  expect({{4095, 1, 0}}, {{0, 254, 0}, {kMaxDirection, 1, 0}}, Hit{});
  expect({{4095, 1, 0}}, {{1, 255, 0}, {kMaxDirection, 1, 0}},
         Hit{});  // x is 4096 then: touched, not entered
}

TEST_CASE("reference: a ray that cannot be represented -> refused by every judge") {
  const BitGrid grid({2, 2, 2});
  for (const Ray& ray : {Ray{{0, 0, 0}, {0, 0, 0}}, Ray{{0, 0, 0}, {kMaxDirection + 1, 0, 0}},
                         Ray{{0, 0, 0}, {0, 0, -kMaxDirection - 1}}, Ray{{0, kMaxOriginQ8 + 1, 0}, {1, 0, 0}},
                         Ray{{0, 0, -kMaxOriginQ8 - 1}, {1, 0, 0}}}) {
    CHECK_THROWS_AS(brute_force({}, ray), std::invalid_argument);
    CHECK_THROWS_AS(judge_blocks({}, ray), std::invalid_argument);
    CHECK_THROWS_AS(walk(grid, ray), std::invalid_argument);
  }
}

TEST_CASE("reference: comparing answers -> as fractions, and every field counts") {
  const Hit hit = expect_hit({1, 2, 3}, 2, 6, 1);
  CHECK(same_answer(hit, expect_hit({1, 2, 3}, 1, 3, 1)));
  CHECK_FALSE(same_answer(hit, expect_hit({1, 2, 3}, 1, 4, 1)));
  CHECK_FALSE(same_answer(hit, expect_hit({1, 2, 3}, 1, 3, 2)));
  CHECK_FALSE(same_answer(hit, expect_hit({1, 2, 4}, 1, 3, 1)));
  CHECK_FALSE(same_answer(hit, Hit{}));
  CHECK_FALSE(same_answer(Hit{}, hit));
  CHECK(same_answer(Hit{}, {false, {9, 9, 9}, 1, 2, 0}));
  // Products that do not fit in 64 bits.
  constexpr std::int64_t kHuge = std::int64_t{1} << 62;
  CHECK_FALSE(same_t(expect_hit({}, kHuge, 4, 0), expect_hit({}, 0, 4, 0)));
  CHECK(hit.t() == 1.0 / 3.0);
}

TEST_CASE("reference: merged blocks -> lowest corner of the block, t of its face") {
  const std::vector<Block> blocks = {{{8, 0, 0}, 3}, {{4, 0, 0}, 0}, {{0, 16, 0}, 4}};
  CHECK(same_answer(judge_blocks(blocks, {{0, 1000, 1000}, {1, 0, 0}}), expect_hit({8, 0, 0}, 8, 1, 0)));
  CHECK(same_answer(judge_blocks(blocks, {{0, 100, 100}, {2, 0, 0}}), expect_hit({4, 0, 0}, 2, 1, 0)));
  CHECK(same_answer(judge_blocks(blocks, {{3000, 1000, 1000}, {1, 1, 1}}), expect_hit({8, 0, 0}, 0, 1, -1)));
  CHECK(same_answer(judge_blocks(blocks, {{0, 0, 0}, {0, 1, 0}}), expect_hit({0, 16, 0}, 16, 1, 1)));
  CHECK_FALSE(judge_blocks(blocks, {{2048, 2048, 2048}, {1, -1, 0}}).hit);  // touches an edge of the first
  CHECK_THROWS_AS(judge_blocks({{{4, 0, 0}, 3}}, {{0, 0, 0}, {1, 0, 0}}), std::invalid_argument);
  CHECK_THROWS_AS(judge_blocks({{{0, 0, 0}, 13}}, {{0, 0, 0}, {1, 0, 0}}), std::invalid_argument);
  // A block of the whole world and one voxel at its end, seen from the same place: overlapping, and it shows.
  CHECK_THROWS_AS(judge_blocks({{{0, 0, 0}, 12}, {{4095, 0, 0}, 0}}, {{1 << 21, 0, 0}, {-1, 0, 0}}),
                  std::logic_error);
}

TEST_CASE("reference: blocks split into voxels -> the block of the voxel hit first, at the same t") {
  const std::uint64_t seed = 20260701;
  std::mt19937_64 random(seed);
  std::int64_t hits = 0;
  for (int world = 0; world < 20 * kScale; ++world) {
    // Each 2^3 block of an 8^3 world is empty, one block, or some single voxels.
    std::vector<Block> blocks;
    std::vector<Voxel> voxels;
    std::map<Voxel, Voxel> block_of;
    for (int index = 0; index < 64; ++index) {
      const Voxel lowest = {index % 4 * 2, index / 4 % 4 * 2, index / 16 * 2};
      const std::int64_t choice = pick(random, 0, 5);
      const bool merged = choice == 0;
      if (merged) {
        blocks.push_back({lowest, 1});
      }
      for (int corner = 0; corner < 8; ++corner) {
        const Voxel voxel = {lowest[0] + corner % 2, lowest[1] + corner / 2 % 2, lowest[2] + corner / 4};
        const bool single = choice == 1 && pick(random, 0, 1) == 0;
        if (single) {
          blocks.push_back({voxel, 0});
        }
        if (merged || single) {
          voxels.push_back(voxel);
          block_of[voxel] = merged ? lowest : voxel;
        }
      }
    }
    RayCases rays(random(), {8, 8, 8});
    for (int i = 0; i < 200; ++i) {
      const Ray ray = rays.next().ray;
      const Hit of_block = judge_blocks(blocks, ray);
      const Hit of_voxel = brute_force(voxels, ray);
      bool agree = of_block.hit == of_voxel.hit;
      if (agree && of_voxel.hit) {
        ++hits;
        // The voxel may have been entered through more planes at that t: those within the block do not count.
        agree = of_block.voxel == block_of[of_voxel.voxel] && same_t(of_block, of_voxel) &&
                of_block.axis >= of_voxel.axis && (of_block.axis == -1) == (of_voxel.axis == -1);
      }
      REQUIRE_MESSAGE(agree, "seed ", seed, " world ", world, " ", describe(ray), ": blocks ",
                      describe(of_block), ", voxels ", describe(of_voxel));
    }
  }
  CHECK(hits > 20 * kScale * 20);
}

TEST_CASE("reference: random rays in small worlds of any size -> walk and brute force agree") {
  const std::uint64_t seed = 20260703;
  std::mt19937_64 random(seed);
  Statistics statistics;
  std::array<std::int64_t, kWorldKinds> hits{};
  for (int round = 0; round < 270 * kScale; ++round) {
    const std::size_t kind = static_cast<std::size_t>(round) % kWorldKinds;
    const int power = 1 << pick(random, 0, 3);
    const Voxel size = round % 3 == 0 ? Voxel{power, power, power} : random_size(random, 11);
    const World world = make_world(static_cast<WorldKind>(kind), size, random);
    const BitGrid grid(size, world.voxels);
    RayCases rays(random(), size, world.voxels);
    for (int i = 0; i < 60; ++i) {
      const RayCase given = rays.next();
      const Hit by_force = brute_force(world.voxels, given.ray);
      const Hit by_walk = walk(grid, given.ray, &statistics);
      const Hit by_long_walk = walk(grid, given.ray, nullptr, EmptyBlocks::kWalk);
      hits[kind] += by_force.hit ? 1 : 0;
      const bool agree = same_answer(by_force, by_walk) && same_answer(by_force, by_long_walk);
      REQUIRE_MESSAGE(agree, "seed ", seed, " round ", round, " ", world.name, " ", describe(given.ray),
                      ": brute force ", describe(by_force), ", walk ", describe(by_walk),
                      ", walk without skipping ", describe(by_long_walk));
    }
  }
  MESSAGE("seed ", seed, ": ", describe(statistics));
  CHECK(statistics.tied_crossings > statistics.rays / 10);
  CHECK(statistics.corner_crossings > statistics.rays / 100);
  CHECK(statistics.tied_hits > statistics.rays / 100);
  CHECK(statistics.starts_inside > statistics.rays / 100);
  CHECK(hits[static_cast<std::size_t>(WorldKind::kEmpty)] == 0);
  for (std::size_t kind = 1; kind < kWorldKinds; ++kind) {
    CHECK(hits[kind] > 60 * kScale);
  }
}

TEST_CASE("reference: large sparse worlds -> skipping empty blocks changes nothing, brute force agrees") {
  const std::uint64_t seed = 20260704;
  std::mt19937_64 random(seed);
  Statistics skipping;
  Statistics walking;
  const std::vector<Voxel> sizes = {{64, 64, 64},       {65, 63, 129},   {200, 7, 130}, {1024, 1024, 1024},
                                    {4096, 4096, 4096}, {4096, 1, 3000}, {800, 600, 1}};
  for (const Voxel& size : sizes) {
    for (const WorldKind kind : {WorldKind::kSingle, WorldKind::kSparse, WorldKind::kCorners}) {
      const World world = make_world(kind, size, random);
      const BitGrid grid(size, world.voxels);
      RayCases rays(random(), size, world.voxels);
      for (int i = 0; i < 60 * kScale; ++i) {
        const Ray ray = rays.next().ray;
        const Hit skipped = walk(grid, ray, &skipping);
        const Hit walked = walk(grid, ray, &walking, EmptyBlocks::kWalk);
        const Hit by_force = i % 4 == 0 ? brute_force(world.voxels, ray) : walked;
        REQUIRE_MESSAGE((same_answer(skipped, walked) && same_answer(walked, by_force)), "seed ", seed, " ",
                        world.name, " ", describe(ray), ": skipping ", describe(skipped), ", walking ",
                        describe(walked), ", brute force ", describe(by_force));
      }
    }
  }
  MESSAGE("seed ", seed, ": skipping: ", describe(skipping));
  MESSAGE("seed ", seed, ": walking: ", describe(walking));
  CHECK(skipping.hits == walking.hits);
  CHECK(skipping.hits > skipping.rays / 10);
  CHECK(skipping.tied_hits == walking.tied_hits);
  CHECK(skipping.starts_inside == walking.starts_inside);
  CHECK(skipping.tied_crossings > 0);
  CHECK(skipping.tied_crossings < walking.tied_crossings);
  CHECK(skipping.steps < walking.steps / 4);
}

TEST_CASE("reference: voxels of the cubes on the path to an answer alone -> it is judged as by all voxels") {
  std::mt19937_64 random(20260705);
  std::int64_t marked = 0;
  std::int64_t wrong = 0;
  for (const Voxel& size : {Voxel{64, 64, 64}, Voxel{65, 63, 129}, Voxel{200, 7, 130}, Voxel{5, 9, 8}}) {
    const World world = make_world(WorldKind::kSparse, size, random);
    const BitGrid grid(size, world.voxels);
    RayCases rays(random(), size, world.voxels);
    for (int i = 0; i < 200 * kScale; ++i) {
      const Ray ray = rays.next().ray;
      const Hit right = walk(grid, ray);
      Hit other = right;  // another voxel, or one where nothing is
      other.hit = true;
      other.voxel = i % 2 == 0 ? world.voxels[static_cast<std::size_t>(i) % world.voxels.size()] : Voxel{};
      for (const Hit& answer : {right, other, Hit{}}) {
        BitGrid cubes({(size[0] + 7) / 8, (size[1] + 7) / 8, (size[2] + 7) / 8});
        mark_path(ray, size, answer, &cubes);
        BitGrid part(size);
        for (const Voxel& voxel : world.voxels) {
          part.set(voxel, cubes.test({voxel[0] / 8, voxel[1] / 8, voxel[2] / 8}));
        }
        REQUIRE_MESSAGE(same_answer(answer, walk(part, ray)) == same_answer(answer, right), describe(ray),
                        ": ", describe(answer), ", right: ", describe(right));
        wrong += same_answer(answer, right) ? 0 : 1;
        marked += cubes.count();
      }
    }
  }
  CHECK(wrong > 400 * kScale);
  CHECK(marked < 2400 * kScale * 30);
}
