// Lit pictures by the GPU's kernels, as C++ and on whatever device there is: every byte is the core's.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>

#include "gpu/renderer.h"
#include "scene/backdrop.h"
#include "support/glsl.h"
#include "support/gpu_kernels.h"
#include "support/hard_frames.h"
#include "support/lit_cases.h"

namespace thimble::tests {
namespace {

using Shares = std::vector<std::uint8_t>;
using DrawLit = std::function<LitDrawn(const WideScene& scene, const FrameCase& frame, const LitCase& lit,
                                       const gpu::Backdrop& backdrop, Shares* shares)>;

// Any light that kernels draw, a third of the time all of it.
LitCase random_kernel_light(std::mt19937_64& random, int level) {
  LitCase lit = random_light(random, level);
  const bool is_all = pick(random, 0, 2) == 0;
  lit.effects = (is_all ? Effect::kAll : static_cast<EffectSet>(pick(random, 0, Effect::kAll))) &
                gpu::kEffectsInKernels;
  lit.effects |= lit.effects == Effect::kNone ? Effect::kSky : Effect::kNone;
  lit.options = {};
  return lit;
}

bool any_frame(std::mt19937_64& random, WideScene* scene, FrameCase* frame) {
  const bool is_hard = pick(random, 0, 2) == 0;
  *scene = is_hard                   ? solid_scene(random, pick_int(random, 3, 12))
           : pick(random, 0, 2) == 0 ? random_scene(random)
                                     : cabinet(random);
  if (!random_frame(random, *scene, frame) || (is_hard && !hard_camera(random, *scene, &frame->camera))) {
    return false;
  }
  frame->band = {};
  frame->band.format = static_cast<PixelFormat>(pick(random, 0, kHasPanelFormats ? 13 : 4));
  frame->band.rows = frame->camera.height_px();
  return !has_pages(frame->band.format);
}

// A ground, most of the time below what is solid.
tools::Ground random_ground(std::mt19937_64& random, const CompactTree& tree) {
  tools::Ground ground;
  ground.is_there = pick(random, 0, 4) != 0;
  ground.z = pick(random, 0, 3) == 0 ? pick_int(random, -2, (1 << tree.level()) + 2) : tree.bounds().low.z;
  ground.toward_sun = random_voxel(random, -900, 900);
  ground.reach = static_cast<std::uint16_t>(pick(random, 1, pick(random, 0, 5) == 0 ? 65535 : 20));
  return ground;
}

// What light is behind each pixel, by the command's own rule.
Shares shares_of(const CompactTree& tree, const Camera& camera, const tools::Ground& ground) {
  Shares shares;
  for (std::int32_t y = 0; y < camera.height_px(); ++y) {
    for (std::int32_t x = 0; x < camera.width_px(); ++x) {
      std::uint8_t share = 0;
      shares.push_back(tools::light_behind(tree, ground, camera.ray(x, y), &share) ? share
                                                                                   : tools::kNothingBehind);
    }
  }
  return shares;
}

// Draws so many frames, and compares every byte with the core's; and the rays of each kind.
void check_lit_frames(std::uint64_t seed, int frames, const DrawLit& draw) {
  std::mt19937_64 random(seed);
  int lit_up = 0;
  for (int drawn = 0; drawn < frames;) {
    WideScene scene;
    FrameCase frame;
    if (!any_frame(random, &scene, &frame)) {
      continue;
    }
    const LitCase lit = random_kernel_light(random, scene.level);
    const tools::Ground ground = random_ground(random, scene.tree);
    CAPTURE(drawn);
    CAPTURE(scene.what);
    CAPTURE(lit.effects);
    const LitDrawn expected = draw_lit_core(scene, frame, lit);
    Shares shares;
    const LitDrawn found =
        draw(scene, frame, lit, {ground.is_there, ground.z, ground.reach, ground.toward_sun, tools::kAround},
             &shares);
    REQUIRE(found.pixels == expected.pixels);
    REQUIRE(shares == shares_of(scene.tree, frame.camera, ground));
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      CHECK(found.counts.rays[kind] == expected.counts.rays[kind]);
      CHECK(found.counts.hits[kind] == expected.counts.hits[kind]);
    }
    lit_up += expected.counts.hits[0] != 0 ? 1 : 0;
    ++drawn;
  }
  CHECK(3 * lit_up > frames);
}

}  // namespace

TEST_CASE("gpu light: any scene, camera and light, as C++ -> every byte and count is the core's") {
  std::uint64_t outside = 0;
  for (const Pairs pairs : {Pairs::kAsNeeded, Pairs::kAlways}) {
    check_lit_frames(39100, many_or_few(1500, 60),
                     [&](const WideScene& scene, const FrameCase& frame, const LitCase& lit,
                         const gpu::Backdrop& backdrop, Shares* shares) {
                       return draw_lit_by_kernel(gpu::make_scene_words(scene.tree), frame, lit, &backdrop,
                                                 shares, pairs, &outside);
                     });
  }
  CHECK(outside == 0);
}

TEST_CASE(
    "gpu light: samples in their tone, before what is behind them -> the mean, as the command shows it") {
  std::mt19937_64 random(39300);
  for (int trial = 0; trial < 200; ++trial) {
    CAPTURE(trial);
    const std::int32_t across = pick_int(random, 1, 2);
    const std::int32_t step = across == 1 ? pick_int(random, 1, 5) : 1;
    const std::int32_t width = pick_int(random, 1, 40);
    const std::int32_t height = pick_int(random, 1, 30);
    const std::int32_t columns = (width + step - 1) / step * across;
    const std::int32_t rows = (height + step - 1) / step;
    const tools::ToneTable tone = tools::tone_table(static_cast<std::uint32_t>(pick(random, 208, 416)));
    const tools::Background background{static_cast<tools::BackgroundKind>(pick(random, 1, 3)), {9, 200, 77}};
    const auto word = [](Rgb8 color) {
      return color.r | std::uint32_t{color.g} << 8 | std::uint32_t{color.b} << 16;
    };
    std::vector<std::uint32_t> parameters;
    for (const std::int32_t value : {width, height, across, step, columns, std::max(rows - 1, 1)}) {
      parameters.push_back(static_cast<std::uint32_t>(value));
    }
    parameters.push_back(word(tools::backdrop_color(background, 0, 2)));
    parameters.push_back(word(tools::backdrop_color(background, 1, 2)));
    for (std::size_t i = 0; i < 256; i += 4) {
      parameters.push_back(word({tone[i], tone[i + 1], tone[i + 2]}) | std::uint32_t{tone[i + 3]} << 24);
    }
    std::vector<std::uint32_t> samples(static_cast<std::size_t>(columns * rows * across));
    for (std::uint32_t& sample : samples) {
      const auto share = static_cast<std::uint32_t>(pick(random, 0, 1) == 0 ? 255 : pick(random, 0, 254));
      sample = static_cast<std::uint32_t>(pick(random, 0, 0xFFFFFF)) | share << 24;
    }
    const KernelRun run = finish_by_kernel(parameters, samples);
    CHECK(run.outside == 0);
    for (std::int32_t i = 0; i < width * height; ++i) {
      const std::int32_t x = i % width / step;
      const std::int32_t y = i / width / step;
      std::uint32_t sums[3] = {};
      for (std::int32_t j = 0; j < across * across; ++j) {
        const std::uint32_t sample =
            samples[static_cast<std::size_t>((y * across + j / across) * columns + x * across + j % across)];
        const Rgb8 color = {static_cast<std::uint8_t>(sample), static_cast<std::uint8_t>(sample >> 8),
                            static_cast<std::uint8_t>(sample >> 16)};
        const auto share = static_cast<std::uint8_t>(sample >> 24);
        const Rgb8 shown = share == tools::kNothingBehind
                               ? tone(color)
                               : tools::shaded(tools::backdrop_color(background, y, rows), share);
        sums[0] += shown.r;
        sums[1] += shown.g;
        sums[2] += shown.b;
      }
      const auto count = static_cast<std::uint32_t>(across * across);
      const auto mean = [&](int c) { return static_cast<std::uint8_t>((sums[c] + count / 2) / count); };
      REQUIRE(run.output[static_cast<std::size_t>(i)] == word({mean(0), mean(1), mean(2)}));
    }
  }
}

TEST_CASE("gpu light: damaged trees, as C++ -> every read stays inside, and every pixel ends") {
  const int kTrials = many_or_few(400, 120);
  std::uint64_t outside = 0;
  int lit_up = 0;
  for (int i = 0; i < kTrials; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(8100 + i));
    CAPTURE(i);
    const WideScene sound = cabinet(random);
    std::vector<std::uint8_t> bytes(sound.tree.bytes(), sound.tree.bytes() + sound.tree.size_bytes());
    // Half of them in the ranks, by which children are found: those lead far outside.
    const gpu::Parameters of = gpu::make_scene_words(sound.tree).parameters;
    for (std::int64_t flips = pick(random, 1, 6); flips > 0; --flips) {
      const bool in_ranks = pick(random, 0, 1) == 0;
      const std::int64_t first = in_ranks ? of[gpu::kernel::kRanks] : 16;
      const std::int64_t last =
          in_ranks ? of[gpu::kernel::kMaterials] : static_cast<std::int64_t>(bytes.size());
      bytes[static_cast<std::size_t>(pick(random, first, last - 1))] ^=
          static_cast<std::uint8_t>(1U << pick(random, 0, 7));
    }
    CompactTree tree;
    FrameCase frame;
    if (!random_frame(random, sound, &frame) ||
        CompactTree::open({bytes.data(), bytes.size()}, &tree) != Status::kOk) {
      continue;
    }
    frame.band = {};
    frame.band.rows = frame.camera.height_px();
    LitCase lit = random_kernel_light(random, tree.level());
    lit.effects = gpu::kEffectsInKernels;
    Shares shares;
    const LitDrawn drawn = draw_lit_by_kernel(gpu::make_scene_words(tree), frame, lit, nullptr, &shares,
                                              Pairs::kAsNeeded, &outside);
    lit_up += drawn.counts.hits[0] != 0 ? 1 : 0;
  }
  CHECK(outside == 0);
  CHECK(3 * lit_up > kTrials);
}

TEST_CASE("gpu light: any scene, camera and light, on a device -> every byte and count is the core's") {
  if (gpu::devices().empty()) {
    MESSAGE("skipped: there is no Vulkan device");
    return;
  }
  check_lit_frames(39200, many_or_few(200, 12),
                   [](const WideScene& scene, const FrameCase& frame, const LitCase& lit,
                      const gpu::Backdrop& backdrop, Shares* shares) {
                     gpu::Renderer renderer(scene.tree, {}, {});
                     LitDrawn drawn{std::vector<std::uint8_t>(band_size(frame), 0xA5), {}};
                     Band band = frame.band;
                     band.pixels = Bytes(drawn.pixels.data(), drawn.pixels.size());
                     const Camera& camera = frame.camera;
                     shares->resize(static_cast<std::size_t>(camera.width_px()) *
                                    static_cast<std::size_t>(camera.height_px()));
                     CHECK(renderer.draw_lit({lit.effects, camera, frame.shading, lit.scene, &backdrop}, band,
                                             {shares->data(), shares->size()}, &drawn.counts) == Status::kOk);
                     return drawn;
                   });
}

}  // namespace thimble::tests
