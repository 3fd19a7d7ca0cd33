// What light counts: rays, and how many of them met something.
#include <doctest/doctest.h>

#include <cstdint>

#include "support/lit_world.h"

namespace {

using namespace thimble;
using namespace thimble::testing;

TEST_CASE("counts of a lit picture: light that comes through panes is one ray, with one hit at most") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 2}, 0);
  // Three panes between the floor and the sun, and what stops light behind them.
  for (int pane = 0; pane < 3; ++pane) {
    world.box({0, 0, 8 + 6 * pane}, {32, 32, 10 + 6 * pane}, 1);
  }
  world.box({4, 4, 28}, {12, 12, 30}, 2);
  world.surfaces[1] = surface(SurfaceKind::kGlass, {255, 255, 255});
  world.lights = {sun({-1, -2, 9})};
  world.scene.has_shadows = true;
  world.finish();
  world.look({16 * 256, -20 * 256, 5 * 256}, {16 * 256, 16 * 256, 2 * 256}, 50, 32, 24);
  LitCounts counts;
  world.draw(Effect::kDirectLight | Effect::kShadows | Effect::kGlass, &counts);
  constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
  CHECK(counts.rays[kShadow] > 100);
  CHECK(counts.hits[kShadow] > 100);
  CHECK(counts.hits[kShadow] <= counts.rays[kShadow]);
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    rays += counts.rays[kind];
    hits += counts.hits[kind];
  }
  CHECK(hits <= rays);
}

}  // namespace
