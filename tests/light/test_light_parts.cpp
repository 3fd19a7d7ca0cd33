// Parts of a pixel, called one by one with what pictures seldom have: rays that begin 1/256 voxel before a solid, water
// with an empty column, colors brighter than any surface.
#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "support/lit_world.h"
#include "thimble/light/host/optics.h"

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

TEST_CASE("light parts: a mirror of all light -> sends on the 65535 of 65536 that its color leaves") {
  const Parts parts;
  lit::Frame frame = parts.frame(Effect::kMirror);
  lit::Spot spot;
  spot.face = {2, false};
  spot.at = LitWorld::point({4096, 4096, 1024});
  spot.arriving = {0, 3, -4};
  spot.surface = surface(SurfaceKind::kMetal, {255, 255, 255});
  lit::PendingRay now = ray_from({4096, 0, 5120}, spot.arriving);
  lit::PendingRay pending[lit::pending_rays(Effect::kMirror)];
  std::size_t count = 0;
  send_mirrored(frame, &now, spot, pending, &count);
  REQUIRE(count == 1);
  for (int i = 0; i < 3; ++i) {
    CHECK(pending[0].weight.c[i] == lit::kFullWeight - 1);
    CHECK(now.weight.c[i] == 0);
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
