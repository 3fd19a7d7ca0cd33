// Light at the ends of its numbers: what is computed at a table's steps, in the middle between columns of water, at lamps
// whose reach is nothing.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "support/lit_world.h"
#include "support/map_cells.h"
#include "support/scene_under_test.h"
#include "thimble/light/host/optics.h"
#include "thimble/light/map_render.h"
#include "thimble/light/scene.h"
#include "thimble/light/water.h"
#include "thimble/tree/octree.h"

namespace thimble::tests {
namespace {

TEST_CASE(
    "light limits: what every length of a clear solid leaves -> nearest of the table's straight pieces") {
  // 64 pieces for each halving, their ends rounded to 2^-16; each value within a half of the piece.
  std::vector<std::int64_t> ends;
  for (int i = 0; i <= 64; ++i) {
    ends.push_back(std::llround(65536 * (1 - std::exp2(-i / 64.0))));
  }
  std::int64_t wrong = 0;
  for (std::uint32_t halvings = 0; halvings < 18U << 16; ++halvings) {
    const std::uint32_t whole = halvings >> 16;
    const auto place = static_cast<std::size_t>(halvings >> 10 & 63U);
    const std::int64_t between = halvings & 1023U;
    const std::int64_t left = 65536 - ends[place] - ((ends[place + 1] - ends[place]) * between + 512) / 1024;
    const std::int64_t wanted =
        whole > 16 ? 0 : (left + (whole == 0 ? 0 : std::int64_t{1} << (whole - 1))) >> whole;
    wrong += transmittance_q16(halvings) == static_cast<std::uint32_t>(wanted) ? 0 : 1;
  }
  CHECK(wrong == 0);
}

// A surface of heights, and the same with its axes exchanged, or one of them turned round.
struct Columns {
  Columns(std::int32_t across, std::int32_t down, std::mt19937_64& random, unsigned dry)
      : width(across), depth(down) {
    for (std::int32_t i = 0; i < width * depth; ++i) {
      heights.push_back(random() % 5 < dry ? -1 : static_cast<std::int32_t>(random() % 200000));
    }
  }
  WaterSurface surface() const {
    WaterSurface made;
    made.heights_q16 = heights.data();
    made.width = width;
    made.depth = depth;
    made.highest_q8 = 800;
    return made;
  }
  std::int32_t width;
  std::int32_t depth;
  std::vector<std::int32_t> heights;
};

TEST_CASE(
    "light limits: a water's normal at every 1/256 of a voxel -> the exchanged water has the exchanged one") {
  std::mt19937_64 random(20260841);
  for (unsigned number = 0; number < 20; ++number) {
    const auto width = static_cast<std::int32_t>(1 + random() % 5);
    const auto depth = static_cast<std::int32_t>(1 + random() % 5);
    const Columns columns(width, depth, random, number % 2);
    Columns exchanged(depth, width, random, 0);
    for (std::int32_t y = 0; y < depth; ++y) {
      for (std::int32_t x = 0; x < width; ++x) {
        exchanged.heights[static_cast<std::size_t>(x * depth + y)] =
            columns.heights[static_cast<std::size_t>(y * width + x)];
      }
    }
    for (std::int32_t x = -300; x < width * 256 + 300; x += 3) {
      const auto y = static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(depth * 256));
      const Vec3i one = water_normal(columns.surface(), Q8::from_raw(x), Q8::from_raw(y));
      const Vec3i other = water_normal(exchanged.surface(), Q8::from_raw(y), Q8::from_raw(x));
      REQUIRE(one == Vec3i{other.y, other.x, other.z});
    }
    // Between two columns' centres the slope changes evenly: no jump from a place to the next.
    for (std::int32_t y = 128; number % 2 == 0 && y + 1 < depth * 256 - 128; ++y) {
      const Vec3i one = water_normal(columns.surface(), Q8::from_raw(128), Q8::from_raw(y));
      const Vec3i next = water_normal(columns.surface(), Q8::from_raw(128), Q8::from_raw(y + 1));
      REQUIRE(std::abs(one.x - next.x) <= 65536 / 256 + 8);
      REQUIRE(std::abs(one.y - next.y) <= 65536 / 256 + 8);
    }
  }
}

// A light shines where any channel of any light does.
TEST_CASE("light limits: lights of any channels -> direct light and shadows where one of them shines") {
  for (int bits = 0; bits < 64; ++bits) {
    Light lights[2];
    for (int i = 0; i < 3; ++i) {
      lights[0].color_q8[i] = static_cast<std::uint16_t>(bits >> i & 1);
      lights[1].color_q8[i] = static_cast<std::uint16_t>(bits >> (3 + i) & 1);
    }
    LitScene scene;
    scene.lights = Span<const Light>(lights);
    for (const bool shadows : {false, true}) {
      scene.has_shadows = shadows;
      const EffectSet effects = effects_of(scene);
      CHECK(((effects & Effect::kDirectLight) != 0) == (bits != 0));
      CHECK(((effects & Effect::kShadows) != 0) == (bits != 0 && shadows));
    }
  }
}

// Bricks here and there, in a box that need not be a cube.
struct SunWorld {
  SunWorld(std::mt19937_64& random, unsigned share) {
    OwnedPool octree_pool(5, 60000);
    Octree& octree = octree_pool.octree;
    REQUIRE(octree.insert({static_cast<std::int32_t>(random() % 16), 0, 0}, 1) == Status::kOk);
    for (std::int32_t i = 0; i < 512; ++i) {
      if (random() % share == 0) {
        const Vec3i corner{i % 8 * 4, i / 8 % 8 * 4, i / 64 * 4};
        if (corner.y < 20) {
          REQUIRE(octree.insert({corner.x + 1, corner.y + 2, corner.z + 3}, 2) == Status::kOk);
        }
      }
    }
    bytes = map_of(open_or_throw(compact_of(octree)));
    REQUIRE(BrickMap::open(bytes.view(), &map) == Status::kOk);
    for (int axis = 0; axis < 3; ++axis) {
      side[axis] = map.box().high[axis] - map.box().low[axis];
    }
  }
  bool has(const Vec3i& at) const { return brick_at(map, at) != 0; }
  HeapBytes bytes;
  BrickMap map;
  Vec3i side;
};

// sun_bricks.cpp: k layers on along the sun's largest axis, a ray from a brick has moved by more than k - 1 and less than
// k + 1 layers' share of the others.
TEST_CASE(
    "light limits: bricks that the sun reaches freely -> those that their definition says, in whole bytes") {
  std::mt19937_64 random(20260843);
  int is_free = 0;
  int is_not = 0;
  for (int number = 0; number < 60; ++number) {
    const SunWorld world(random, number % 2 == 0 ? 40 : 9);
    Vec3i towards;
    for (int axis = 0; axis < 3; ++axis) {
      // Short, so that nothing of it is cut off.
      towards[axis] =
          number % 5 == 4 && axis != number % 3 ? 0 : static_cast<std::int32_t>(random() % 2001) - 1000;
    }
    towards.z += towards == Vec3i{} ? 9 : 0;
    const Vec3i side = world.side;
    const auto cells = static_cast<std::size_t>(side.x * side.y * side.z);
    REQUIRE(SunBricks::bytes(world.map) == (cells + 7) / 8);
    std::vector<std::uint8_t> room(SunBricks::bytes(world.map));
    SunBricks sun;
    REQUIRE(SunBricks::make(world.map, towards, {room.data(), room.size()}, &sun) == Status::kOk);
    CHECK_FALSE(sun.prove());
    REQUIRE(SunBricks::make(world.map, towards, {room.data(), room.size() - 1}, &sun) ==
            Status::kOutOfMemory);
    int c = 0;
    for (int axis = 1; axis < 3; ++axis) {
      c = std::abs(towards[axis]) > std::abs(towards[c]) ? axis : c;
    }
    CAPTURE(number);
    for (std::size_t cell = 0; cell < cells; ++cell) {
      const auto index = static_cast<std::int32_t>(cell);
      const Vec3i at{index % side.x, index / side.x % side.y, index / side.x / side.y};
      bool wanted = true;
      for (std::int32_t i = 0; i < static_cast<std::int32_t>(cells) && wanted; ++i) {
        const Vec3i other{i % side.x, i / side.x % side.y, i / side.x / side.y};
        if (other == at || !world.has(other)) {
          continue;
        }
        const std::int32_t layers = (other[c] - at[c]) * (towards[c] < 0 ? -1 : 1);
        bool in_way = layers >= 0;
        for (int axis = 0; axis < 3 && in_way; ++axis) {
          const std::int32_t moved = (other[axis] - at[axis]) * (towards[axis] < 0 ? -1 : 1);
          const double share = std::fabs(double{1} * towards[axis] / towards[c]);
          in_way = axis == c || (moved >= std::floor(std::fmax(layers - 1, 0) * share + 1e-9) &&
                                 moved <= std::ceil((layers + 1) * share - 1e-9));
        }
        wanted = !in_way;
      }
      is_free += wanted ? 1 : 0;
      is_not += wanted ? 0 : 1;
      REQUIRE(((room[cell / 8] >> (cell % 8) & 1) != 0) == wanted);
    }
  }
  CHECK(is_free > 500);
  CHECK(is_not > 500);
}

}  // namespace
}  // namespace thimble::tests

// Parts of a pixel, called one by one with what pictures seldom have: rays that begin 1/256 voxel before a solid, water
// with an empty column, colors brighter than any surface.
namespace thimble::testing::light_parts {
namespace {

constexpr int kWaterRay = static_cast<int>(LitRayKind::kWaterRay);

// A small world, and its frame.
struct Parts : LitWorld {
  Parts() {
    box({0, 0, 0}, {32, 32, 1}, 1);
    finish();
    look({16 * 256, 0, 16 * 256}, {16 * 256, 16 * 256, 8 * 256}, 60, 1, 1);
    scene.bounces = 4;
  }
  lit::Frame frame(EffectSet effects) const { return {tree, camera, shading, scene, options, effects}; }

  LitOptions options;
};

lit::PendingRay ray_from(const Vec3i& at, const Vec3i& direction) {
  lit::PendingRay ray;
  ray.ray = {LitWorld::point(at), direction};
  return ray;
}

TEST_CASE("light parts: a solid entered at t = 1/256 -> absorbs what it does for t = 2/512") {
  Parts parts;
  parts.surfaces[2] = surface(SurfaceKind::kGlass, {10, 100, 200});
  parts.surfaces[2].density_q8 = 256;
  const lit::PendingRay now = ray_from({255, 0, 512}, {1, 300, 0});
  lit::Meeting meeting;
  meeting.found = true;
  meeting.hit.t_numerator = 600;
  meeting.hit.t_denominator = 300 * 256;
  lit::Weight weights[2];
  for (int i = 0; i < 2; ++i) {
    weights[i] = now.weight;
    absorb(parts.frame(Effect::kGlass), now, {{lit::Medium::kSolid, 2}, {1 + i, 256 * (1 + i)}}, meeting,
           &weights[i]);
  }
  for (int i = 0; i < 3; ++i) {
    CHECK(weights[0].c[i] == weights[1].c[i]);
    CHECK(weights[0].c[i] > 0);
    CHECK(weights[0].c[i] < lit::kFullWeight);
  }
}

TEST_CASE("light parts: what glows -> its three channels, nothing behind them") {
  struct {
    lit::Color color;
    std::uint32_t behind = 77;
  } lit;
  lit::Spot spot;
  spot.surface = surface(SurfaceKind::kEmit, {10, 20, 30});
  spot.surface.emission_q8 = 256;
  add_emission(spot, &lit.color);
  for (int i = 0; i < 3; ++i) {
    CHECK(lit.color.c[i] == 10U * static_cast<std::uint32_t>(i + 1) * lit::kLevel);
  }
  CHECK(lit.behind == 77);
}

TEST_CASE("light parts: a color brighter than four times white, as of a sun in water -> as that is stored") {
  const Parts parts;
  const lit::Frame frame = parts.frame(Effect::kNone);
  std::uint8_t stored[2][3];
  for (int i = 0; i < 2; ++i) {
    const Band band{{stored[i], 3}, PixelFormat::kRgb888, 0, 0, 1};
    const std::uint32_t most = lit::kMaxChannel;
    store(frame, band, stored[i], 0, 0, {{i == 0 ? most : 3 * most, most / 2, lit::kWhite / 2}});
    CHECK(stored[i][0] == 255);
  }
  CHECK(stored[0][1] == stored[1][1]);
  CHECK(stored[0][2] == stored[1][2]);
}

// Two rows of two columns, one of them of another height; a ray that comes to the surface on the edge of a column.
struct Basin : Parts {
  Basin(const std::vector<std::int32_t>& columns, const Vec3i& at) : heights(columns) {
    scene.has_water = true;
    scene.water = still_water({4, 4, 4}, 2, 2, 512);
    scene.water.heights_q16 = heights.data();
    scene.water.lowest_q8 = 0;
    scene.water_material = surface(SurfaceKind::kGlass, {255, 255, 255});
    scene.water_material.index_q12 = 5460;
    meeting.found = true;
    meeting.at_water = true;
    meeting.at_surface = true;
    meeting.beyond = {lit::Medium::kWaterBody, 0};
    meeting.hit.axis = 2;
    meeting.at = point(at);
  }

  std::vector<std::int32_t> heights;
  lit::Meeting meeting;
};

TEST_CASE("light parts: a ray refracted into a column without water -> begins on the ground there") {
  constexpr std::int32_t kTwo = 2 << 16;
  const Vec3i at{5 * 256, 4 * 256 + 128, 6 * 256};
  for (const std::int32_t beside : {0, 256, -1}) {
    const Basin basin({kTwo, beside, kTwo, kTwo}, at);
    lit::Frame frame = basin.frame(Effect::kWater);
    lit::PendingRay now = ray_from({at.x - 800, at.y, at.z + 100}, {8, 0, -1});
    lit::Leg leg;
    lit::PendingRay pending[lit::pending_rays(Effect::kWater)];
    std::size_t count = 0;
    REQUIRE_FALSE(cross(frame, &now, &leg, basin.meeting, pending, &count));
    REQUIRE(count == 2);
    const lit::PendingRay& refracted = pending[1];
    REQUIRE(refracted.ray.direction.x > 0);
    REQUIRE(refracted.ray.direction.z < 0);
    // A column that holds rock moves nothing.
    CHECK(refracted.ray.origin.z.raw == (beside < 0 ? at.z : 4 * 256 + beside / 256));
  }
}

TEST_CASE("light parts: ripples send a ray out of the side of the water -> it begins where it was met") {
  constexpr std::int32_t kTwo = 2 << 16;
  const Vec3i at{4 * 256, 5 * 256 + 128, 6 * 256};
  const Basin basin({kTwo, 1 << 16, kTwo, kTwo}, at);
  lit::Frame frame = basin.frame(Effect::kWater | Effect::kRipples);
  lit::PendingRay now = ray_from({at.x + 800, at.y, at.z + 400}, {-8, 0, -4});
  lit::Leg leg;
  lit::PendingRay pending[lit::pending_rays(Effect::kWater)];
  std::size_t count = 0;
  REQUIRE_FALSE(cross_ripples(frame, &now, &leg, basin.meeting, pending, &count));
  REQUIRE(count == 2);
  for (const lit::PendingRay& sent : {pending[0], pending[1]}) {
    CHECK(sent.ray.origin == LitWorld::point(at));
    CHECK(sent.ray.direction.x < 0);
    CHECK(sent.axis == 2);
  }
}

TEST_CASE("light parts: a ray that comes to no end of a clear solid in the water -> no column is looked at") {
  const Basin basin({2 << 16, 2 << 16, 2 << 16, 2 << 16}, {});
  lit::Frame frame = basin.frame(Effect::kWater | Effect::kGlass);
  const lit::Leg leg{{lit::Medium::kSolid, 2}, {}};
  const lit::PendingRay now = ray_from({5 * 256, 5 * 256, 5 * 256}, {1, 2, 3});
  lit::Meeting meeting;
  meet_water(frame, now, leg, &meeting);
  CHECK(frame.counts.node_visits[kWaterRay] == 0);
  meeting.found = true;  // in the water, where the solid ends
  meeting.hit.axis = -1;
  meet_water(frame, now, leg, &meeting);
  CHECK(frame.counts.node_visits[kWaterRay] == 1);
  CHECK(meeting.beyond == lit::Medium{lit::Medium::kWaterBody, 0});
}

}  // namespace
}  // namespace thimble::testing::light_parts
