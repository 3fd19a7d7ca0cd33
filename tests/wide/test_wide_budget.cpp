// With less memory fewer threads draw, and only where one has no room nobody does.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "scene/lit_streams.h"
#include "scene/wide_renderer.h"
#include "support/lit_world.h"
#include "support/wide_cases.h"

namespace thimble::tests {
namespace {

constexpr int kCrew = 8;
constexpr std::int32_t kSidePx = 64;

WideScene crowd() {
  std::mt19937_64 random(7);
  return make_scene(6, [&](Octree* octree) {
    for (int i = 0; i < 3000; ++i) {
      (void)octree->insert(random_voxel(random, 0, 63), 0);
    }
  });
}

Camera camera_of(int level) {
  PerspectiveView view{{Q8::saturate(20), Q8::saturate(-70), Q8::saturate(90)},
                       {1, 7, -4},
                       {},
                       Q16::saturate(60),
                       kSidePx,
                       kSidePx};
  Camera camera;
  REQUIRE(camera.set(view, level) == Status::kOk);
  return camera;
}

using Pixels = std::vector<std::uint8_t>;

// `make(arena, threads)`: who draws, or null. `draw(who)`: the picture. From what `most` bytes allow down to
// nothing: the crew does not grow, nobody is left out whom less than one thread's need would let in.
template <class Make, class Draw>
void check_budgets(std::size_t most, const Pixels& expected, const Make& make, const Draw& draw) {
  const HeapBytes bytes(most);
  int threads = kCrew;
  std::vector<bool> seen(kCrew + 1);
  for (std::size_t size = most; size > most / 200; size -= most / 200) {
    CAPTURE(size);
    Arena arena(bytes.span().subspan(0, size));
    const auto many = make(&arena, kCrew);
    Arena arena_of_one(bytes.span().subspan(0, size));
    CHECK((many != nullptr) == (make(&arena_of_one, 1) != nullptr));
    if (many == nullptr) {
      CHECK(arena.used_bytes() == 0);
      seen[0] = true;
      continue;
    }
    CHECK(!seen[0]);
    // But for the bytes that arrays lose where they begin.
    CHECK(many->threads() <= threads + 1);
    threads = std::min(threads, many->threads());
    seen[static_cast<std::size_t>(many->threads())] = true;
    Arena again(bytes.span().subspan(0, size));  // the other one has written there
    CHECK(draw(make(&again, kCrew).get()) == expected);
  }
  CHECK(seen[kCrew]);
  CHECK(seen[1]);
  CHECK(seen[0]);
}

}  // namespace

TEST_CASE("wide: less and less memory -> fewer threads, then nobody") {
  const WideScene scene = crowd();
  const Camera camera = camera_of(scene.level);
  const Shading shading;
  Pixels expected(band_bytes(PixelFormat::kGray8, kSidePx, kSidePx));
  Band band{
      .pixels = Bytes(expected.data(), expected.size()), .format = PixelFormat::kGray8, .rows = kSidePx};
  REQUIRE(render_band(scene.tree, camera, shading, band) == Status::kOk);
  const std::size_t most = tools::WideRenderer::bytes(scene.tree, kSidePx, kSidePx, kCrew);
  check_budgets(
      most, expected,
      [&](Arena* arena, int threads) {
        return tools::WideRenderer::make(scene.tree, arena, kSidePx, kSidePx, threads);
      },
      [&](tools::WideRenderer* renderer) {
        Pixels drawn(expected.size());
        for (std::int32_t row = 0; row < kSidePx; row += renderer->rows()) {
          Band part = band;
          part.first_row = row;
          part.rows = std::min(renderer->rows(), kSidePx - row);
          part.pixels = Bytes(drawn.data() + row * kSidePx, static_cast<std::size_t>(part.rows * kSidePx));
          wide::Counts work;
          CHECK(renderer->render(camera, shading, part, nullptr, &work) == Status::kOk);
        }
        return drawn;
      });
}

TEST_CASE("wide: less and less memory for lit pictures -> fewer threads, then nobody") {
  const WideScene scene = crowd();
  const Camera camera = camera_of(scene.level);
  const Shading shading;
  const std::vector<Light> lights{testing::sun({3, -5, 9}), testing::lamp({20 * 256, -9 * 256, 90 * 256})};
  LitScene lit;
  lit.lights = {lights.data(), lights.size()};
  lit.occlusion.rays = 4;
  constexpr EffectSet kFlat =
      Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion | Effect::kSky;
  for (const EffectSet effects : {kFlat, kFlat | Effect::kSmoothNormals}) {
    CAPTURE(effects);
    Pixels expected(band_bytes(PixelFormat::kRgb888, kSidePx, kSidePx));
    Band band{.pixels = Bytes(expected.data(), expected.size()), .rows = kSidePx};
    REQUIRE(render_lit_band(effects, scene.tree, camera, shading, lit, band) == Status::kOk);
    check_budgets(
        tools::LitStreams::bytes(scene.tree, effects, lit, kCrew), expected,
        [&](Arena* arena, int threads) {
          return tools::LitStreams::make(scene.tree, arena, effects, lit, threads);
        },
        [&](tools::LitStreams* streams) {
          Pixels drawn(expected.size());
          Band part = band;
          part.pixels = Bytes(drawn.data(), drawn.size());
          CHECK(streams->render({effects, camera, shading, lit}, part, nullptr) == Status::kOk);
          return drawn;
        });
  }
}

}  // namespace thimble::tests
