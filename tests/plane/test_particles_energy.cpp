// The energy of balls under gravity, in exact integers: of the speed and of the height together.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <vector>

#include "thimble/plane/particles.h"

namespace thimble::tools {
namespace {

__extension__ typedef __int128 Energy;

struct Fall {
  const char* name;
  std::int32_t width, height;
  std::uint32_t balls;
  Vec2i gravity_q16;
  std::int32_t substeps_log2;
  std::int32_t subpixel_bits;
};

struct FallingWorld {
  FallingWorld(const Fall& fall, std::uint32_t restitution_q16) {
    ParticleConfig config;
    config.width = fall.width;
    config.height = fall.height;
    config.capacity = fall.balls;
    config.gravity_q16 = fall.gravity_q16;
    config.restitution_q16 = restitution_q16;
    config.substeps_log2 = fall.substeps_log2;
    config.subpixel_bits = fall.subpixel_bits;
    bytes.resize(particles_bytes(config));
    REQUIRE(ParticleWorld::make(config, {bytes.data(), bytes.size()}, &world) == Status::kOk);
    for (std::uint32_t i = 0; i < fall.balls; ++i) {
      // A box may be full before.
      static_cast<void>(world.spawn_random(65536));
    }
  }
  // Sum of mass * (|2 v + k|^2 + 8 K * depth): a speed is that of half a step of gravity k before the time of
  // its place, and K is k in all substeps together. Depths are from where gravity pulls to.
  Energy energy() const {
    const ParticleConfig& config = world.config();
    const std::int64_t parts = std::int64_t{1} << config.substeps_log2;
    Energy sum = 0;
    for (std::uint32_t id = 0; id < world.id_limit(); ++id) {
      Particle ball;
      if (!world.particle(id, &ball)) {
        continue;
      }
      const Vec2i speed{ball.vx_q16, ball.vy_q16};
      const Vec2i place{ball.x_q16, ball.y_q16};
      const Vec2i size{config.width, config.height};
      for (int axis = 0; axis < 2; ++axis) {
        const std::int64_t gravity = config.gravity_q16[axis];
        const std::int64_t kick = (std::abs(gravity) + parts / 2) / parts;
        const std::int64_t depth = gravity < 0
                                       ? place[axis] - ball.radius_q16
                                       : size[axis] * std::int64_t{65536} - ball.radius_q16 - place[axis];
        const std::int64_t twice = 2 * std::int64_t{speed[axis]} + (gravity < 0 ? -kick : kick);
        sum += (static_cast<Energy>(twice) * twice + static_cast<Energy>(8) * kick * parts * depth) *
               ball.diameter * ball.diameter;
      }
    }
    return sum;
  }
  std::vector<std::uint8_t> bytes;
  ParticleWorld world;
};

constexpr Fall kFalls[] = {
    {"a few", 160, 120, 40, {0, 6554}, 0, 15},
    {"no gravity", 160, 120, 40, {0, 0}, 0, 15},
    {"in four parts", 160, 120, 40, {0, 6554}, 2, 15},
    {"aslant", 160, 120, 40, {-3000, 6554}, 0, 15},
    {"to the left, weakly", 128, 64, 60, {-655, 0}, 0, 15},
    {"places to an eighth", 160, 120, 40, {0, 6554}, 0, 3},
    {"one ball", 40, 200, 1, {0, 6554}, 0, 15},
    {"a full box", 60, 60, 60, {0, 6554}, 0, 15},
};

// Gravity as strong as keeps the energy: a quarter of a cell a step in each part of a step.
constexpr Fall kStrongFalls[] = {
    {"a quarter of a cell a step", 60, 60, 60, {0, 16384}, 0, 15},
    {"four cells in sixteen parts", 160, 120, 40, {0, 4 * 65536}, 4, 15},
};

// Millionths of the start by which the energy left it at most.
std::int64_t greatest_change(const Fall& fall, std::uint32_t restitution_q16, int steps) {
  FallingWorld falling(fall, restitution_q16);
  const Energy start = falling.energy();
  std::int64_t greatest = 0;
  for (int step = 1; step <= steps; ++step) {
    falling.world.step();
    if (step % 50 == 0 || step < 500) {
      const Energy change = falling.energy() - start;
      greatest =
          std::max(greatest, static_cast<std::int64_t>((change < 0 ? -change : change) * 1000000 / start));
    }
  }
  CHECK(falling.world.asleep() == 0);
  return greatest;
}

TEST_CASE("particles energy: bounciness 1, gravity of a quarter cell -> within 1 per cent of the start") {
  // A million steps of each with THIMBLE_LONG=1.
  const int steps = std::getenv("THIMBLE_LONG") != nullptr ? 1000000 : 20000;
  std::vector<Fall> falls(std::begin(kFalls), std::end(kFalls));
  falls.insert(falls.end(), std::begin(kStrongFalls), std::end(kStrongFalls));
  for (const Fall& fall : falls) {
    CAPTURE(fall.name);
    const std::int64_t greatest = greatest_change(fall, 65536, steps);
    MESSAGE(fall.name, ": ", greatest, " millionths");
    CHECK(greatest < 10000);
  }
}

TEST_CASE("particles energy: bounciness below 1 -> never above the start, nor above what it was before") {
  constexpr std::size_t kSteps = 3000;
  constexpr std::size_t kWhile = 64;
  for (const std::uint32_t restitution : {0U, 32768U, 52429U, 62000U, 65000U, 65470U, 65530U, 65535U}) {
    for (const Fall& fall : kFalls) {
      CAPTURE(fall.name);
      CAPTURE(restitution);
      FallingWorld falling(fall, restitution);
      const Energy start = falling.energy();
      // What is still to be paid back: the less, the more is lost in the same blows.
      const Energy pending = start / (restitution < 65000 ? 1000 : 100);
      std::vector<Energy> least{start};
      for (std::size_t step = 1; step <= kSteps; ++step) {
        falling.world.step();
        const Energy now = falling.energy();
        CHECK(now <= start + pending);
        CHECK(now <= least[step > kWhile ? step - kWhile : 0] + pending);
        least.push_back(std::min(least.back(), now));
      }
    }
  }
}

TEST_CASE("particles energy: bounciness set to 1 -> what was lost before does not come back") {
  FallingWorld falling(kFalls[0], 32768);
  for (int step = 0; step < 60; ++step) {
    falling.world.step();
  }
  REQUIRE(falling.world.set_restitution(65536) == Status::kOk);
  const Energy then = falling.energy();
  for (int step = 0; step < 3000; ++step) {
    falling.world.step();
    const Energy change = falling.energy() - then;
    REQUIRE((change < 0 ? -change : change) * 100 < then);
  }
}

}  // namespace
}  // namespace thimble::tools
