// The particle world's invariants, after every step: what is in the field, what sleeps, energy, momentum,
// symmetry. THIMBLE_LONG=1 makes the runs longer.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <vector>

#include "support/counts.h"
#include "support/particle_shadow.h"
#include "thimble/plane/particles.h"

namespace thimble::tools {
namespace {

const int kShare = thimble::tests::many_or_few(1, 10);

bool long_runs() {
  return std::getenv("THIMBLE_LONG") != nullptr;
}

double wide(UInt128 value) {
  return static_cast<double>(value.high) * 0x1p64 + static_cast<double>(value.low);
}

TEST_CASE("particles: worlds of every kind -> field, discs and sleepers are right after every step") {
  std::mt19937 random(20240607);
  const auto below = [&random](std::uint32_t limit) {
    return static_cast<std::int32_t>((std::uint64_t{random()} * limit) >> 32);
  };
  const int worlds = (long_runs() ? 3000 : 250) / kShare;
  for (int number = 0; number < worlds; ++number) {
    ParticleConfig config;
    config.seed = static_cast<std::uint32_t>(random());
    config.width = 1 + below(number % 3 == 0 ? 40 : 160);
    config.height = 1 + below(number % 3 == 1 ? 40 : 160);
    config.most_diameter = 1 + below(kMaxBallDiameter);
    config.least_diameter = 1 + below(static_cast<std::uint32_t>(config.most_diameter));
    config.restitution_q16 = static_cast<std::uint32_t>(below(4) == 0   ? 65536
                                                        : below(3) == 0 ? 0
                                                                        : below(65537));
    config.capacity = 200;
    config.substeps_log2 = below(3) == 0 ? below(5) : 0;
    config.subpixel_bits = below(3) == 0 ? 1 + below(15) : 15;
    const double pulls[] = {0, 0, 0.05, 0.1, 1, 50, 1000};
    const auto pull = [&] { return q16(pulls[below(7)]) * (below(2) == 0 ? 1 : -1); };
    config.gravity_q16 = {below(2) == 0 ? 0 : pull(), pull()};
    const double speeds[] = {0, 0.5, 3, 30, 1000, 5000, 8192};
    const std::int32_t speed = q16(speeds[below(7)]);
    CAPTURE(number);
    CAPTURE(config.seed);
    ShadowedWorld shadow(config);
    REQUIRE(shadow.status == Status::kOk);
    for (int wall = below(4); wall > 0; --wall) {
      shadow.draw_wall({below(200) - 20, below(200) - 20}, {below(200) - 20, below(200) - 20}, 1 + below(3));
    }
    // From one ball to a packed box.
    const std::uint32_t wanted = below(3) == 0 ? 200 : 1 + static_cast<std::uint32_t>(below(30));
    shadow.fill(wanted, speed);
    REQUIRE(shadow.fault() == "");
    for (int step = 0; step < 60; ++step) {
      CAPTURE(step);
      switch (below(40)) {
        case 0:
          REQUIRE(shadow.world.set_gravity({pull(), pull()}) == Status::kOk);
          break;
        case 1:
          shadow.draw_wall({below(200) - 20, below(200) - 20}, {below(200) - 20, below(200) - 20},
                           1 + below(4));
          break;
        case 2: {
          const Vec2i at{below(160) - 5, below(160) - 5};
          shadow.erase_box({at, {at.x + below(60), at.y + below(60)}});
          break;
        }
        case 3:
          static_cast<void>(
              shadow.world.remove(static_cast<std::uint32_t>(below(shadow.world.id_limit() + 1))));
          break;
        case 4:
          static_cast<void>(shadow.world.spawn_random(speed));
          break;
        default:
          break;
      }
      REQUIRE(shadow.fault() == "");
      shadow.world.step();
      REQUIRE(shadow.fault() == "");
    }
  }
}

TEST_CASE("particles: 5,000 cells a step -> nothing comes through a wall of one cell") {
  for (const bool upright : {true, false}) {
    for (const double speed : {50.0, 500.0, 5000.0}) {
      ParticleConfig config = weightless(800, 600, 40);
      config.restitution_q16 = 65536;
      ShadowedWorld shadow(config);
      shadow.draw_box(upright ? CellBox{{400, 0}, {401, 600}} : CellBox{{0, 300}, {800, 301}});
      REQUIRE(shadow.fill(40, q16(speed)) == 40);
      const auto side = [&](std::uint32_t id) {
        Particle ball;
        REQUIRE(shadow.world.particle(id, &ball));
        return upright ? ball.x_q16 < 400 * 65536 : ball.y_q16 < 300 * 65536;
      };
      std::vector<bool> before;
      for (std::uint32_t id = 0; id < 40; ++id) {
        // All as fast as it goes, towards the wall and aslant.
        const std::int32_t across = q16(side(id) ? speed : -speed);
        const std::int32_t along = q16(speed / 3) * (id % 3 == 0 ? 0 : id % 3 == 1 ? 1 : -1);
        REQUIRE(shadow.world.set_velocity(id, upright ? across : along, upright ? along : across) ==
                Status::kOk);
        before.push_back(side(id));
      }
      const UInt128 energy = shadow.world.energy();
      for (int step = 0; step < 200 / kShare; ++step) {
        shadow.world.step();
        for (std::uint32_t id = 0; id < 40; ++id) {
          REQUIRE(side(id) == before[id]);
        }
      }
      CHECK(shadow.fault() == "");
      // Light balls struck at 5,000 cells a step exceed what a velocity may be, and are cut to that.
      CHECK(wide(shadow.world.energy()) <= wide(energy) * (1 + 1e-4));
      if (speed < 5000) {
        CHECK(wide(shadow.world.energy()) >= wide(energy) * (1 - 1e-4));
      }
    }
  }
}

// Lets a world fall until all sleep; the step at which they do, or `limit`.
int settle(ShadowedWorld& shadow, int limit, int check_every) {
  for (int step = 0; step < limit; ++step) {
    if (shadow.world.awake() == 0) {
      return step;
    }
    shadow.world.step();
    if (step % check_every == 0) {
      REQUIRE(shadow.fault() == "");
    }
  }
  return limit;
}

void check_stays_asleep(ShadowedWorld& shadow) {
  const std::uint32_t crc = shadow.world.state_crc32();
  for (int step = 0; step < 2000; ++step) {
    shadow.world.step();
    REQUIRE(shadow.world.counters().moves == 0);
  }
  CHECK(shadow.world.awake() == 0);
  CHECK(shadow.world.state_crc32() == crc);
  CHECK(shadow.fault() == "");
}

TEST_CASE("particles: a heap of 10,000 under gravity -> does not boil, all asleep within 5,000 steps") {
  for (std::uint32_t seed = 1; seed <= (long_runs() ? 5U : 1U); ++seed) {
    ParticleConfig config;
    const double scale = kShare == 1 ? 3.8 : 1.2;
    config.width = static_cast<std::int32_t>(800 * scale);
    config.height = static_cast<std::int32_t>(600 * scale);
    config.capacity = static_cast<std::uint32_t>(693 * scale * scale);
    config.seed = seed;
    ShadowedWorld shadow(config);
    REQUIRE(shadow.fill(config.capacity, q16(3)) == config.capacity);
    const int steps = settle(shadow, 5000, 200);
    MESSAGE("seed ", seed, ": ", config.capacity, " balls, ", steps, " steps");
    REQUIRE(steps < 5000);
    check_stays_asleep(shadow);
    // Shaken awake, the heap goes back to sleep instead of gaining energy from where the cells block it.
    shadow.world.wake_all();
    double most = 0;
    for (int step = 0; step < 200; ++step) {
      shadow.world.step();
      most = std::fmax(most, wide(shadow.world.energy()));
    }
    const double mass = 65.0 * config.capacity;
    CHECK(std::sqrt(most / mass) / 65536 < 0.5);  // cells a step, root of the mean square
    CHECK(settle(shadow, 1500, 500) < 1500);
  }
}

TEST_CASE("particles: supports taken away one after the other -> sleepers above wake, none hangs") {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    ParticleConfig config;
    config.width = 120;
    config.height = 100;
    config.capacity = 80;
    config.seed = seed;
    ShadowedWorld shadow(config);
    shadow.draw_box({{10, 60}, {110, 62}});
    shadow.draw_wall({0, 40}, {50, 55}, 1);
    shadow.fill(80, q16(1));
    REQUIRE(settle(shadow, 3000, 10) < 3000);
    std::mt19937 random(seed);
    while (shadow.world.count() > 20) {
      // The ball removed may be anywhere in the heap.
      static_cast<void>(shadow.world.remove(static_cast<std::uint32_t>(random()) % shadow.world.id_limit()));
      REQUIRE(shadow.fault() == "");
      for (int step = 0; step < 5; ++step) {
        shadow.world.step();
        REQUIRE(shadow.fault() == "");
      }
    }
    shadow.erase_box({{0, 0}, {120, 100}});
    REQUIRE(shadow.fault() == "");
    CHECK(settle(shadow, 3000, 1) < 3000);
  }
}

TEST_CASE(
    "particles: two balls collide -> momentum kept to half the lighter one's mass, energy at restitution 1") {
  std::mt19937 random(5);
  int collisions = 0;
  for (int number = 0; number < 20000 / kShare; ++number) {
    ParticleConfig config = weightless(60, 60, 2);
    config.most_diameter = 16;
    config.restitution_q16 = number % 2 == 0 ? 65536 : static_cast<std::uint32_t>(random() % 65537);
    OwnedParticles owned(config);
    ParticleWorld& world = owned.world;
    const auto in = [&](std::int32_t low, std::int32_t high) {
      return low + static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(high - low + 1));
    };
    const std::int32_t a = in(1, 16);
    const std::int32_t b = in(1, 16);
    const std::int32_t speed = number % 3 == 0 ? q16(0.01) : number % 3 == 1 ? q16(3) : q16(12);
    REQUIRE(world.spawn(q16(30), q16(30), in(-speed, speed), in(-speed, speed), a, nullptr) == Status::kOk);
    if (world.spawn(in(q16(18), q16(42)), in(q16(18), q16(42)), in(-speed, speed), in(-speed, speed), b,
                    nullptr) != Status::kOk) {
      continue;
    }
    const ParticleWorld::Momentum before = world.momentum();
    const double energy = wide(world.energy());
    world.step();
    if (world.counters().ball_hits == 0 || world.counters().wall_hits != 0) {
      continue;
    }
    ++collisions;
    const std::int64_t lighter = static_cast<std::int64_t>(a < b ? a : b) * (a < b ? a : b);
    const ParticleWorld::Momentum after = world.momentum();
    CAPTURE(number);
    const std::int64_t bound = lighter * world.counters().ball_hits;  // twice the error
    REQUIRE(2 * std::abs(after.x - before.x) <= bound);
    REQUIRE(2 * std::abs(after.y - before.y) <= bound);
    if (config.restitution_q16 == 65536 && number % 3 != 0) {
      REQUIRE(std::fabs(wide(world.energy()) / energy - 1) < 0.01);
    }
  }
  CHECK(collisions > 1000 / kShare);
}

// The eight ways to turn and mirror a square.
struct Turn {
  bool swap;
  std::int32_t x;  // sign of what was x
  std::int32_t y;
  Vec2i apply(Vec2i v) const {
    const Vec2i w{v.x * x, v.y * y};
    return swap ? Vec2i{w.y, w.x} : w;
  }
  // A point of a square of `side`, mirrored in its middle.
  Vec2i place(Vec2i v, std::int32_t side) const {
    const Vec2i w{x < 0 ? side - v.x : v.x, y < 0 ? side - v.y : v.y};
    return swap ? Vec2i{w.y, w.x} : w;
  }
};

TEST_CASE(
    "particles: worlds that are turned or mirrored -> stay images of one another, bit for bit, for 10,000 "
    "steps") {
  constexpr std::int32_t kSide = 200;
  for (const bool falling : {false, true}) {
    ParticleConfig config;
    config.width = kSide;
    config.height = kSide;
    config.capacity = 120;
    config.restitution_q16 = falling ? 52429 : 65536;
    const Vec2i gravity = falling ? Vec2i{q16(0.02), q16(0.1)} : Vec2i{};
    config.gravity_q16 = gravity;
    ShadowedWorld first(config);
    first.draw_wall({40, 90}, {120, 150}, 3);
    first.fill(120, q16(3));
    std::vector<Turn> turns;
    std::vector<ShadowedWorld> images;
    for (const bool swap : {false, true}) {
      for (const std::int32_t x : {1, -1}) {
        for (const std::int32_t y : {1, -1}) {
          const Turn turn{swap, x, y};
          config.gravity_q16 = turn.apply(gravity);
          turns.push_back(turn);
          images.emplace_back(config);
          for (std::int32_t row = 0; row < kSide; ++row) {
            for (std::int32_t column = 0; column < kSide; ++column) {
              if (first.world.field().test({column, row}) && first.world.ball_at({column, row}) == kNoBall) {
                // The middle of the cell, in half cells, to keep to integers.
                const Vec2i at = turn.place({2 * column + 1, 2 * row + 1}, 2 * kSide);
                images.back().world.draw_box({{at.x / 2, at.y / 2}, {at.x / 2 + 1, at.y / 2 + 1}});
              }
            }
          }
          for (std::uint32_t id = 0; id < first.world.count(); ++id) {
            Particle ball;
            REQUIRE(first.world.particle(id, &ball));
            const Vec2i at = turn.place({ball.x_q16, ball.y_q16}, kSide * 65536);
            const Vec2i v = turn.apply({ball.vx_q16, ball.vy_q16});
            REQUIRE(images.back().world.spawn(at.x, at.y, v.x, v.y, ball.diameter, nullptr) == Status::kOk);
          }
        }
      }
    }
    for (int step = 1; step <= 10000 / kShare; ++step) {
      first.world.step();
      for (ShadowedWorld& image : images) {
        image.world.step();
      }
      if (step > 20 && step % 500 != 0) {
        continue;
      }
      CAPTURE(falling);
      CAPTURE(step);
      for (std::size_t number = 0; number < images.size(); ++number) {
        CAPTURE(number);
        for (std::uint32_t id = 0; id < first.world.count(); ++id) {
          Particle ball;
          Particle image;
          REQUIRE(first.world.particle(id, &ball));
          REQUIRE(images[number].world.particle(id, &image));
          REQUIRE(turns[number].place({ball.x_q16, ball.y_q16}, kSide * 65536) ==
                  Vec2i{image.x_q16, image.y_q16});
          REQUIRE(turns[number].apply({ball.vx_q16, ball.vy_q16}) == Vec2i{image.vx_q16, image.vy_q16});
          REQUIRE(ball.asleep == image.asleep);
        }
      }
    }
  }
}

TEST_CASE(
    "particles: bytes -> 150,000 hold the paper's world, a few thousand an OLED's, none less is taken") {
  const ParticleConfig paper;
  CHECK(particles_bytes(paper) <= 150000);
  ParticleConfig config;
  config.width = 128;
  config.height = 64;
  config.capacity = 60;
  config.most_diameter = 8;
  static_assert(particles_bytes(128, 64, 60, 8) < 4096);
  const std::size_t needed = particles_bytes(config);
  MESSAGE("bytes: the paper's world ", particles_bytes(paper), ", an OLED's ", needed);
  // At any address, and not a byte further.
  for (std::size_t offset = 0; offset < 8; ++offset) {
    std::vector<std::uint8_t> bytes(needed + 64, 0xA5);
    ParticleWorld world;
    CHECK(ParticleWorld::make(config, {bytes.data() + offset, needed - 1}, &world) == Status::kOutOfMemory);
    REQUIRE(ParticleWorld::make(config, {bytes.data() + offset, needed}, &world) == Status::kOk);
    while (world.spawn_random(q16(5)) == Status::kOk) {
    }
    for (int step = 0; step < 300; ++step) {
      world.step();
    }
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      if (i < offset || i >= offset + needed) {
        REQUIRE(bytes[i] == 0xA5);
      }
    }
  }
}

}  // namespace
}  // namespace thimble::tools
