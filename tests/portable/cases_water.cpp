// Moving water and rays that meet it.
#include "portable/groups.h"
#include "thimble/light/water.h"

namespace thimble::portable {
namespace {

constexpr int32_t kWidth = 16;
constexpr int32_t kDepth = 12;
constexpr uint32_t kBytes = water_bytes(kWidth, kDepth) + 7;

// A basin with an island of 2 x 2 columns, touched beside it.
bool fill(Check& check, Water* water) {
  uint8_t mask[kWidth * kDepth / 8] = {};
  mask[2 * 5] = 0x18;
  mask[2 * 6] = 0x18;
  WaterConfig config;
  config.width = kWidth;
  config.depth = kDepth;
  config.rest_q8 = 3 * 256;
  config.greatest_q8 = 6 * 256;
  config.blocked = mask;
  return check.equal(Water::make(config, check.arena.take(water_bytes(kWidth, kDepth)), water), Status::kOk,
                     THIMBLE_WHAT("init")) &&
         check.equal(water->touch(2400, 1300, 700, 200), Status::kOk, THIMBLE_WHAT("touch"));
}

Ray ray_at(const Vec3i& origin_q8, const Vec3i& direction) {
  return {{Q8::from_raw(origin_q8.x), Q8::from_raw(origin_q8.y), Q8::from_raw(origin_q8.z)}, direction};
}
void note_hit(Check& check, bool met, const WaterHit& hit) {
  check.note(met ? 1 : 0);
  if (met) {
    check.note(hit.column_x);
    check.note(hit.column_y);
    check.note(hit.axis);
    check.note(hit.side);
    check.note(hit.t_numerator);
    check.note(hit.t_denominator);
  }
}

constexpr Case kCases[] = {
    {"touched, then hit by a falling thing -> the same state everywhere, and the volume of before", kBytes,
     [](Check& check, int) {
       Water water;
       THIMBLE_REQUIRE(fill(check, &water));
       for (int step = 0; step < 60; ++step) {
         if (step == 20) {
           THIMBLE_REQUIRE_OK(water.drop(1000, 2000, 500, 600, 300));
         }
         water.step();
         check.note(water.height_q16(9, 4));
       }
       THIMBLE_EQUAL(water.steps_done(), 60U);
       THIMBLE_EQUAL(water.height_q8(3, 5), 0);
       THIMBLE_EQUAL(water.volume_q16(), uint64_t{188} * 3 * 65536);
       check.note(static_cast<int64_t>(water.columns_updated()));
       check.note(water.state_crc32());
     }},
    {"left alone -> exactly flat in the end, and nothing is stepped from then on", kBytes,
     [](Check& check, int) {
       Water water;
       THIMBLE_REQUIRE(fill(check, &water));
       for (int step = 0; step < 2000; ++step) {
         water.step();
       }
       THIMBLE_CHECK(water.is_still());
       THIMBLE_CHECK(water.steps_done() < 1500);
       check.note(water.steps_done());
       for (int32_t y = 0; y < kDepth; ++y) {
         for (int32_t x = 0; x < kWidth; ++x) {
           THIMBLE_EQUAL(water.height_q16(x, y), water.is_blocked(x, y) ? -1 : 3 * 65536);
         }
       }
     }},
    {"waves faster than the stability limit -> refused", kBytes,
     [](Check& check, int) {
       Water water;
       WaterConfig config;
       config.width = kWidth;
       config.depth = kDepth;
       const Bytes bytes = check.arena.take(water_bytes(kWidth, kDepth));
       config.wave_speed_q6 = kMaxWaveSpeedQ6 + 1;
       THIMBLE_EQUAL(Water::make(config, bytes, &water), Status::kOutOfRange);
       config.wave_speed_q6 = kMaxWaveSpeedQ6;
       THIMBLE_EQUAL(Water::make(config, bytes.subspan(1), &water), Status::kOutOfMemory);
       THIMBLE_EQUAL(Water::make(config, bytes, &water), Status::kOk);
     }},
    {"rays among waves -> the same columns, faces and t everywhere", kBytes,
     [](Check& check, int) {
       Water water;
       THIMBLE_REQUIRE(fill(check, &water));
       for (int step = 0; step < 25; ++step) {
         water.step();
       }
       const WaterSurface surface = water.surface({4, 5, 2});
       Random random;
       for (int i = 0; i < 200; ++i) {
         const Vec3i at = random.vector(24 * 256);
         const Vec3i spread = random.vector(2000);
         Ray ray = ray_at(at, {spread.x - 1000, spread.y - 1000, spread.z - 1000});
         if ((i & 3) == 0) {
           ray.direction[i % 3] = 0;
         }
         if (ray.direction == Vec3i{}) {
           continue;
         }
         WaterHit hit;
         bool met = water_enter(surface, ray, &hit);
         note_hit(check, met, hit);
         THIMBLE_EQUAL(water_holds(surface, ray.origin, ray.direction), met && hit.axis < 0);
         met = water_leave(surface, ray, &hit);
         note_hit(check, met, hit);
         const Vec3i normal = water_normal(surface, ray.origin.x, ray.origin.y);
         check.note(normal.x);
         check.note(normal.y);
       }
     }},
    {"a level no array holds: a ray down, one along the surface, one from below", 0,
     [](Check& check, int) {
       const WaterSurface pond = still_water({2, 2, 1}, 4, 3, 300);
       WaterHit hit;
       THIMBLE_CHECK(water_enter(pond, ray_at({1000, 700, 2000}, {0, 0, -7}), &hit));
       THIMBLE_EQUAL(hit.axis, 2);
       THIMBLE_EQUAL(hit.side, 1);
       THIMBLE_EQUAL(hit.column_x, 1);
       THIMBLE_EQUAL(hit.t_numerator, 2000 - 556);
       THIMBLE_EQUAL(hit.t_denominator, 7 * 256);
       THIMBLE_CHECK(!water_enter(pond, ray_at({0, 700, 556}, {5, 0, 0}), &hit));
       THIMBLE_CHECK(water_leave(pond, ray_at({1000, 700, 300}, {0, 0, 1}), &hit));
       THIMBLE_EQUAL(hit.t_numerator, 256);
       THIMBLE_EQUAL(hit.t_denominator, 256);
     }},
};

}  // namespace

const Group kWaterGroup = group_of<kCases>("water", "cases_water.cpp");

}  // namespace thimble::portable
