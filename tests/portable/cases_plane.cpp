// The particle world and its field: balls that fall, meet, sleep and are drawn along; boxes and discs of bits.
#include "portable/groups.h"
#include "portable/scene.h"
#include "thimble/plane/particles.h"

namespace thimble::portable {
namespace {

constexpr int32_t kWidth = 75;
constexpr int32_t kHeight = 41;
constexpr uint32_t kFieldBytes = (static_cast<uint32_t>(bitfield_bytes(kWidth, kHeight)) + 7) & ~7U;

bool make_field(Check& check, BitField* field) {
  return check.equal(BitField::make(kWidth, kHeight, check.arena, field), Status::kOk, THIMBLE_WHAT("make"));
}
void note_field(Check& check, const BitField& field) {
  for (int32_t column = 0; column < field.columns(); ++column) {
    for (int32_t y = 0; y < field.height(); ++y) {
      check.note(field.cells_32(column, y));
    }
  }
}
CellBox random_box(Random* random) {
  const int32_t x0 = random->below(90) - 8;
  const int32_t y0 = random->below(55) - 8;
  const int32_t x1 = x0 + random->below(50) - 3;
  const int32_t y1 = y0 + random->below(30) - 3;
  return {{x0, y0}, {x1, y1}};
}

// Boxes, each asked about cell by cell.
void boxes(Check& check, int /*index*/) {
  BitField field;
  THIMBLE_REQUIRE(make_field(check, &field));
  Random random;
  for (int i = 0; i < 40; ++i) {
    const CellBox box = random_box(&random);
    if (i % 3 == 2) {
      field.clear(box);
    } else if (i % 3 == 1) {
      field.set(box);
    } else {
      field.set(Vec2i{box.low.x, box.low.y});
      field.clear(Vec2i{box.high.x, box.high.y});
    }
    const CellBox asked = random_box(&random);
    uint32_t count = 0;
    for (int32_t y = asked.low.y; y < asked.high.y; ++y) {
      for (int32_t x = asked.low.x; x < asked.high.x; ++x) {
        count += field.test({x, y}) ? 1U : 0U;
      }
    }
    THIMBLE_EQUAL(field.count(asked), count);
    THIMBLE_EQUAL(field.any(asked), count != 0);
    check.note(field.window(asked.low.x, asked.low.y));
  }
  note_field(check, field);
  field.clear_all();
  THIMBLE_EQUAL(field.count(), 0U);
}

// The cells of a circle, those of them that lie in the field, and those that are set.
struct Circle {
  uint32_t cells = 0;
  uint32_t inside = 0;
  uint32_t set = 0;

  Circle(const BitField& field, int32_t diameter, const Vec2i& corner) {
    for (int32_t y = 0; y < diameter; ++y) {
      for (int32_t x = 0; x < diameter; ++x) {
        const int32_t u = 2 * x + 1 - diameter;
        const int32_t v = 2 * y + 1 - diameter;
        const Vec2i cell{corner.x + x, corner.y + y};
        if (u * u + v * v < diameter * diameter) {
          ++cells;
          inside += field.contains(cell) ? 1U : 0U;
          set += field.test(cell) ? 1U : 0U;
        }
      }
    }
  }
};

// Discs of every size, clipped and not.
void discs(Check& check, int /*index*/) {
  BitField field;
  THIMBLE_REQUIRE(make_field(check, &field));
  Random random;
  for (int32_t diameter = -1; diameter <= 36; ++diameter) {
    const DiscStamp disc = disc_stamp(diameter);
    const Vec2i corner{random.below(90) - 20, random.below(60) - 20};
    field.clear_all();
    field.set(disc, corner);
    const Circle circle(field, diameter, corner);
    check.note(circle.inside);
    THIMBLE_EQUAL(circle.set, circle.inside);
    THIMBLE_EQUAL(field.count(), circle.inside);
    THIMBLE_EQUAL(field.any(disc, corner), circle.inside != 0);
    field.set(field.bounds());
    field.clear(disc, corner);
    THIMBLE_EQUAL(field.count(), static_cast<uint32_t>(kWidth * kHeight) - circle.inside);
  }
  // Those that lie inside, the fast way.
  for (int32_t diameter = 1; diameter <= kMaxSmallDisc; ++diameter) {
    const DiscStamp disc = disc_stamp(diameter);
    const Vec2i corner{random.below(kWidth - diameter), random.below(kHeight - diameter)};
    const Vec2i own{random.below(kWidth - diameter), random.below(kHeight - diameter)};
    field.clear_all();
    field.set_inside(disc, corner);
    THIMBLE_EQUAL(field.count(), Circle(field, diameter, corner).cells);
    THIMBLE_CHECK(field.holds(disc, corner) && field.any_inside(disc, corner));
    THIMBLE_CHECK(!field.any_besides_inside(disc, corner, corner));
    field.set(Vec2i{own.x + diameter / 2, own.y + diameter / 2});
    uint32_t rows[kMaxSmallDisc] = {};
    const bool meets = field.overlap_inside(disc, own, corner, rows);
    THIMBLE_EQUAL(field.any_besides_inside(disc, own, corner), meets);
    for (int32_t row = 0; row < diameter; ++row) {
      check.note(meets ? rows[row] : 0);
    }
    field.clear_inside(disc, corner);
    check.note(field.count());
  }
}

// --- Balls

struct Play {
  int32_t most_diameter;
  uint32_t restitution_q16;
  Vec2i gravity_q16;
  int32_t substeps_log2;
  int32_t subpixel_bits;
  int32_t speed_q16;
  PointerMode pointer;
};
constexpr Play kPlays[] = {
    {8, 52429, {0, 6554}, 0, 15, 60000, PointerMode::kNone},
    {8, 65536, {0, 0}, 0, 15, 400000, PointerMode::kNone},
    {5, 0, {3000, 0}, 1, 8, 100000, PointerMode::kDrag},
    {8, 40000, {0, 20000}, 2, 12, 900000, PointerMode::kAttract},
    {8, 30000, {-2000, 3000}, 0, 4, 3000000, PointerMode::kRepel},
    {4, 52429, {0, 6554}, 0, 15, 60000, PointerMode::kSpawn},
    {8, 52429, {0, 6554}, 4, 15, 60000, PointerMode::kErase},
    {8, 52429, {0, 6554}, 0, 15, 200000, PointerMode::kDraw},
    {1, 60000, {0, 6554}, 0, 15, 60000, PointerMode::kNone},
};
constexpr int kPlayCount = sizeof kPlays / sizeof kPlays[0];
constexpr uint32_t kBalls = 40;
constexpr uint32_t kWorldBytes = (particles_bytes(kWidth, kHeight, kBalls, 1) + 7) & ~7U;
constexpr uint32_t kPlayBytes = kWorldBytes + sizeof(ParticleWorld) + 64;
static_assert(kPlayBytes <= kCommonArenaBytes);

// Balls and what is drawn are all that the field holds, and no two of them share a cell.
bool field_is_union(Check& check, const ParticleWorld& world, uint32_t walls) {
  uint32_t cells = walls;
  Particle ball;
  for (uint32_t id = 0; id < world.id_limit(); ++id) {
    if (world.particle(id, &ball)) {
      const Circle circle(world.field(), ball.diameter, ball.corner);
      cells += circle.cells;
      if (circle.set != circle.cells) {
        return check.that(false, THIMBLE_WHAT("a ball whose cells are not set"));
      }
    }
  }
  return check.equal(world.field().count(), cells, THIMBLE_WHAT("cells of balls and walls"));
}

void play(Check& check, int index) {
  const Play& how = kPlays[index];
  const Span<ParticleWorld> place = check.take<ParticleWorld>(1);
  THIMBLE_REQUIRE(place.size == 1);
  ParticleWorld& world = place[0];
  world = ParticleWorld();
  ParticleConfig config;
  config.width = kWidth;
  config.height = kHeight;
  config.capacity = kBalls;
  config.least_diameter = 1;
  config.most_diameter = how.most_diameter;
  config.restitution_q16 = how.restitution_q16;
  config.gravity_q16 = how.gravity_q16;
  config.seed = static_cast<uint32_t>(7 + index);
  config.substeps_log2 = how.substeps_log2;
  config.subpixel_bits = how.subpixel_bits;
  THIMBLE_REQUIRE_OK(ParticleWorld::make(config, check.arena, &world));
  world.draw_wall({10, 30}, {30, 36}, 3);
  world.draw_box({{50, 20}, {60, 22}});
  uint32_t walls = world.field().count();
  for (uint32_t i = 0; i < kBalls - 4; ++i) {
    check.note(static_cast<int64_t>(world.spawn_random(how.speed_q16)));
  }
  uint32_t id = kNoBall;
  check.note(static_cast<int64_t>(world.spawn(40 << 16, 5 << 16, how.speed_q16, -how.speed_q16, 1, &id)));
  check.note(id);
  THIMBLE_REQUIRE(field_is_union(check, world, walls));
  const bool changes_walls = how.pointer == PointerMode::kErase || how.pointer == PointerMode::kDraw;
  for (int32_t step = 0; step < 90; ++step) {
    if (how.pointer != PointerMode::kNone && step >= 10 && step < 60) {
      world.set_pointer(how.pointer, {5 + step, 8 + step / 2}, how.pointer == PointerMode::kDraw ? 1 : 9,
                        40000);
    } else if (step == 60) {
      world.set_pointer(PointerMode::kNone, {0, 0});
    }
    if (step == 30) {
      check.note(world.ball_at({40, 20}));
      check.note(world.dragged());
      check.note(static_cast<int64_t>(world.remove(3)));
      check.note(static_cast<int64_t>(world.set_velocity(5, -how.speed_q16, how.speed_q16)));
    }
    world.step();
    const StepCounters& counters = world.counters();
    check.note(counters.moves);
    check.note(counters.mask_tests);
    check.note(counters.ball_hits);
    check.note(counters.wall_hits);
    check.note(counters.woken);
    if (step % 10 == 0) {
      check.note(world.state_crc32());
      check.note(world.asleep());
    }
  }
  THIMBLE_REQUIRE(changes_walls || field_is_union(check, world, walls));
  world.erase_wall({10, 30}, {30, 36}, 3);
  world.erase_box({{48, 18}, {75, 24}});
  THIMBLE_EQUAL(world.set_gravity({-30000, -30000}), Status::kOk);
  THIMBLE_EQUAL(world.set_restitution(65536), Status::kOk);
  check.note(static_cast<int64_t>(world.set_diameters(1, how.most_diameter)));
  world.wake_all();
  for (int step = 0; step < 30; ++step) {
    world.step();
  }
  const UInt128 energy = world.energy();
  check.note(static_cast<int64_t>(energy.low));
  check.note(world.momentum().x);
  check.note(world.momentum().y);
  check.note(world.state_crc32());
  note_field(check, world.field());
}

constexpr const char* kPlayNames[] = {
    "balls fall, meet and come to rest -> the same state everywhere",
    "without gravity and loss -> the same state everywhere",
    "without bounce, drawn along by the pointer -> the same state everywhere",
    "drawn to the pointer, in four parts a step -> the same state everywhere",
    "fast balls, driven away, on a coarse grid -> the same state everywhere",
    "balls come at the pointer -> the same state everywhere",
    "balls and walls go at the pointer -> the same state everywhere",
    "a wall is drawn among balls -> the same state everywhere",
    "balls of a cell each -> the same state everywhere",
};
static_assert(sizeof kPlayNames / sizeof kPlayNames[0] == kPlayCount);

// More diameter takes fewer lists and as much else, so that the bytes for 1 do for all.
constexpr Case kCases[] = {
    {"boxes of bits, set, cleared, counted, looked through -> as cell by cell", kFieldBytes, boxes},
    {"discs of bits, clipped and inside -> the cells of the circle", kFieldBytes, discs},
    {kPlayNames[0], kPlayBytes, play, 0},
    {kPlayNames[1], kPlayBytes, play, 1},
    {kPlayNames[2], kPlayBytes, play, 2},
    {kPlayNames[3], kPlayBytes, play, 3},
    {kPlayNames[4], kPlayBytes, play, 4},
    {kPlayNames[5], kPlayBytes, play, 5},
    {kPlayNames[6], kPlayBytes, play, 6},
    {kPlayNames[7], kPlayBytes, play, 7},
    {kPlayNames[8], kPlayBytes, play, 8},
};

}  // namespace

const Group kPlaneGroup = group_of<kCases>("plane", "cases_plane.cpp");

}  // namespace thimble::portable
