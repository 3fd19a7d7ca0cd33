// What the wide renderer refuses, and what memory it takes.
#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "support/counts.h"
#include "support/wide_cases.h"

namespace thimble::tests {

TEST_CASE("wide: an arena or a workspace that is too small -> kOutOfMemory, nothing taken, nothing drawn") {
  std::mt19937_64 random(5);
  for (int i = 0; i < many_or_few(20, 5); ++i) {
    const WideScene scene = random_scene(random);
    const std::size_t bytes = wide::VoxelLists::bytes(scene.tree);
    const HeapBytes memory(bytes);
    Arena enough(memory.span());
    wide::VoxelLists lists;
    REQUIRE(wide::VoxelLists::make(scene.tree, &enough, &lists) == Status::kOk);
    const std::size_t used = enough.used_bytes();
    CHECK(used <= bytes);
    for (const std::size_t size : {std::size_t{0}, used / 3, used - 1}) {
      if (used == 0 || size >= used) {
        continue;
      }
      Arena arena(memory.span().subspan(0, size));
      CHECK(wide::VoxelLists::make(scene.tree, &arena, &lists) == Status::kOutOfMemory);
      CHECK(arena.used_bytes() == 0);
    }
    FrameCase frame;
    if (!random_frame(random, scene, &frame) || frame.band.rows == 0) {
      continue;
    }
    for (const int threads : {1, 3}) {
      std::vector<std::uint8_t> pixels(band_size(frame), 0xA5);
      const std::size_t wanted = wide::workspace_bytes(frame.camera.width_px(), frame.band.rows, threads);
      for (const std::size_t size : {std::size_t{0}, wanted / 2, wanted - 1}) {
        const HeapBytes workspace(size);
        Band band = frame.band;
        band.pixels = Bytes(pixels.data(), pixels.size());
        wide::Options options;
        options.threads = threads_of(threads);
        CHECK(wide::render(scene.lists(), frame.camera, frame.shading, band, workspace.span(), nullptr,
                           options) == Status::kOutOfMemory);
        CHECK(std::all_of(pixels.begin(), pixels.end(), [](std::uint8_t byte) { return byte == 0xA5; }));
      }
    }
  }
}

TEST_CASE("wide: bands that cannot be -> refused as render_band refuses them") {
  std::mt19937_64 random(6);
  WideScene scene = random_scene(random);
  PerspectiveView view{
      {Q8::from_raw(-5000), Q8::from_raw(77), Q8::from_raw(99)}, {3, 1, 1}, {}, Q16::saturate(60), 20, 10};
  Camera camera;
  REQUIRE(camera.set(view, scene.level) == Status::kOk);
  Camera other_level;
  REQUIRE(other_level.set(view, scene.level == 12 ? 11 : scene.level + 1) == Status::kOk);
  std::vector<std::uint8_t> pixels(600);
  std::vector<std::uint8_t> workspace(wide::workspace_bytes(20, 10));
  const auto draw = [&](const Camera& of, const Band& band) {
    return wide::render(scene.lists(), of, {}, band, Bytes(workspace.data(), workspace.size()), nullptr);
  };
  Band band{.pixels = Bytes(pixels.data(), pixels.size()), .rows = 10};
  CHECK(draw(camera, band) == Status::kOk);
  CHECK(draw(Camera(), band) == Status::kBadArgument);
  CHECK(draw(other_level, band) == Status::kBadArgument);
  Band wrong = band;
  wrong.first_row = 1;
  CHECK(draw(camera, wrong) == Status::kBadArgument);
  wrong = band;
  wrong.stride_bytes = 59;
  CHECK(draw(camera, wrong) == Status::kBadArgument);
  wrong = band;
  wrong.pixels = Bytes(pixels.data(), 599);
  CHECK(draw(camera, wrong) == Status::kOutOfMemory);
  wrong = band;
  wrong.rows = 0;
  CHECK(draw(camera, wrong) == Status::kOk);
}

TEST_CASE("wide: damaged trees -> refused, or some picture within the bytes") {
  int refused = 0;
  int drawn = 0;
  for (std::uint64_t seed = 0; seed < many_or_few<std::uint64_t>(300, 30); ++seed) {
    std::mt19937_64 random(seed);
    WideScene scene = random_scene(random);
    if (scene.tree.empty()) {
      continue;
    }
    CAPTURE(seed);
    Bytes bytes = scene.bytes->span();
    for (std::int64_t i = pick(random, 1, 3); i > 0; --i) {
      bytes.data[pick(random, static_cast<std::int64_t>(kCompactHeaderBytes),
                      static_cast<std::int64_t>(bytes.size) - 1)] =
          static_cast<std::uint8_t>(pick(random, 0, 255));
    }
    CompactTree damaged;
    if (CompactTree::open(scene.bytes->view(), &damaged) != Status::kOk) {
      continue;
    }
    const HeapBytes memory(std::size_t{1} << 20);
    Arena arena(memory.span());
    wide::VoxelLists lists;
    const Status status = wide::VoxelLists::make(damaged, &arena, &lists);
    if (status != Status::kOk) {
      CHECK((status == Status::kDamaged || status == Status::kOutOfMemory));
      CHECK(arena.used_bytes() == 0);
      refused += status == Status::kDamaged ? 1 : 0;
      continue;
    }
    FrameCase frame;
    if (random_frame(random, scene, &frame)) {
      std::uint64_t hits = 0;
      (void)draw_wide(scene, frame, random_options(random), &hits);
      ++drawn;
    }
  }
  CHECK(refused > many_or_few(10, 0));
  CHECK(drawn > many_or_few(10, 0));
}

}  // namespace thimble::tests
