// Every public function of plane with any boxes, discs, balls and pointers: refused or done, in the
// bytes.
#include <doctest/doctest.h>

#include <cstdint>

#include "misuse/odd_values.h"
#include "misuse/odd_worlds.h"
#include "thimble/plane/bitfield.h"
#include "thimble/plane/particles.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

Vec2i odd_cell(OddValues& odd) {
  return odd.one_in(3) ? Vec2i{odd.any<std::int32_t>(), odd.any<std::int32_t>()}
                       : Vec2i{odd.between_32(-20, 150), odd.between_32(-20, 150)};
}

void use(OddValues& odd, BitField& field) {
  const CellBox box{odd_cell(odd), odd_cell(odd)};
  const DiscStamp disc = disc_stamp(odd.any_or(4, -1, 40));
  const Vec2i corner = odd_cell(odd);
  (void)field.window(odd.any<std::int32_t>(), odd.any<std::int32_t>());
  field.set(odd_cell(odd));
  field.clear(odd_cell(odd));
  (void)field.test(odd_cell(odd));
  switch (odd.bits() % 5) {
    case 0:
      field.set(box);
      CHECK(field.count(box) <= field.count());
      break;
    case 1:
      field.clear(box);
      CHECK(field.count(box) == 0);
      CHECK(!field.any(box));
      break;
    case 2:
      CHECK(field.any(box) == (field.count(box) != 0));
      break;
    default:
      // Only the squares of discs that meet the field take time; a disc of 16,384 rows beside it takes them
      // all.
      if (disc.diameter <= 64 || odd.one_in(50)) {
        field.set(disc, corner);
        field.clear(disc, corner);
        CHECK(!field.any(disc, corner));
      }
  }
  const DiscStamp small = disc_stamp(odd.between_32(1, kMaxSmallDisc));
  const Vec2i inside{odd.between_32(0, 150), odd.between_32(0, 150)};
  if (field.holds(small, inside)) {
    std::uint32_t rows[kMaxSmallDisc];
    field.set_inside(small, inside);
    CHECK(field.any_inside(small, inside));
    (void)field.any_besides_inside(small, inside, odd_cell(odd));
    (void)field.overlap_inside(small, inside, odd.one_in(2) ? BitField::kNowhere : inside, rows);
    field.clear_inside(small, inside);
  }
}

void use(OddValues& odd, ParticleWorld& world) {
  const auto number = [&](std::int32_t most) { return odd.any_or(3, -most, most); };
  const std::uint32_t id =
      odd.one_in(3) ? odd.any<std::uint32_t>() : static_cast<std::uint32_t>(odd.bits() % 12);
  const std::int32_t thick = odd.any_or(20, 0, 20);
  switch (odd.bits() % 14) {
    case 0:
      (void)world.spawn(number(120 << 16), number(120 << 16), number(1 << 16), number(1 << 16), number(20),
                        nullptr);
      break;
    case 1:
      (void)world.spawn_random(number(1 << 16));
      break;
    case 2:
      (void)world.remove(id);
      break;
    case 3: {
      Particle particle;
      if (world.particle(id, &particle)) {
        CHECK(particle.id == id);
      }
      (void)world.ball_at(odd_cell(odd));
      break;
    }
    case 4:
      (void)world.set_velocity(id, number(1 << 16), number(1 << 16));
      break;
    case 5:
      world.draw_box({odd_cell(odd), odd_cell(odd)});
      break;
    case 6:
      world.erase_box({odd_cell(odd), odd_cell(odd)});
      break;
    case 7: {
      // A line as long as it may be takes a disc for each of 65,536 cells.
      const Vec2i from = odd_cell(odd);
      const bool far = odd.one_in(40);
      world.draw_wall(from, far ? odd_cell(odd) : Vec2i{from.x / 2, from.y / 2}, thick % 64);
      break;
    }
    case 8:
      world.erase_wall({odd.between_32(-5, 120), odd.between_32(-5, 120)}, odd_cell(odd), thick % 64);
      break;
    case 9:
      (void)world.set_gravity({number(1 << 16), number(1 << 16)});
      break;
    case 10:
      (void)world.set_restitution(odd.any<std::uint32_t>());
      (void)world.set_diameters(number(16), number(16));
      break;
    case 11:
      world.set_pointer(static_cast<PointerMode>(odd.bits() % 7), odd_cell(odd), number(64), number(1 << 17));
      break;
    case 12:
      world.wake_all();
      break;
    default:
      for (int i = 0; i < 8; ++i) {
        world.step();
      }
  }
  if (id < world.id_limit()) {
    Particle particle;
    if (world.particle(id, &particle)) {
      (void)world.is_held(id);
    }
  }
}

}  // namespace

TEST_CASE("misuse: bit fields of any size -> refused or done, inside their bytes") {
  misuse(40, 1200, [](OddValues& odd) {
    const std::int32_t width = odd.any_or(4, 0, 130);
    const std::int32_t height = odd.any_or(4, 0, 130);
    HeapBytes bytes(odd_size(odd, bitfield_bytes(width, height)));
    BitField field;
    const Status status = BitField::make(width, height, bytes.span(), &field);
    CHECK((status == Status::kOutOfRange) ==
          (width < 0 || height < 0 || width > kMaxFieldSide || height > kMaxFieldSide));
    for (int i = 0; i < 20; ++i) {
      use(odd, field);
    }
  });
}

TEST_CASE("misuse: particle worlds of any numbers -> refused or done, inside their bytes") {
  misuse(41, 900, [](OddValues& odd) {
    const bool sane = !odd.one_in(4);
    const auto number = [&](std::int32_t low, std::int32_t high) {
      return sane || odd.one_in(2) ? odd.between_32(low, high) : odd.any<std::int32_t>();
    };
    const ParticleConfig config = particles_of(odd, number);
    HeapBytes bytes(odd_size(odd, particles_bytes(config)));
    ParticleWorld world;
    const Status status = ParticleWorld::make(config, bytes.span(), &world);
    if (status != Status::kOk) {
      CHECK(world.id_limit() == 0);
    }
    for (int i = 0; i < 60; ++i) {
      use(odd, world);
      REQUIRE(world.count() <= config.capacity);
    }
    (void)world.energy();
    (void)world.momentum();
    (void)world.state_crc32();
  });
}
