// The particle world's hard cases by name, what the pointer does, and what the calls refuse.
#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "support/particle_shadow.h"
#include "thimble/plane/particles.h"

namespace thimble::tools {
namespace {

ParticleConfig box(std::int32_t width, std::int32_t height, std::uint32_t capacity) {
  ParticleConfig config;
  config.width = width;
  config.height = height;
  config.capacity = capacity;
  return config;
}

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
  ShadowedWorld shadow(box(100, 60, 20));
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
  ParticleConfig config = box(20, 20, 500);
  config.least_diameter = 1;
  config.most_diameter = 1;
  ShadowedWorld cells(config);
  CHECK(cells.fill(500, 0) == 400);
  const std::uint32_t full = cells.world.state_crc32();
  CHECK(cells.world.spawn_random(0) == Status::kOutOfMemory);
  CHECK(cells.world.state_crc32() == full);
  run(cells, 20);
}

TEST_CASE("particles: held for long under gravity, let go without -> moves for ever") {
  ParticleConfig config = box(400, 60, 1);
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

TEST_CASE("particles: a box of no cells, or smaller than the ball -> stays empty, steps, takes the pointer") {
  for (const Vec2i size : {Vec2i{0, 0}, Vec2i{0, 40}, Vec2i{40, 0}, Vec2i{1, 1}, Vec2i{5, 40}}) {
    ParticleConfig config = box(size.x, size.y, 3);
    config.least_diameter = 8;
    ShadowedWorld shadow(config);
    REQUIRE(shadow.status == Status::kOk);
    CHECK(shadow.world.spawn_random(q16(3)) == Status::kOutOfRange);
    CHECK(shadow.world.spawn(q16(2), q16(2), 0, 0, 8, nullptr) == Status::kOutOfRange);
    shadow.draw_wall({-3, -3}, {50, 50}, 2);
    for (int mode = 0; mode <= static_cast<int>(PointerMode::kDraw); ++mode) {
      shadow.world.set_pointer(static_cast<PointerMode>(mode), {3, 3}, 20, q16(1));
      shadow.world.step();
    }
    shadow.world.erase_wall({0, 0}, {50, 50}, 5);
    shadow.world.erase_box({{0, 0}, {50, 50}});
    shadow.world.erase_box({{INT32_MIN, INT32_MIN}, {INT32_MAX, INT32_MAX}});
    CHECK(shadow.world.count() == 0);
    CHECK(shadow.world.ball_at({0, 0}) == kNoBall);
  }
}

TEST_CASE(
    "particles: any box drawn and erased, to the ends of what a number can say -> walls go, balls stay") {
  const std::int32_t ends[] = {INT32_MIN, INT32_MIN + 1, -1000000,      -1,       0, 7, 30, 40,
                               41,        1000000,       INT32_MAX - 1, INT32_MAX};
  ShadowedWorld shadow(box(40, 30, 12));
  shadow.fill(12, q16(1));
  for (int step = 0; step < 300; ++step) {
    shadow.world.step();
  }
  for (const std::int32_t x0 : ends) {
    for (const std::int32_t x1 : ends) {
      for (const std::int32_t y0 : {INT32_MIN, -5, 3, 29, INT32_MAX}) {
        for (const std::int32_t y1 : {INT32_MIN, 2, 12, 30, INT32_MAX}) {
          shadow.world.draw_box({{x0, y0}, {x1, y1}});
          shadow.world.erase_box({{x0, y0}, {x1, y1}});
          REQUIRE(shadow.fault() == "");
        }
      }
    }
  }
  shadow.world.erase_box({{INT32_MIN, INT32_MIN}, {INT32_MAX, INT32_MAX}});
  CHECK(shadow.world.count() == 12);
  run(shadow, 50);
}

TEST_CASE("particles: room for no ball, and for one -> works") {
  ShadowedWorld none(box(50, 50, 0));
  CHECK(none.world.spawn_random(0) == Status::kOutOfMemory);
  CHECK(none.world.spawn(q16(20), q16(20), 0, 0, 3, nullptr) == Status::kOutOfMemory);
  run(none, 5);
  ShadowedWorld one(box(50, 50, 1));
  CHECK(one.fill(2, q16(2)) == 1);
  for (int step = 0; step < 2000 && one.world.awake() != 0; ++step) {
    run(one, 1);
  }
  CHECK(one.world.asleep() == 1);
}

TEST_CASE("particles: restitution 0 and 1 -> a ball dropped stays down, or comes up again") {
  for (const std::uint32_t restitution : {0U, 65536U}) {
    ParticleConfig config = box(40, 200, 1);
    config.restitution_q16 = restitution;
    ShadowedWorld shadow(config);
    REQUIRE(shadow.world.spawn(q16(20), q16(20), 0, 0, 6, nullptr) == Status::kOk);
    std::int32_t highest = q16(200);
    bool fell = false;
    for (int step = 0; step < 400; ++step) {
      run(shadow, 1);
      const Particle ball = ball_of(shadow, 0);
      fell = fell || ball.y_q16 > q16(195);
      if (fell && ball.y_q16 < highest) {
        highest = ball.y_q16;
      }
    }
    REQUIRE(fell);
    if (restitution == 0) {
      CHECK(highest > q16(196));
      CHECK(ball_of(shadow, 0).asleep);
    } else {
      CHECK(highest < q16(40));
    }
  }
}

TEST_CASE("particles: gravity far too strong -> nothing tunnels, and the heap sleeps all the same") {
  for (const double pull : {5.0, 100.0, 1024.0}) {
    ParticleConfig config = box(200, 150, 100);
    config.gravity_q16 = {0, q16(pull)};
    ShadowedWorld shadow(config);
    shadow.draw_box({{0, 100}, {200, 101}});
    shadow.fill(100, q16(3));
    std::vector<bool> above;
    for (std::uint32_t id = 0; id < shadow.world.count(); ++id) {
      above.push_back(ball_of(shadow, id).y_q16 < q16(100));
    }
    for (int step = 0; step < 1500 && shadow.world.awake() != 0; ++step) {
      run(shadow, 1);
    }
    CHECK(shadow.world.awake() == 0);
    for (std::uint32_t id = 0; id < shadow.world.count(); ++id) {
      CHECK(above[id] == (ball_of(shadow, id).y_q16 < q16(100)));
    }
  }
}

TEST_CASE("particles: a ball in a slot of its own width -> falls through it and comes to rest") {
  for (std::int32_t diameter = 1; diameter <= 12; ++diameter) {
    ParticleConfig config = box(60, 80, 1);
    config.least_diameter = 1;
    ShadowedWorld shadow(config);
    shadow.draw_box({{0, 20}, {30, 60}});
    shadow.draw_box({{30 + diameter, 20}, {60, 60}});
    const std::int32_t x = 30 * 65536 + diameter * 32768 + 1;
    REQUIRE(shadow.world.spawn(x, q16(12), q16(0.01), 0, diameter, nullptr) == Status::kOk);
    for (int step = 0; step < 3000 && shadow.world.awake() != 0; ++step) {
      run(shadow, 1);
    }
    CAPTURE(diameter);
    CHECK(ball_of(shadow, 0).asleep);
    CHECK(ball_of(shadow, 0).corner.y == 80 - diameter);
  }
  // Across: to and fro for ever at restitution 1.
  ParticleConfig config = box(60, 7, 1);
  config.gravity_q16 = {0, 0};
  config.restitution_q16 = 65536;
  ShadowedWorld shadow(config);
  REQUIRE(shadow.world.spawn(q16(30), q16(3.5), q16(5000), q16(77), 7, nullptr) == Status::kOk);
  const UInt128 energy = shadow.world.energy();
  run(shadow, 500);
  CHECK(shadow.world.energy().low == energy.low);
}

TEST_CASE("particles: pointer events outside the box -> nothing breaks") {
  ShadowedWorld shadow(box(100, 80, 60));
  shadow.fill(50, q16(2));
  const Vec2i places[] = {{-1, -1}, {100, 80}, {-30000, 5}, {5, 2000000000}, {-2000000000, -2000000000},
                          {99, 79}};
  for (int mode = 0; mode <= static_cast<int>(PointerMode::kDraw); ++mode) {
    for (const Vec2i at : places) {
      shadow.world.set_pointer(static_cast<PointerMode>(mode), at, 2000000000, 2000000000);
      shadow.world.step();
      shadow.note_walls();
      REQUIRE(shadow.fault() == "");
      shadow.world.set_pointer(static_cast<PointerMode>(mode), at, -5, -5);
      shadow.world.step();
      shadow.note_walls();
      REQUIRE(shadow.fault() == "");
    }
  }
}

TEST_CASE("particles: spawn, draw and erase with the pointer -> balls and walls come and go") {
  ShadowedWorld shadow(box(120, 90, 40));
  shadow.world.set_pointer(PointerMode::kSpawn, {60, 20});
  run(shadow, 60);
  const std::uint32_t spawned = shadow.world.count();
  CHECK(spawned > 3);
  shadow.world.set_pointer(PointerMode::kDraw, {10, 40}, 2);
  shadow.world.set_pointer(PointerMode::kDraw, {110, 45}, 2);
  shadow.world.step();
  shadow.note_walls();
  CHECK(shadow.world.field().test({11, 40}));
  CHECK(shadow.world.field().test({109, 45}));
  run(shadow, 200);
  shadow.world.set_pointer(PointerMode::kErase, {60, 80}, 300);
  shadow.world.step();
  CHECK(shadow.world.count() == 0);
  CHECK(shadow.world.field().count() == 0);
  CHECK(shadow.world.awake() == 0);
}

TEST_CASE("particles: a wall drawn over balls -> leaves out their cells, and they move") {
  ShadowedWorld shadow(box(100, 60, 20));
  shadow.fill(20, q16(2));
  shadow.draw_box({{0, 0}, {100, 60}});
  CHECK(shadow.world.field().count() == 6000);
  run(shadow, 5);
  shadow.erase_box({{0, 0}, {100, 60}});
  REQUIRE(shadow.fault() == "");
  run(shadow, 200);
}

TEST_CASE("particles: removed balls -> their numbers are used again, what rested on them wakes") {
  ShadowedWorld shadow(box(60, 60, 3));
  std::uint32_t lower = 0;
  std::uint32_t upper = 0;
  REQUIRE(shadow.world.spawn(q16(30) | 1, q16(54) | 1, 0, 0, 12, &lower) == Status::kOk);
  REQUIRE(shadow.world.spawn(q16(30) | 1, q16(40) | 1, 0, 0, 12, &upper) == Status::kOk);
  for (int step = 0; step < 500 && shadow.world.awake() != 0; ++step) {
    run(shadow, 1);
  }
  REQUIRE(shadow.world.asleep() == 2);
  REQUIRE(shadow.world.remove(lower) == Status::kOk);
  CHECK(shadow.world.remove(lower) == Status::kOutOfRange);
  CHECK(shadow.world.remove(77) == Status::kOutOfRange);
  CHECK(shadow.world.awake() == 1);
  run(shadow, 300);
  CHECK(ball_of(shadow, upper).corner.y == 48);
  std::uint32_t again = kNoBall;
  REQUIRE(shadow.world.spawn(q16(10), q16(10), 0, 0, 3, &again) == Status::kOk);
  CHECK(again == lower);
  CHECK(shadow.world.ball_at({10, 10}) == again);
}

TEST_CASE("particles: gravity that changes -> wakes everything, and the heap falls the other way") {
  ShadowedWorld shadow(box(100, 100, 40));
  shadow.fill(40, 0);
  for (const Vec2i gravity :
       {Vec2i{0, q16(0.1)}, Vec2i{0, q16(-0.1)}, Vec2i{q16(0.1), 0}, Vec2i{q16(-0.1), q16(0.1)}}) {
    REQUIRE(shadow.world.set_gravity(gravity) == Status::kOk);
    CHECK(shadow.world.asleep() == 0);
    for (int step = 0; step < 2500 && shadow.world.awake() != 0; ++step) {
      run(shadow, 1);
    }
    CHECK(shadow.world.awake() == 0);
    run(shadow, 20);
    CHECK(shadow.world.awake() == 0);
    REQUIRE(shadow.world.set_gravity({0, 0}) == Status::kOk);
    run(shadow, 2);
  }
  CHECK(shadow.world.set_gravity({0, kMaxAccelerationQ16 + 1}) == Status::kOutOfRange);
}

TEST_CASE("particles: a level wall, an upright wall and a slope -> mirror the way exactly, and nearly") {
  ParticleConfig config = box(200, 200, 1);
  config.gravity_q16 = {0, 0};
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
