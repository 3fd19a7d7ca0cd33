// Lit pictures by streams of rays: every byte is the core's.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "support/lit_cases.h"
#include "support/wide_cases.h"
#include "wide/lit/kernels.h"
#include "wide/lit/lit_renderer.h"

namespace thimble::tests {
namespace {

// Nothing that a ray goes on from: what most pictures are.
LitCase random_opaque_light(std::mt19937_64& random, int level) {
  LitCase lit = random_light(random, level);
  lit.effects = static_cast<EffectSet>(pick(random, 0, Effect::kAll)) &
                (Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion | Effect::kEmission |
                 Effect::kSky | Effect::kEmitterLight);
  lit.effects |= pick(random, 0, 1) == 0 ? Effect::kDirectLight | Effect::kShadows : Effect::kSky;
  const auto is_lamp = [](const Light& light) { return light.is_point; };
  lit.lights.erase(std::remove_if(lit.lights.begin(), lit.lights.end(), is_lamp), lit.lights.end());
  lit.scene.lights = {lit.lights.data(), lit.lights.size()};
  return lit;
}

// Pixels here and there: three bytes each, as the core draws them alone.
void check_places(std::mt19937_64& random, const WideScene& scene, const wide::RayMap& map,
                  const FrameCase& frame, const LitCase& lit, const Bytes& workspace, int threads) {
  std::vector<wide::PixelPlace> places;
  std::vector<std::uint8_t> expected;
  for (std::int64_t i = pick(random, 0, 100); i > 0; --i) {
    const auto x = static_cast<std::int32_t>(pick(random, 0, frame.camera.width_px() - 1));
    const auto y = static_cast<std::int32_t>(pick(random, 0, frame.camera.height_px() - 1));
    std::uint8_t pixel[3];
    CHECK(render_lit_band(lit.effects, scene.tree, frame.camera.window(x, y, 1, 1), frame.shading, lit.scene,
                          {Bytes(pixel, 3), PixelFormat::kRgb888, 0, 0, 1}, nullptr,
                          lit.options) == Status::kOk);
    expected.insert(expected.end(), pixel, pixel + 3);
    places.push_back({x, y});
  }
  std::vector<std::uint8_t> drawn(expected.size(), 0xA5);
  const Bytes rgb(drawn.data(), drawn.size());
  const auto draw = [&](const Bytes& into) {
    return wide::render_lit_pixels(lit.effects, map, frame.camera, frame.shading, lit.scene,
                                   {places.data(), places.size()}, into, workspace, threads_of(threads),
                                   nullptr, lit.options);
  };
  if (!places.empty()) {
    CHECK(draw(rgb.subspan(1)) == Status::kOutOfMemory);
    CHECK(drawn[0] == 0xA5);
  }
  REQUIRE(draw(rgb) == Status::kOk);
  REQUIRE(drawn == expected);
}

// Draws so many random frames, and compares every byte and count with the core's.
void check_lit_frames(std::uint64_t seed, int frames,
                      LitCase (*make_light)(std::mt19937_64& random, int level)) {
  const BestInstructionSet after;
  std::mt19937_64 random(seed);
  int drawn = 0;
  int lit_up = 0;
  while (drawn < frames) {
    const WideScene scene = pick(random, 0, 2) == 0 ? random_scene(random) : cabinet(random);
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    const LitCase lit = make_light(random, scene.level);
    if (kHasPanelFormats && pick(random, 0, 2) == 0) {
      frame.band.format = static_cast<PixelFormat>(pick(random, 0, 13));
      frame.band.stride_bytes = 0;
      if (has_pages(frame.band.format)) {
        frame.band.first_row = 0;
        frame.band.rows = frame.camera.height_px();
      }
    }
    use_random_instruction_set(random);
    wide::LitMedia media = wide::lit_media(lit.effects, lit.scene);
    media.count = pick(random, 0, 3) == 0 ? media.count / 2 : media.count;
    const HeapBytes map_bytes(wide::RayMap::bytes(scene.tree, media.span()));
    Arena arena(map_bytes.span());
    wide::RayMap map;
    REQUIRE(wide::RayMap::make(scene.tree, &arena, &map, media.span()) == Status::kOk);
    const int threads = static_cast<int>(pick(random, 1, 3));
    const std::size_t workspace = pick(random, 0, 1) == 0
                                      ? wide::least_lit_workspace_bytes(lit.effects, lit.scene)
                                      : wide::lit_workspace_bytes(lit.effects, lit.scene) *
                                            static_cast<std::size_t>(pick(random, 1, threads));
    CAPTURE(drawn);
    CAPTURE(scene.what);
    CAPTURE(lit.effects);
    CAPTURE(threads);
    CAPTURE(frame.band.format);
    CAPTURE(wide::instruction_set());
    const LitDrawn expected = draw_lit_core(scene, frame, lit);
    const LitDrawn ours = draw_lit_streams(scene, map, frame, lit, workspace, threads);
    REQUIRE(count_different(ours.pixels, expected.pixels) == 0);
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      CAPTURE(kind);
      REQUIRE(ours.counts.rays[kind] == expected.counts.rays[kind]);
      REQUIRE(ours.counts.hits[kind] <= expected.counts.hits[kind]);
      const bool ends =
          kind == static_cast<int>(LitRayKind::kOcclusion) || kind == static_cast<int>(LitRayKind::kShadow);
      REQUIRE((ends || ours.counts.hits[kind] == expected.counts.hits[kind]));
    }
    REQUIRE(ours.counts.pending_high_water == expected.counts.pending_high_water);
    if (drawn % 4 == 0) {
      const HeapBytes of_places(workspace);
      check_places(random, scene, map, frame, lit, of_places.span(), threads);
    }
    lit_up += expected.counts.hits[0] != 0 ? 1 : 0;
    ++drawn;
  }
  CHECK(lit_up > frames / 3);
}

}  // namespace

TEST_CASE("wide: lit scenes of any kind -> every byte is the core's") {
  check_lit_frames(20261123, many_or_few(600, 40), random_light);
}
TEST_CASE("wide: lit scenes in which rays end where they hit -> every byte is the core's") {
  check_lit_frames(20261124, many_or_few(400, 15), random_opaque_light);
}

TEST_CASE("wide: the sky in lanes -> the core's, also where a length is rounded up") {
  const BestInstructionSet after;
  std::mt19937_64 random(77);
  constexpr std::size_t kCount = 4000;
  std::vector<std::int32_t> axes[3];
  for (std::size_t i = 0; i < kCount + wide::kMostSkyLanes; ++i) {
    for (auto& axis : axes) {
      const std::int64_t most = std::int64_t{1} << pick(random, 0, 20);
      const std::int64_t size = pick(random, 0, 1) == 0 ? pick(random, 0, most - 1) : most - 1;
      axis.push_back(static_cast<std::int32_t>(pick(random, 0, 1) == 0 ? size : -size));
    }
    axes[0].back() = axes[0].back() == 0 ? 1 : axes[0].back();
  }
  // So bright that each share is another colour.
  LitScene scene;
  scene.sky = {{255, 255, 255}, {0, 0, 0}, {255, 255, 255}};
  const CompactTree tree;
  const lit::Frame frame{tree, Camera(), Shading(), scene, LitOptions(), Effect::kSky};
  std::vector<std::int32_t> shares(kCount + wide::kMostSkyLanes);
  for (int set = 0; set < wide::instruction_set_count(); ++set) {
    wide::use_instruction_set(set);
    wide::find_sky_shares(axes[0].data(), axes[1].data(), axes[2].data(), kCount, shares.data());
    int wrong = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      const std::uint32_t expected = lit::sky_color(frame, {axes[0][i], axes[1][i], axes[2][i]}).c[0];
      wrong += (255 * lit::kLevel * static_cast<std::uint32_t>(shares[i])) >> 12 == expected ? 0 : 1;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("wide: a lit picture's errors are the core's, with nothing drawn") {
  std::mt19937_64 random(5);
  const WideScene scene = cabinet(random);
  FrameCase frame;
  while (!random_frame(random, scene, &frame)) {
  }
  LitScene lit;
  std::vector<std::uint8_t> pixels(band_size(frame), 0xA5);
  frame.band.pixels = Bytes(pixels.data(), pixels.size());
  const wide::RayMap map(scene.tree);
  const HeapBytes workspace(wide::least_lit_workspace_bytes(Effect::kSky, lit));
  const auto status_of = [&](const Band& band, const Bytes& work) {
    return wide::render_lit(Effect::kSky, map, frame.camera, frame.shading, lit, band, work);
  };
  CHECK(status_of(frame.band, workspace.span().subspan(1)) == Status::kOutOfMemory);
  lit.bounces = kMaxBounces + 1;
  CHECK(status_of(frame.band, workspace.span()) == Status::kOutOfRange);
  lit.bounces = 0;
  Band beyond = frame.band;
  beyond.first_row = frame.camera.height_px();
  beyond.rows = 1;
  CHECK(status_of(beyond, workspace.span()) ==
        render_lit_band(Effect::kSky, scene.tree, frame.camera, frame.shading, lit, beyond));
  CHECK(std::all_of(pixels.begin(), pixels.end(), [](std::uint8_t byte) { return byte == 0xA5; }));
  // The least is enough.
  CHECK(status_of(frame.band, workspace.span()) == Status::kOk);
}

}  // namespace thimble::tests
