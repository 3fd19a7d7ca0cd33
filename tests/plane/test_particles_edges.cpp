// The particle world where a number, a list or a word of bits ends: no cells, no balls of that number, a seed
// that the generator cannot begin with, as many balls as a word of words has bits.
#include <doctest/doctest.h>

#include <cstdint>

#include "support/particle_shadow.h"
#include "thimble/plane/particles.h"

namespace thimble::tools {
namespace {

// One ball grazes another of its size, so fast and along a line so near to the tangent that the impulse, a few units,
// rounded on each axis, would be work along the way: 2^32 units of energy and more. It is left out.
TEST_CASE(
    "particles edges: a graze at 585 cells a step, restitution just below 1 -> met, nothing exchanged") {
  ParticleConfig config = weightless(1500, 64, 2);
  config.most_diameter = 16;
  config.restitution_q16 = 65535;
  OwnedParticles owned(config);
  std::uint32_t still = 99;
  REQUIRE(owned.world.spawn(600 << 16, 24 << 16, 0, 0, 16, &still) == Status::kOk);
  std::uint32_t fast = 99;
  REQUIRE(owned.world.spawn(518 << 16, 40 << 16, 38339110, -233696, 16, &fast) == Status::kOk);
  owned.world.step();
  CHECK(owned.world.counters().ball_hits == 1);
  CHECK(owned.world.counters().wall_hits == 0);
  CHECK(owned.ball(fast).vx_q16 == 38339110);
  CHECK(owned.ball(fast).vy_q16 == -233696);
  CHECK(owned.ball(still).vx_q16 == 0);
  CHECK(owned.ball(still).vy_q16 == 0);
}

// Marsaglia's generator of 32 bits stays 0 for ever once it is 0; the one seed that would make it so begins
// it with 1.
TEST_CASE("particles edges: the seed whose mixture is 0 -> the numbers that follow 1") {
  constexpr std::uint32_t kZeroSeed = 1952021129;
  static_assert((kZeroSeed * 2654435761U ^ 0x9E3779B9U) == 0);
  ParticleConfig config = weightless(300, 200, 50);
  config.least_diameter = 3;
  config.most_diameter = 12;
  config.seed = kZeroSeed;
  OwnedParticles owned(config);
  std::uint32_t state = 1;
  const auto below = [&](std::uint32_t limit) {
    state ^= state << 13;
    state ^= state >> 17;
    state ^= state << 5;
    return static_cast<std::int32_t>(std::uint64_t{state} * limit >> 32);
  };
  for (int i = 0; i < 3; ++i) {  // far apart, as it happens
    std::uint32_t id = 0;
    REQUIRE(owned.world.spawn_random(1000, &id) == Status::kOk);
    const Particle made = owned.ball(id);
    CHECK(made.diameter == 3 + below(10));
    CHECK(made.vx_q16 == below(2001) - 1000);
    CHECK(made.vy_q16 == below(2001) - 1000);
    CHECK(made.corner.x == below(static_cast<std::uint32_t>(300 - made.diameter + 1)));
    CHECK(made.corner.y == below(static_cast<std::uint32_t>(200 - made.diameter + 1)));
  }
}

TEST_CASE("particles edges: a ball that is taken away while it is dragged -> the next of its number is not") {
  OwnedParticles owned(weightless(60, 40, 2));
  ParticleWorld& world = owned.world;
  std::uint32_t id = 99;
  REQUIRE(world.spawn(10 << 16, 10 << 16, 0, 0, 6, &id) == Status::kOk);
  std::uint32_t other = 99;
  REQUIRE(world.spawn(40 << 16, 30 << 16, 0, 0, 6, &other) == Status::kOk);
  world.set_pointer(PointerMode::kDrag, {10, 10});
  REQUIRE(world.dragged() == id);
  REQUIRE(world.remove(other) == Status::kOk);
  CHECK(world.dragged() == id);
  REQUIRE(world.remove(id) == Status::kOk);
  CHECK(world.dragged() == kNoBall);
  std::uint32_t again = 99;
  REQUIRE(world.spawn(10 << 16, 10 << 16, 0, 0, 6, &again) == Status::kOk);
  REQUIRE(again == id);
  world.set_pointer(PointerMode::kDrag, {30, 10});
  for (int step = 0; step < 10; ++step) {
    world.step();
  }
  CHECK(owned.ball(again).x_q16 / 65536 == 10);
}

// In a shaft a pointer moves the lower of two balls up and down by four cells, so that neither keeps to its
// place: the one above falls asleep in the step in which the one that holds it has kept to its hollow for
// 200, and the other never does.
TEST_CASE("particles edges: a ball on one that a pointer stirs -> asleep after 200 steps in its hollow") {
  for (const std::int32_t width : {8, 9, 10}) {
    ParticleConfig config = weightless(width, 80, 2);
    config.most_diameter = 8;
    config.restitution_q16 = 0;
    config.gravity_q16 = {0, 6554};
    OwnedParticles owned(config);
    ParticleWorld& world = owned.world;
    std::uint32_t low = 99;
    std::uint32_t high = 99;
    REQUIRE(world.spawn(width << 15, 60 << 16, 0, 0, 8, &low) == Status::kOk);
    REQUIRE(world.spawn(width << 15, 52 << 16, 0, 0, 8, &high) == Status::kOk);
    for (int step = 1; step <= 200; ++step) {
      world.set_pointer(PointerMode::kDrag, {width / 2, step / 8 % 2 == 0 ? 60 : 56});
      REQUIRE(world.dragged() == low);
      world.step();
      CAPTURE(step);
      REQUIRE_FALSE(owned.ball(low).asleep);
      REQUIRE(owned.ball(high).asleep == (step == 200));
    }
  }
}

}  // namespace
}  // namespace thimble::tools
