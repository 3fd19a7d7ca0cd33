// The wide renderer draws the core's picture: every pixel of every frame of its tests is compared with
// render_band's. Here random frames of random scenes, by every instruction set.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/wide_cases.h"

namespace thimble::tests {

TEST_CASE("wide: random scenes, cameras, shades, formats and bands -> every pixel is the core's") {
  const BestInstructionSet after;
  const int kScenes = many_or_few(1500, 120);
  int left_to_core = 0;
  int drawn = 0;
  std::uint64_t all_hits = 0;
  for (int i = 0; i < kScenes; ++i) {
    const std::uint64_t seed = 7000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    const WideScene scene = random_scene(random);
    use_random_instruction_set(random);
    for (int view = 0; view < 2; ++view) {
      FrameCase frame;
      if (!random_frame(random, scene, &frame)) {
        continue;
      }
      CAPTURE(seed);
      CAPTURE(view);
      CAPTURE(scene.what);
      CAPTURE(scene.level);
      CAPTURE(wide::instruction_set());
      CAPTURE(frame.camera.is_perspective());
      const wide::Options options = random_options(random);
      CAPTURE(thread_count(options));
      CAPTURE(static_cast<int>(options.order));
      std::uint64_t hits = 0;
      std::uint64_t expected_hits = 0;
      const auto ours = draw_wide(scene, frame, options, &hits);
      if (!ours) {
        ++left_to_core;
        continue;
      }
      ++drawn;
      const auto expected = draw_core(scene, frame, &expected_hits);
      CHECK(hits == expected_hits);
      CHECK(count_different(*ours, expected) == 0);
      all_hits += hits;
    }
  }
  CHECK(drawn > kScenes);
  CHECK(left_to_core < drawn / 4);
  CHECK(all_hits > static_cast<std::uint64_t>(drawn) * 50);
}

TEST_CASE("wide: every instruction set, order and number of threads -> the same bytes") {
  const BestInstructionSet after;
  const int kScenes = many_or_few(100, 12);
  const int sets = wide::instruction_set_count();
  std::vector<std::string> names;
  for (int set = 0; set < sets; ++set) {
    wide::use_instruction_set(set);
    names.emplace_back(wide::instruction_set());
  }
  std::sort(names.begin(), names.end());
  CHECK(std::unique(names.begin(), names.end()) == names.end());
  for (int i = 0; i < kScenes; ++i) {
    const std::uint64_t seed = 90000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    const WideScene scene = random_scene(random);
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    CAPTURE(seed);
    wide::use_instruction_set(-1);
    const auto first = draw_wide(scene, frame, {});
    for (int set = 0; set < sets; ++set) {
      wide::use_instruction_set(set);
      CAPTURE(wide::instruction_set());
      for (const int threads : {1, 2, 5}) {
        for (const wide::Order order : {wide::Order::kFlat, wide::Order::kBlocks}) {
          const wide::Options options = options_of(threads, order);
          CHECK(draw_wide(scene, frame, options) == first);
        }
      }
    }
  }
}

}  // namespace thimble::tests
