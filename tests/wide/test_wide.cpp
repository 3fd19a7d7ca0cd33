// The wide renderer draws the core's picture: every pixel of every frame of its tests is compared with render_band's.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "support/frames.h"

namespace thimble::tests {

TEST_CASE("wide: the golden frames, by every instruction set -> every pixel is the core's") {
  check_golden_frames(wide_engines());
}

TEST_CASE(
    "wide: any world, camera, shade, format and band, by every instruction set, order, list and number of "
    "threads -> every pixel is the core's") {
  const std::vector<Engine> engines = wide_engines();
  for (std::size_t i = 1; i < engines.size(); ++i) {
    CHECK(engines[i].name != engines[i - 1].name);
  }
  check_frames({engines,
                {worlds::kAny, worlds::kSolid, worlds::kStrewn},
                {cameras::kAny, cameras::kHard, cameras::kLarge},
                7000,
                4'000'000,
                300'000,
                3});
}

TEST_CASE("wide: clouds in large worlds, whose lists have short entries -> every pixel is the core's") {
  check_frames(
      {wide_engines(), {worlds::kStars}, {cameras::kFine, cameras::kHard}, 5000, 2'000'000, 150'000, 3});
}

}  // namespace thimble::tests
