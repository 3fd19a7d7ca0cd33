// Each way to draw a frame gives the bytes and hits of render_band: whatever the world, the camera, the shading, the format
// and the bands. THIMBLE_LONG draws a hundred times as much; THIMBLE_SEED begins elsewhere.
#include <doctest/doctest.h>

#include <cstdint>

#include "support/frames.h"

namespace thimble::tests {

TEST_CASE("frames: the golden frames, by every engine of the core -> the bytes and hits of render_band") {
  check_golden_frames(core_engines());
}

TEST_CASE("frames: any world and camera, by every engine of the core -> the bytes and hits of render_band") {
  check_frames({core_engines(),
                {worlds::kAny, worlds::kCabinet, worlds::kSolid},
                {cameras::kAny, cameras::kHard},
                20260101,
                400'000,
                40'000});
}

TEST_CASE("frames: directions of all the bits that 32 bits take, and one more -> drawn so, or none of it") {
  const Tallies drawn = check_frames(
      {core_engines(), {worlds::kAny, worlds::kSolid}, {cameras::kBorder}, 20261129, 20'000, 10'000, 24});
  const std::uint64_t taken = drawn.pixels_of("core, 32 bits");
  CHECK(taken > drawn.pixels_of("core, 64 bits") / 10);
  CHECK(taken < drawn.pixels_of("core, 64 bits") * 9 / 10);
}

TEST_CASE("brick frames: hard cameras in small worlds -> the bytes and hits of render_band, none wrong") {
  const Tallies drawn = check_frames({brick_engines(),
                                      {worlds::kChip, worlds::kAny},
                                      {cameras::kChip, cameras::kAny},
                                      20260401,
                                      1'000'000,
                                      200'000});
  CHECK(drawn.pixels_of("bricks, fast") > drawn.pixels_of("bricks") / 2);
}

// A tile's slope on one axis may come to 2 once it is narrowed.
TEST_CASE("brick frames: wide pictures of few pixels along diagonals -> the bytes and hits of render_band") {
  check_frames({brick_engines(), {worlds::kChip}, {cameras::kDiagonal}, 20261127, 5'000'000, 200'000, 8});
}

TEST_CASE("deep frames: hard cameras in worlds of level 9 and 10 -> the bytes and hits of render_band") {
  const Tallies drawn =
      check_frames({brick_engines(), {worlds::kDeep}, {cameras::kDeep}, 20261026, 1'000'000, 200'000, 24});
  CHECK(drawn.pixels_of("bricks, fast") > drawn.pixels_of("bricks") / 2);
}

}  // namespace thimble::tests
