// The GPU renderer on whatever Vulkan device there is, a software driver among them: the core's pictures and hits. The
// tests' row has the validation layer, which must say nothing.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "gpu/renderer.h"
#include "support/frames.h"
#include "support/hard_frames.h"
#include "support/ray_cases.h"
#include "support/wide_cases.h"

namespace thimble::tests {
namespace {

// Says once why nothing is tested; the row is then skipped.
bool has_device() {
  if (!gpu::devices().empty()) {
    return true;
  }
  MESSAGE("skipped: there is no Vulkan device");
  return false;
}

const Engine kDevice{"gpu device",
                     [](Subject&, const FrameCase& frame) {
                       return frame.band.stride_bytes == 0 && frame.band.rows > 0 &&
                              !has_pages(frame.band.format);
                     },
                     [](const Engine&, Subject& subject, const FrameCase& frame, std::mt19937_64&,
                        const Band& band, RenderCounts* counts) {
                       gpu::Renderer renderer(subject.tree(), frame.shading.palette, {});
                       return renderer.draw(frame.camera, frame.shading, band, counts);
                     },
                     false};

}  // namespace

TEST_CASE("gpu device: the golden frames -> every pixel and hit is the core's") {
  if (has_device()) {
    check_golden_frames({kDevice});
  }
}

TEST_CASE("gpu device: hard cameras, bands of any rows -> every pixel is the core's") {
  if (has_device()) {
    check_frames({{kDevice},
                  {worlds::kAny, worlds::kSolid},
                  {cameras::kAny, cameras::kHard},
                  61000,
                  100'000,
                  20'000,
                  12});
  }
}

TEST_CASE("gpu device: hard rays -> every hit is the core's") {
  if (!has_device()) {
    return;
  }
  int wrong = 0;
  for (int i = 0; i < many_or_few(8, 2); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const WideScene scene = solid_scene(random, 3 + i);
    const std::vector<Ray> rays = accepted_rays(static_cast<std::uint64_t>(i), scene.level, 2000);
    gpu::Renderer renderer(scene.tree, {}, {});
    std::vector<Hit> hits(rays.size());
    REQUIRE(renderer.trace({rays.data(), rays.size()}, {hits.data(), hits.size()}) == Status::kOk);
    for (std::size_t k = 0; k < rays.size(); ++k) {
      Hit expected;
      REQUIRE(closest_hit(scene.tree, rays[k], &expected) == Status::kOk);
      wrong += same_hit(hits[k], expected) ? 0 : 1;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("gpu device: several frames under way -> each one is its camera's") {
  if (!has_device()) {
    return;
  }
  std::mt19937_64 random(5);
  const WideScene scene = solid_scene(random, 6);
  gpu::Options options;
  options.frames = 3;
  gpu::Renderer renderer(scene.tree, {}, options);
  std::vector<FrameCase> frames;
  while (frames.size() < 3) {
    FrameCase frame;
    if (make_frame(random, scene, cameras::kHard, &frame)) {
      frame.band.stride_bytes = 0;
      frame.band.format = PixelFormat::kRgb888;
      frame.shading.palette = {};
      frames.push_back(frame);
    }
  }
  for (int i = 0; i < 3; ++i) {
    renderer.begin(i, frames[static_cast<std::size_t>(i)].camera, frames[static_cast<std::size_t>(i)].shading,
                   true);
  }
  for (int i = 0; i < 3; ++i) {
    const gpu::Frame ended = renderer.end(i);
    std::uint64_t hits = 0;
    const auto expected = draw_core(scene, frames[static_cast<std::size_t>(i)], &hits);
    int wrong = 0;
    for (std::size_t at = 0; at < expected.size(); ++at) {
      wrong += static_cast<std::uint8_t>(ended.pixels[at / 3] >> (8 * (at % 3))) == expected[at] ? 0 : 1;
    }
    CHECK(wrong == 0);
  }
}

TEST_CASE("gpu device: damaged trees -> every ray ends") {
  if (!has_device()) {
    return;
  }
  int traced = 0;
  for (int i = 0; i < 12; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(900 + i));
    const WideScene sound = solid_scene(random, 6);
    std::vector<std::uint8_t> bytes(sound.tree.bytes(), sound.tree.bytes() + sound.tree.size_bytes());
    for (int flips = 0; flips < 8; ++flips) {
      bytes[static_cast<std::size_t>(pick(random, 56, static_cast<std::int64_t>(bytes.size()) - 1))] ^=
          static_cast<std::uint8_t>(1U << pick(random, 0, 7));
    }
    CompactTree tree;
    REQUIRE(CompactTree::open({bytes.data(), bytes.size()}, &tree) == Status::kOk);
    gpu::Renderer renderer(tree, {}, {});
    std::vector<Ray> rays;
    for (int k = 0; k < 500; ++k) {
      rays.push_back({{Q8::from_raw(-1000 + 7 * k), Q8::from_raw(-900), Q8::from_raw(9 * k)},
                      {40, 100 + k, 3 * (k % 31) - 20}});
    }
    std::vector<Hit> hits(rays.size());
    REQUIRE(renderer.trace({rays.data(), rays.size()}, {hits.data(), hits.size()}) == Status::kOk);
    for (const Hit& hit : hits) {
      CHECK(hit.kind != HitKind::kStepLimit);
      ++traced;
    }
  }
  CHECK(traced == 6000);
}

}  // namespace thimble::tests
