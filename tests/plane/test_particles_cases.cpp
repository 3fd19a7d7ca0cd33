// The particle world's hard cases by name, what the pointer does, and what the calls refuse.
#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "support/particle_shadow.h"
#include "thimble/plane/particles.h"

namespace thimble::tools {
namespace {

void run(ShadowedWorld& shadow, int steps) {
  for (int step = 0; step < steps; ++step) {
    shadow.world.step();
    REQUIRE(shadow.fault() == "");
  }
}

Particle ball_of(const ShadowedWorld& shadow, std::uint32_t id) {
  Particle ball;
  REQUIRE(shadow.world.particle(id, &ball));
  return ball;
}

TEST_CASE("particles: spawn into a full place -> a status, and nothing has changed") {
  ShadowedWorld shadow(weightless(100, 60, 20));
  REQUIRE(shadow.world.spawn(q16(30), q16(30), 0, 0, 9, nullptr) == Status::kOk);
  shadow.draw_box({{60, 20}, {70, 40}});
  const std::uint32_t crc = shadow.world.state_crc32();
  CHECK(shadow.world.spawn(q16(33), q16(30), 0, 0, 4, nullptr) == Status::kOutOfMemory);
  CHECK(shadow.world.spawn(q16(65), q16(30), 0, 0, 4, nullptr) == Status::kOutOfMemory);
  CHECK(shadow.world.spawn(q16(1), q16(30), 0, 0, 9, nullptr) == Status::kOutOfRange);
  CHECK(shadow.world.spawn(q16(-500), q16(1e4), 0, 0, 9, nullptr) == Status::kOutOfRange);
  CHECK(shadow.world.spawn(q16(50), q16(30), 0, 0, 0, nullptr) == Status::kOutOfRange);
  CHECK(shadow.world.spawn(q16(50), q16(30), 0, 0, 13, nullptr) == Status::kOutOfRange);
  CHECK(shadow.world.spawn(q16(50), q16(30), kMaxSpeedQ16 + 1, 0, 3, nullptr) == Status::kOutOfRange);
  CHECK(shadow.world.state_crc32() == crc);
  CHECK(shadow.world.count() == 1);
  CHECK(shadow.fault() == "");
  // Random places: the last free cells are found, then there are none.
  ParticleConfig config = weightless(20, 20, 500);
  config.most_diameter = 1;
  ShadowedWorld cells(config);
  CHECK(cells.fill(500, 0) == 400);
  const std::uint32_t full = cells.world.state_crc32();
  CHECK(cells.world.spawn_random(0) == Status::kOutOfMemory);
  CHECK(cells.world.state_crc32() == full);
  run(cells, 20);
}

TEST_CASE("particles: held for long under gravity, let go without -> moves for ever") {
  ParticleConfig config = weightless(400, 60, 1);
  config.restitution_q16 = 65536;
  config.gravity_q16 = {0, 32768};
  ShadowedWorld shadow(config);
  REQUIRE(shadow.world.spawn(q16(30), q16(30), 0, 0, 4, nullptr) == Status::kOk);
  shadow.world.set_pointer(PointerMode::kDrag, {30, 30});
  REQUIRE(shadow.world.dragged() == 0);
  run(shadow, 250);
  shadow.world.set_pointer(PointerMode::kNone, {30, 30});
  REQUIRE(shadow.world.set_gravity({0, 0}) == Status::kOk);
  REQUIRE(shadow.world.set_velocity(0, q16(1), 0) == Status::kOk);
  run(shadow, 100);
  CHECK_FALSE(ball_of(shadow, 0).asleep);
  CHECK(ball_of(shadow, 0).vx_q16 == q16(1));
}

TEST_CASE("particles: a level wall, an upright wall and a slope -> mirror the way exactly, and nearly") {
  ParticleConfig config = weightless(200, 200, 1);
  config.restitution_q16 = 65536;
  for (std::int32_t diameter = 2; diameter <= 12; ++diameter) {
    ShadowedWorld level(config);
    level.draw_box({{20, 150}, {180, 152}});
    REQUIRE(level.world.spawn(q16(80), q16(120), q16(0.7), q16(1.3), diameter, nullptr) == Status::kOk);
    run(level, 60);
    CHECK(ball_of(level, 0).vx_q16 == q16(0.7));
    CHECK(ball_of(level, 0).vy_q16 == -q16(1.3));
    // A slope of one in one turns down into sideways.
    ShadowedWorld slope(config);
    for (std::int32_t y = 0; y < 200; ++y) {
      slope.draw_box({{0, y}, {y, y + 1}});
    }
    REQUIRE(slope.world.spawn(q16(100), q16(60), 0, q16(1.1), diameter, nullptr) == Status::kOk);
    run(slope, 100);
    CAPTURE(diameter);
    CHECK(ball_of(slope, 0).vx_q16 > q16(0.8));
    CHECK(ball_of(slope, 0).vy_q16 < q16(0.8));
  }
}

TEST_CASE("particles: settings beyond their limits -> refused") {
  std::vector<std::uint8_t> bytes(1 << 20);
  ParticleWorld world;
  const auto refused = [&](auto change) {
    ParticleConfig config;
    change(config);
    return ParticleWorld::make(config, {bytes.data(), bytes.size()}, &world) == Status::kOutOfRange;
  };
  CHECK(refused([](ParticleConfig& c) { c.width = -1; }));
  CHECK(refused([](ParticleConfig& c) { c.height = kMaxFieldSide + 1; }));
  CHECK(refused([](ParticleConfig& c) { c.capacity = kMaxBalls + 1; }));
  CHECK(refused([](ParticleConfig& c) { c.least_diameter = 0; }));
  CHECK(refused([](ParticleConfig& c) { c.least_diameter = 13; }));
  CHECK(refused([](ParticleConfig& c) { c.most_diameter = kMaxBallDiameter + 1; }));
  CHECK(refused([](ParticleConfig& c) { c.restitution_q16 = 65537; }));
  CHECK(refused([](ParticleConfig& c) { c.gravity_q16.x = kMaxAccelerationQ16 + 1; }));
  CHECK(refused([](ParticleConfig& c) { c.substeps_log2 = 5; }));
  CHECK(refused([](ParticleConfig& c) { c.subpixel_bits = 0; }));
  CHECK(refused([](ParticleConfig& c) { c.subpixel_bits = 16; }));
  CHECK(world.count() == 0);
  REQUIRE(ParticleWorld::make(ParticleConfig{}, {bytes.data(), bytes.size()}, &world) == Status::kOk);
  CHECK(world.set_restitution(65537) == Status::kOutOfRange);
  CHECK(world.set_diameters(3, 13) == Status::kOutOfRange);
  CHECK(world.set_diameters(5, 4) == Status::kOutOfRange);
  REQUIRE(world.set_diameters(5, 5) == Status::kOk);
  std::uint32_t id = 0;
  REQUIRE(world.spawn_random(0, &id) == Status::kOk);
  Particle ball;
  REQUIRE(world.particle(id, &ball));
  CHECK(ball.diameter == 5);
}

}  // namespace
}  // namespace thimble::tools
