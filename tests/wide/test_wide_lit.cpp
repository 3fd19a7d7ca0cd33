// Lit pictures by streams of rays: every byte is the core's.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "support/lit_cases.h"
#include "support/wide_cases.h"
#include "wide/lit/lit_renderer.h"

namespace thimble::tests {
TEST_CASE("wide: lit scenes of any kind -> every byte is the core's") {
  const BestInstructionSet after;
  constexpr int kFrames = many_or_few(1000, 60);
  std::mt19937_64 random(20261123);
  int drawn = 0;
  int lit_up = 0;
  while (drawn < kFrames) {
    const WideScene scene = pick(random, 0, 2) == 0 ? random_scene(random) : cabinet(random);
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    const LitCase lit = random_light(random, scene.level);
    if (kHasPanelFormats && pick(random, 0, 2) == 0) {
      frame.band.format = static_cast<PixelFormat>(pick(random, 0, 13));
      frame.band.stride_bytes = 0;
      if (has_pages(frame.band.format)) {
        frame.band.first_row = 0;
        frame.band.rows = frame.camera.height_px();
      }
    }
    use_random_instruction_set(random);
    const HeapBytes map_bytes(wide::RayMap::bytes(scene.tree));
    Arena arena(map_bytes.span());
    wide::RayMap map;
    REQUIRE(wide::RayMap::make(scene.tree, &arena, &map) == Status::kOk);
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
    lit_up += expected.counts.hits[0] != 0 ? 1 : 0;
    ++drawn;
  }
  CHECK(lit_up > kFrames / 3);
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
