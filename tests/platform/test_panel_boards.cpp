// Applications on boards whose displays have the formats of panels.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "apps/apps.h"
#include "boards/board_table.h"
#include "support/baked_demo.h"
#include "support/simulated_run.h"
#include "thimble/picture/render.h"

namespace {

using namespace thimble;

TEST_CASE("panel formats: applications on boards with such displays -> the pictures of their likes") {
  const platform::BoardFacts* oled = platform::find_board("lm3s6965evb");
  REQUIRE(oled != nullptr);
  struct Played {
    int (*application)();
    std::uint32_t hold_fps;
  };
  // The third draws thinned frames, the fourth any-time ones of what it builds.
  constexpr Played kPlayed[] = {{apps::particles, 0}, {apps::demo, 0}, {apps::demo, 30}};
  for (const Played& played : kPlayed) {
    const auto last_picture = [&](PixelFormat format) {
      platform::BoardFacts board = *oled;
      board.format = format;
      board.ram_bytes = 4 << 20;
      board.width_px = 84;
      board.height_px = 43;
      const ConstBytes scene(tests::demo_scene().bytes.data(), tests::demo_scene().bytes.size());
      const tests::SimulatedRun run = tests::run_simulated(
          {&board, true, scene, played.application, played.hold_fps}, 3, {{{1, "b"}}, {}});
      CHECK(run.fault == "");
      CHECK(run.last.bytes.size() == band_bytes(format, 84, 43));
      return tests::pixels_of(run.last);
    };
    CHECK(last_picture(PixelFormat::kMono1Pages) == last_picture(PixelFormat::kMono1));
    CHECK(last_picture(PixelFormat::kGray4Low) == last_picture(PixelFormat::kGray4));
    CHECK(last_picture(PixelFormat::kRgb565Be) == last_picture(PixelFormat::kRgb565));
    for (int number = 5; number < kPixelFormats; ++number) {
      const std::vector<std::uint8_t> picture = last_picture(static_cast<PixelFormat>(number));
      CHECK(*std::max_element(picture.begin(), picture.end()) >= 170);
    }
  }
}

}  // namespace
