// The particle world where its numbers change kind: more balls than a word of the set of those awake has bits, the fastest
// balls, gravity of half a cell, pointers far outside, and which ball covers a cell.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include "support/particle_shadow.h"
#include "thimble/plane/particles.h"

namespace thimble::tools {
namespace {

// As bouncy as can be.
ParticleConfig bouncy(std::int32_t width, std::int32_t height, std::uint32_t capacity) {
  ParticleConfig config = weightless(width, height, capacity);
  config.restitution_q16 = 65536;
  return config;
}

// The set of those awake is a tree of words: 32 balls a bit of the second level, 1024 a bit of the third.
TEST_CASE("particles limits: any of many balls awake -> just those move, in every part of the numbers") {
  std::mt19937 random(20260801);
  for (const std::uint32_t count :
       {31U, 32U, 33U, 1023U, 1024U, 1025U, 1056U, 1984U, 2048U, 33792U, 34000U}) {
    CAPTURE(count);
    ParticleConfig config = bouncy(256, static_cast<std::int32_t>(count / 128 + 2), count);
    config.most_diameter = 1;
    OwnedParticles used(config);
    ParticleWorld& world = used.world;
    for (std::uint32_t id = 0; id < count; ++id) {
      // Every second cell of a row, so that each may move to its right.
      const auto x = static_cast<std::int32_t>(2 * (id % 128));
      const auto y = static_cast<std::int32_t>(id / 128);
      REQUIRE(world.spawn(x * 65536 + 32769, y * 65536 + 32769, 0, 0, 1, nullptr) == Status::kOk);
    }
    for (int step = 0; step < 24; ++step) {
      CHECK(world.asleep() == 0);
      world.step();
    }
    REQUIRE(world.asleep() == count);
    world.step();
    CHECK(world.counters().moves == 0);
    for (int round = 0; round < 12; ++round) {
      // Some anywhere, or the last ones, or the first of many.
      std::set<std::uint32_t> chosen;
      const std::uint32_t first = round % 3 == 0 ? 0 : static_cast<std::uint32_t>(random()) % count;
      for (std::uint32_t i = 0; i < 1U + (random() & 7U); ++i) {
        chosen.insert(round % 3 == 2 ? first
                                     : first + static_cast<std::uint32_t>(random()) % (count - first));
      }
      if (round % 4 == 3) {
        chosen.insert(count - 1);
      }
      std::vector<Particle> before;
      for (const std::uint32_t id : chosen) {
        before.push_back(used.ball(id));
        const std::int32_t speed = before.back().corner.x % 2 == 0 ? 65536 : -65536;
        REQUIRE(world.set_velocity(id, speed, 0) == Status::kOk);
      }
      CHECK(world.awake() >= chosen.size());
      world.step();
      CHECK(world.counters().moves == chosen.size());
      for (const Particle& was : before) {
        const Particle is = used.ball(was.id);
        CHECK(is.x_q16 == was.x_q16 + (was.corner.x % 2 == 0 ? 65536 : -65536));
        REQUIRE(world.set_velocity(was.id, 0, 0) == Status::kOk);
      }
      // Half of the time they are left awake for the next round.
      for (int step = 0; step < (round % 2 == 0 ? 24 : 2); ++step) {
        world.step();
        CHECK(world.counters().moves == 0);
      }
      if (round % 2 == 0) {
        CHECK(world.asleep() == count);
      }
    }
  }
}

TEST_CASE("particles limits: every cell of a crowded world -> ball_at is the ball whose disc covers it") {
  for (std::int32_t most = 1; most <= kMaxBallDiameter; ++most) {
    ParticleConfig config = bouncy(97, 71, 60);
    config.most_diameter = most;
    config.least_diameter = most > 2 ? most - 2 : 1;
    config.seed = static_cast<std::uint32_t>(most);
    OwnedParticles used(config);
    used.world.draw_wall({3, 60}, {90, 50}, 2);
    for (std::uint32_t i = 0; i < config.capacity; ++i) {
      static_cast<void>(used.world.spawn_random(40000));
    }
    for (int turn = 0; turn < 8; ++turn) {
      std::vector<std::uint32_t> owners(97 * 71, kNoBall);
      for (std::uint32_t id = 0; id < used.world.id_limit(); ++id) {
        const Particle ball = used.ball(id);
        for (std::int32_t row = 0; row < ball.diameter; ++row) {
          for (std::int32_t column = 0; column < ball.diameter; ++column) {
            if (in_disc(ball.diameter, column, row)) {
              owners[static_cast<std::size_t>((ball.corner.y + row) * 97 + ball.corner.x + column)] = id;
            }
          }
        }
      }
      for (std::int32_t y = 0; y < 71; ++y) {
        for (std::int32_t x = 0; x < 97; ++x) {
          REQUIRE(used.world.ball_at({x, y}) == owners[static_cast<std::size_t>(y * 97 + x)]);
        }
      }
      for (int step = 0; step < 5; ++step) {
        used.world.step();
      }
    }
  }
}

// Above half a cell a step a step, what slides moves at half a cell at most; at it, only friction slows it.
TEST_CASE("particles limits: what slides under gravity about half a cell a step -> slowed, or held back") {
  for (const std::int32_t pull : {20000, 32767, 32768, 32769, 40000}) {
    for (const std::int32_t sign : {1, -1}) {
      ParticleConfig config = bouncy(200, 40, 1);
      config.gravity_q16 = {0, sign * pull};
      config.restitution_q16 = 65535;
      OwnedParticles used(config);
      const std::int32_t y = sign > 0 ? 38 * 65536 + 32767 : 2 * 65536 - 32767;
      REQUIRE(used.world.spawn(q16(50), y, 131072, 0, 4, nullptr) == Status::kOk);
      used.world.step();
      CAPTURE(pull);
      REQUIRE(used.world.counters().wall_hits == 1);
      CHECK(used.ball(0).vx_q16 == (pull > 32768 ? 32768 : 131072 - 131072 / 32));
    }
  }
}

TEST_CASE("particles limits: a pointer beyond two fields -> taken at two fields, whatever it does") {
  constexpr std::int32_t kFar = 2 * kMaxFieldSide;
  for (const PointerMode mode : {PointerMode::kDraw, PointerMode::kErase, PointerMode::kAttract}) {
    const auto state = [&](Vec2i at) {
      ParticleConfig config = bouncy(300, 200, 4);
      OwnedParticles used(config);
      used.world.draw_box({{100, 0}, {130, 200}});
      REQUIRE(used.world.spawn(q16(40), q16(40), 0, 0, 4, nullptr) == Status::kOk);
      used.world.set_pointer(mode, {0, 0}, 3);
      used.world.step();
      used.world.set_pointer(mode, at, 3);
      used.world.step();
      return used.world.state_crc32();
    };
    CHECK(state({3 * kMaxFieldSide, kMaxFieldSide}) == state({kFar, kMaxFieldSide}));
    CHECK(state({INT32_MAX, INT32_MAX}) == state({kFar, kFar}));
    CHECK(state({kMaxFieldSide, kFar + 5000}) == state({kMaxFieldSide, kFar}));
    CHECK(state({kFar, -3 * kMaxFieldSide}) == state({kFar, -kMaxFieldSide}));
  }
}

}  // namespace
}  // namespace thimble::tools
