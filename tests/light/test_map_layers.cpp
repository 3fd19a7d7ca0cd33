// Rays to lamps go through the air by layers of empty bricks at once: what hangs there hides the lamp wherever it is,
// and to the pixel.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "support/ray_cases.h"
#include "thimble/light/map_render.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

constexpr int kWide = 44;
constexpr int kHigh = 32;
constexpr EffectSet kByLamps = Effect::kDirectLight | Effect::kShadows | Effect::kEmitterLight;

struct Drawn {
  std::vector<std::uint8_t> bytes;
  LitCounts counts;
};
template <class Render>
Drawn drawn(const Render& render) {
  Drawn made;
  made.bytes.resize(3 * kWide * kHigh);
  REQUIRE(render({{made.bytes.data(), made.bytes.size()}, PixelFormat::kRgb888, 0, 0, kHigh}, &made.counts) ==
          Status::kOk);
  return made;
}

/// A wall all over one side of the world, and a few voxels in the air before it, in clusters.
std::vector<Vec3i> hang_before_a_wall(std::mt19937_64& random, int side, int axis, bool high, int count) {
  std::vector<Vec3i> voxels;
  for (int i = 0; i < side; ++i) {
    for (int k = 0; k < side; ++k) {
      Vec3i at{};
      at[axis] = high ? side - 1 : 0;
      at[(axis + 1) % 3] = i;
      at[(axis + 2) % 3] = k;
      voxels.push_back(at);
    }
  }
  Vec3i at{};
  for (int i = 0; i < count; ++i) {
    const bool anew = i % 12 == 0;
    for (int other = 0; other < 3; ++other) {
      at[other] = anew ? pick_int(random, 0, side - 1)
                       : std::min(std::max(at[other] + pick_int(random, -1, 1), 0), side - 1);
    }
    voxels.push_back(at);
  }
  return voxels;
}

TEST_CASE("lamps by the map: voxels that hang in the air, empty bricks around them -> the tree's shadows") {
  std::mt19937_64 random(20261125);
  std::uint64_t hidden = 0;
  std::uint64_t reached = 0;
  for (int turn = 0; turn < 360; ++turn) {
    CAPTURE(turn);
    const int level = 5 + turn % 2;
    const int side = 1 << level;
    const int axis = turn % 3;
    const bool high = turn / 3 % 2 != 0;
    const ChipScene scene =
        make_chip_scene(level, hang_before_a_wall(random, side, axis, high, turn % 40 * 4));
    const auto anywhere = [&](int grain) { return pick_int(random, 0, 256 * side) / grain * grain; };
    // From across the world towards some place of the wall.
    Vec3Q8 eye{};
    Vec3i forward{};
    for (int i = 0; i < 3; ++i) {
      const int from = i == axis ? (high ? 0 : 256 * side) : anywhere(1);
      const int to = i == axis ? (high ? 256 * side : 0) : anywhere(1);
      eye[i] = Q8::from_raw(from);
      forward[i] = to - from;
    }
    Camera camera;
    REQUIRE(camera.set(PerspectiveView{eye, forward, {}, Q16::saturate(50), kWide, kHigh, 0}, level) ==
            Status::kOk);
    std::vector<Light> lamps(turn / 6 % 2 == 0 ? 1 : 2);
    for (Light& lamp : lamps) {
      lamp.is_point = true;
      lamp.reach = 60;
      const int grain = turn % 4 == 0 ? 256 : turn % 4 == 1 ? 1024 : 1;
      Vec3i place{};
      for (int i = 0; i < 3; ++i) {
        place[i] = anywhere(grain);
      }
      lamp.place = place;
      lamp.color_q8[0] = lamp.color_q8[1] = lamp.color_q8[2] = 900;
    }
    LitScene lit;
    lit.lights = {lamps.data(), lamps.size()};
    const Shading shading;
    const Drawn wanted = drawn([&](const Band& band, LitCounts* counts) {
      return render_lit_band<kByLamps>(scene.tree, camera, shading, lit, band, counts);
    });
    const Drawn got = drawn([&](const Band& band, LitCounts* counts) {
      return render_lit_band<kByLamps>(scene.tree, scene.map, camera, shading, lit, {}, band, counts);
    });
    REQUIRE(got.bytes == wanted.bytes);
    constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
    CHECK(got.counts.rays[kShadow] == wanted.counts.rays[kShadow]);
    CHECK(got.counts.node_visits[kShadow] <= wanted.counts.node_visits[kShadow] / 4);
    hidden += got.counts.hits[kShadow];
    reached += got.counts.rays[kShadow] - got.counts.hits[kShadow];
  }
  // Both happen often, or else nothing was tested.
  CHECK(hidden > 10000);
  CHECK(reached > 100000);
}

}  // namespace
