// The particle world where its numbers change kind: more balls than a word of the set of those awake has bits, the fastest
// balls, gravity of half a cell, pointers far outside, and which ball covers a cell.
#include <doctest/doctest.h>

#include <cmath>
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

// A ball that is hit without loss leaves along a line u, with 2 mA (v.u) / (mA + mB).
TEST_CASE("particles limits: balls of 256 to 8192 cells a step hit another -> its speed is the elastic one") {
  std::mt19937 random(20260802);
  int hits = 0;
  for (int number = 0; number < 600; ++number) {
    ParticleConfig config = bouncy(300, 300, 2);
    config.most_diameter = kMaxBallDiameter;
    OwnedParticles used(config);
    const auto in = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random() % 65536) / 65536;
    };
    const auto rest = static_cast<std::int32_t>(1 + random() % 16);
    const auto fast = static_cast<std::int32_t>(1 + random() % 16);
    const double speed = 65536 * std::exp2(in(8, 12.9));
    const double angle = in(0, 6.283185);
    const double aside = in(-0.7, 0.7);
    const double apart = (rest + fast) / 2.0 + 2;
    REQUIRE(used.world.spawn(q16(150), q16(150), 0, 0, rest, nullptr) == Status::kOk);
    const auto vx = static_cast<std::int32_t>(speed * std::cos(angle + aside));
    const auto vy = static_cast<std::int32_t>(speed * std::sin(angle + aside));
    REQUIRE(used.world.spawn(q16(150 - apart * std::cos(angle)), q16(150 - apart * std::sin(angle)), vx, vy,
                             fast, nullptr) == Status::kOk);
    used.world.step();
    if (used.world.counters().ball_hits != 1) {
      continue;
    }
    ++hits;
    CAPTURE(number);
    const Particle hit = used.ball(0);
    const double got = std::hypot(hit.vx_q16, hit.vy_q16);
    const double along = (double{1} * vx * hit.vx_q16 + double{1} * vy * hit.vy_q16) / got;
    const double mass = double{1} * fast * fast;
    const double wanted = 2 * mass * along / (mass + double{1} * rest * rest);
    if (std::fabs(wanted) * 1.01 < kMaxSpeedQ16) {
      REQUIRE(got == doctest::Approx(wanted).epsilon(0.001));
    } else {
      REQUIRE(got <= 1.42 * kMaxSpeedQ16);
    }
  }
  CHECK(hits > 200);
}

TEST_CASE(
    "particles limits: equal balls head on, up to 4096 cells a step -> they exchange speeds to the last "
    "unit") {
  for (std::int32_t diameter = 1; diameter <= kMaxBallDiameter; ++diameter) {
    for (const std::int32_t speed : {131073, 1000003, 16777215, 33554433, 98765431, 268435455}) {
      for (const bool upright : {false, true}) {
        ParticleConfig config = bouncy(200, 200, 2);
        config.most_diameter = kMaxBallDiameter;
        OwnedParticles used(config);
        const std::int32_t there = q16(100) + 1;
        const std::int32_t here = there - q16(diameter + 1);
        REQUIRE(used.world.spawn(there, there, 0, 0, diameter, nullptr) == Status::kOk);
        REQUIRE(used.world.spawn(upright ? there : here, upright ? here : there, upright ? 0 : speed,
                                 upright ? speed : 0, diameter, nullptr) == Status::kOk);
        used.world.step();
        REQUIRE(used.world.counters().ball_hits == 1);
        CAPTURE(speed);
        CHECK(used.ball(0).vx_q16 == (upright ? 0 : speed));
        CHECK(used.ball(0).vy_q16 == (upright ? speed : 0));
        CHECK(used.ball(1).vx_q16 == 0);
        CHECK(used.ball(1).vy_q16 == 0);
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
