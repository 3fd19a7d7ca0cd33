// The particle world in exact numbers: what a pointer does to a ball's speed, what a brush covers, what is counted, and
// the state's CRC-32 by its definition.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/particle_shadow.h"
#include "thimble/base/memory.h"
#include "thimble/plane/particles.h"

namespace thimble::tools {
namespace {

// A ball alone at (x, y), at rest; what one step with the pointer makes of its speed.
Vec2i speed_after(PointerMode mode, Vec2i place, Vec2i at, std::int32_t radius, std::int32_t strength_q16) {
  OwnedParticles exact(weightless(400, 400));
  std::uint32_t id = 0;
  REQUIRE(exact.world.spawn(place.x, place.y, 0, 0, 1, &id) == Status::kOk);
  if (mode == PointerMode::kDrag) {
    exact.world.set_pointer(mode, {place.x >> 16, place.y >> 16});
    REQUIRE(exact.world.dragged() == id);
  }
  exact.world.set_pointer(mode, at, radius, strength_q16);
  exact.world.step();
  return {exact.ball(id).vx_q16, exact.ball(id).vy_q16};
}

// The rule of pull_balls in real numbers: 4 * strength * distance * (radius - distance) / radius^2 towards the pointer,
// distances cut to 1/16 cell and their length that of an octagon.
double pull(double along, double across, std::int32_t radius, double strength) {
  const double a = std::trunc(std::fabs(along) / 4096);
  const double b = std::trunc(std::fabs(across) / 4096);
  const double larger = std::fmax(a, b);
  const double smaller = std::fmin(a, b);
  const double length = std::fmax(larger, larger - std::floor(larger / 8) + std::floor(smaller / 2));
  const double inward = radius * 16.0 - length;
  if (inward <= 0) {
    return 0;
  }
  // 1/16 cell twice: 1/256, and the 4.
  return std::copysign(a * inward * strength / (64.0 * radius * radius), along);
}

TEST_CASE("particles exact: attract and repel -> the speed that the rule says, to two units, anywhere") {
  constexpr Vec2i kAt{200, 200};
  constexpr std::int32_t kMiddle = kAt.x * 65536 + 32768;
  constexpr std::int32_t kRadius = 40;
  constexpr std::int32_t kStrength = 65536;
  // Centres lie on odd units: a unit before and behind a sixteenth of a cell, at the rim, and anywhere.
  for (const std::int32_t x :
       {4096 * 16 - 1, 4096 * 16 + 1, 4096 * 160 + 1, 1234567, 4096 * 600 - 1, 65535, 7}) {
    for (const std::int32_t y : {4096 * 48 - 1, 4096 * 48 + 1, 4096 * 208 - 1, 765431, 2007041, 21}) {
      for (int turn = 0; turn < 8; ++turn) {
        const std::int32_t sx = (turn & 1) != 0 ? -x : x;
        const std::int32_t sy = (turn & 2) != 0 ? -y : y;
        const std::int32_t dx = (turn & 4) != 0 ? sy : sx;
        const std::int32_t dy = (turn & 4) != 0 ? sx : sy;
        CAPTURE(dx);
        CAPTURE(dy);
        const Vec2i towards =
            speed_after(PointerMode::kAttract, {kMiddle - dx, kMiddle - dy}, kAt, kRadius, kStrength);
        CHECK(std::fabs(towards.x - pull(dx, dy, kRadius, kStrength)) < 2);
        CHECK(std::fabs(towards.y - pull(dy, dx, kRadius, kStrength)) < 2);
        const Vec2i away =
            speed_after(PointerMode::kRepel, {kMiddle - dx, kMiddle - dy}, kAt, kRadius, kStrength);
        CHECK(away == Vec2i{-towards.x, -towards.y});
      }
    }
  }
  // Beyond what a speed may be.
  const Vec2i most = speed_after(PointerMode::kAttract, {kMiddle - 65536 * 100 - 1, kMiddle + 1}, kAt, 200,
                                 kMaxAccelerationQ16);
  CHECK(most.x <= kMaxSpeedQ16);
  CHECK(most.x > kMaxAccelerationQ16 / 2);
}

TEST_CASE("particles exact: drag -> a quarter of the way to the cell's middle, 32 cells at most") {
  constexpr std::int32_t kStart = 200 * 65536 + 1234567 % 65536;
  for (const std::int32_t x : {0, 3, 150, 199, 200, 201, 250, 327, 328, 329, 399, 2000, -2000}) {
    for (const std::int32_t y : {0, 200, 260, 399}) {
      const Vec2i speed = speed_after(PointerMode::kDrag, {kStart, kStart}, {x, y}, 1, 0);
      const auto wanted = [](std::int32_t cell) {
        const double way = cell * 65536.0 + 32768 - (kStart | 1);
        return std::copysign(std::fmin(std::trunc(std::fabs(way) / 4), 32 * 65536.0), way);
      };
      // A wall may have turned it round.
      CHECK(std::abs(speed.x) <= std::fabs(wanted(x)));
      if (x > 120 && x < 280 && y > 120 && y < 280) {
        CHECK(speed.x == wanted(x));
        CHECK(speed.y == wanted(y));
      }
    }
  }
}

TEST_CASE("particles exact: a floor erased from any end -> the ball on it wakes") {
  for (int turn = 0; turn < 4; ++turn) {
    ParticleConfig config = weightless(100, 60);
    config.gravity_q16 = {0, 6554};
    OwnedParticles exact(config);
    exact.world.draw_box({{0, 40}, {100, 42}});
    REQUIRE(exact.world.spawn(50 * 65536, 37 * 65536, 0, 0, 4, nullptr) == Status::kOk);
    for (int step = 0; step < 500 && exact.world.awake() != 0; ++step) {
      exact.world.step();
    }
    REQUIRE(exact.world.asleep() == 1);
    const Vec2i left{5, (turn & 2) != 0 ? 40 : 41};
    const Vec2i right{95, 40};
    exact.world.erase_wall((turn & 1) != 0 ? right : left, (turn & 1) != 0 ? left : right, 5);
    CHECK(exact.world.asleep() == 0);
  }
}

TEST_CASE("particles exact: the state's CRC-32 -> of the bytes that its definition lists") {
  for (const std::int32_t width : {8, 31, 32, 37, 64, 65, 97}) {
    OwnedParticles exact(weightless(width, 20));
    ParticleWorld& world = exact.world;
    std::uint32_t removed = 0;
    REQUIRE(world.spawn(2 * 65536, 3 * 65536, 300, -500, 1, nullptr) == Status::kOk);
    REQUIRE(world.spawn(4 * 65536, 12 * 65536, 0, 0, 3, &removed) == Status::kOk);
    REQUIRE(world.spawn(5 * 65536, 7 * 65536, -70000, 1, 4, nullptr) == Status::kOk);
    REQUIRE(world.remove(removed) == Status::kOk);
    world.draw_box({{width - 2, 0}, {width, 9}});
    world.step();
    std::vector<std::uint8_t> bytes;
    const auto word = [&](std::uint32_t value) {
      for (int i = 0; i < 4; ++i) {
        bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
      }
    };
    for (std::uint32_t id = 0; id < world.id_limit(); ++id) {
      Particle ball;
      if (world.particle(id, &ball)) {
        CHECK(ball.radius_q16 == ball.diameter * 32768);
        word(id);
        word(static_cast<std::uint32_t>(ball.x_q16));
        word(static_cast<std::uint32_t>(ball.y_q16));
        word(static_cast<std::uint32_t>(ball.vx_q16));
        word(static_cast<std::uint32_t>(ball.vy_q16));
        bytes.push_back(static_cast<std::uint8_t>(ball.diameter));
        bytes.push_back(ball.asleep ? 1 : 0);
      }
    }
    for (std::int32_t y = 0; y < 20; ++y) {
      for (std::int32_t x = 0; x < width; x += 8) {
        unsigned eight = 0;
        for (std::int32_t i = 0; i < 8 && x + i < width; ++i) {
          eight |= (world.field().test({x + i, y}) ? 1U : 0U) << i;
        }
        bytes.push_back(static_cast<std::uint8_t>(eight));
      }
    }
    CHECK(world.state_crc32() == crc32({bytes.data(), bytes.size()}));
  }
}

TEST_CASE(
    "particles exact: a random ball that fits exactly -> placed; one that does not -> the same balls to "
    "come") {
  ParticleConfig config = weightless(7, 7);
  config.least_diameter = 7;
  config.most_diameter = 7;
  OwnedParticles whole(config);
  CHECK(whole.world.spawn_random(0) == Status::kOk);
  CHECK(whole.world.spawn_random(0) == Status::kOutOfMemory);
  for (const bool wide : {false, true}) {
    ParticleConfig low = weightless(wide ? 40 : 6, wide ? 6 : 40);
    low.least_diameter = 6;
    low.most_diameter = 7;
    OwnedParticles refused(low);
    OwnedParticles other(low);
    CHECK(refused.world.set_diameters(7, 7) == Status::kOk);
    for (int i = 0; i < 5; ++i) {
      CHECK(refused.world.spawn_random(900) == Status::kOutOfRange);
    }
    CHECK(refused.world.set_diameters(6, 6) == Status::kOk);
    CHECK(other.world.set_diameters(6, 6) == Status::kOk);
    // No room either, until the wall goes.
    refused.world.draw_box({{0, 0}, {40, 40}});
    for (int i = 0; i < 5; ++i) {
      CHECK(refused.world.spawn_random(900) == Status::kOutOfMemory);
    }
    refused.world.erase_box({{0, 0}, {40, 40}});
    CHECK(refused.world.spawn_random(900) == Status::kOk);
    CHECK(other.world.spawn_random(900) == Status::kOk);
    CHECK(refused.world.state_crc32() == other.world.state_crc32());
  }
}

// A world of balls among steps, slopes and thin walls, on which everything acts.
struct Turmoil {
  std::int32_t width, height;
  std::int32_t most_diameter;
  std::uint32_t balls;
  std::uint32_t restitution_q16;
  Vec2i gravity_q16;
  std::int32_t substeps_log2;
  std::int32_t subpixel_bits;
  PointerMode mode;
  std::uint32_t crc32;      // of the state after every fortieth step, one after the other
  std::uint32_t wall_hits;  // in all steps
  std::uint32_t ball_hits;
  std::uint32_t woken;
};

void throw_about(const Turmoil& one, Turmoil* seen) {
  ParticleConfig config;
  config.width = one.width;
  config.height = one.height;
  config.capacity = one.balls;
  config.most_diameter = one.most_diameter;
  config.least_diameter = 1;
  config.restitution_q16 = one.restitution_q16;
  config.gravity_q16 = one.gravity_q16;
  config.substeps_log2 = one.substeps_log2;
  config.subpixel_bits = one.subpixel_bits;
  OwnedParticles exact(config);
  ParticleWorld& world = exact.world;
  for (std::int32_t x = 20; x + 20 < one.width; x += 40) {
    world.draw_wall({x, one.height / 2}, {x + 12, one.height / 2 + x % 17 - 8}, 1 + x % 3);
    world.draw_box({{x + 16, one.height - 9}, {x + 18, one.height}});
  }
  for (std::uint32_t i = 0; i < one.balls; ++i) {
    static_cast<void>(world.spawn_random(static_cast<std::int32_t>(65536 + i % 5 * 300000)));
  }
  *seen = one;
  seen->crc32 = seen->wall_hits = seen->ball_hits = seen->woken = 0;
  for (std::int32_t step = 0; step < 320; ++step) {
    // The pointer goes round; half of the time it is up.
    const Vec2i at{one.width / 2 + (step * 7) % one.width / 2 - one.width / 4, one.height - 5 - step % 60};
    world.set_pointer(step % 80 < 40 ? PointerMode::kNone : one.mode, at, 6 + step % 30, 20000 + 500 * step);
    world.step();
    seen->wall_hits += world.counters().wall_hits;
    seen->ball_hits += world.counters().ball_hits;
    seen->woken += world.counters().woken;
    if (step % 40 == 39) {
      seen->crc32 = seen->crc32 * 31 + world.state_crc32();
    }
  }
}

TEST_CASE("particles exact: turmoil -> the states and counts that were written down") {
  const Turmoil worlds[] = {
      {128, 64, 12, 60, 52429, {0, 6554}, 0, 15, PointerMode::kAttract, 3952014969, 4512, 11681, 177},
      {97, 120, 5, 150, 65536, {0, 0}, 0, 15, PointerMode::kRepel, 3077860083, 10776, 36585, 0},
      {200, 60, 8, 120, 30000, {-9000, 2000}, 1, 15, PointerMode::kDrag, 2981052932, 5602, 24244, 83},
      {300, 200, 12, 200, 0, {3000, -12000}, 0, 6, PointerMode::kErase, 1199609838, 4981, 18251, 66},
      {160, 160, 3, 400, 60000, {4000, 4000}, 2, 10, PointerMode::kDraw, 2803822624, 31831, 48571, 175},
      {64, 640, 12, 90, 52429, {0, 400000}, 0, 15, PointerMode::kSpawn, 1190177148, 1900, 7689, 0},
  };
  for (const Turmoil& one : worlds) {
    Turmoil seen;
    throw_about(one, &seen);
    CAPTURE(seen.balls);
    CHECK(seen.crc32 == one.crc32);
    CHECK(seen.wall_hits == one.wall_hits);
    CHECK(seen.ball_hits == one.ball_hits);
    CHECK(seen.woken == one.woken);
  }
}

}  // namespace
}  // namespace thimble::tools
