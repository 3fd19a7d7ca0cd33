// The wide renderer with several threads: every pixel is the core's, whoever draws it.
#include <doctest/doctest.h>

#include "support/wide_cases.h"

namespace thimble::tests {
namespace {

// A view of a cloud in a corner of a world of level 9: from before it, from above, from within, or parallel.
void look_at_corner(int view_number, std::int32_t width, std::int32_t height, FrameCase* frame) {
  if (view_number < 3) {
    PerspectiveView view;
    const Vec3i eyes[] = {{700, -300, 260}, {80, 90, 480}, {80, 80, 80}};
    for (int axis = 0; axis < 3; ++axis) {
      view.eye[axis] = Q8::from_raw(256 * eyes[view_number][axis] + 77);
    }
    view.forward = view_number == 1 ? Vec3i{3, 1, -30} : Vec3i{-7, 10, 0};
    view.fov_degrees = Q16::from_raw(70 << 16);
    view.width_px = width;
    view.height_px = height;
    REQUIRE(frame->camera.set(view, 9) == Status::kOk);
  } else {
    OrthographicView view;
    view.eye = {Q8::from_raw(900 << 8), Q8::from_raw(-(400 << 8)), Q8::from_raw(300 << 8)};
    view.forward = {-7, 10, -1};
    view.span = Q14::from_raw(600 << 14);
    view.width_px = width;
    view.height_px = height;
    REQUIRE(frame->camera.set(view, 9) == Status::kOk);
  }
  frame->shading.mode = view_number == 1 ? ShadeMode::kNormal : ShadeMode::kDepth;
  frame->band.first_row = view_number == 2 ? 5 : 0;
  frame->band.rows = height - 3 * frame->band.first_row;
}

}  // namespace

TEST_CASE("wide: work in some rows, several threads -> every pixel is the core's") {
  const int kRepeats = many_or_few(10, 2);
  const std::int64_t kPoints = many_or_few<std::int64_t>(900000, 100000);
#ifdef __SANITIZE_THREAD__
  constexpr int kLarge = 2;  // there every step takes ten times as long
#else
  const int kLarge = many_or_few(5, 3);
#endif
  for (const bool has_blocks : {false, true}) {
    CAPTURE(has_blocks);
    std::mt19937_64 random(has_blocks ? 31 : 30);
    const auto fill = [&](Octree* octree) {
      for (std::int64_t n = 0; n < kPoints; ++n) {
        const std::int64_t most = n % 100 == 0 ? 511 : 300;
        const Vec3i at = random_voxel(random, 0, most);
        if (has_blocks && n % 50 == 0) {
          REQUIRE(octree->insert_block({at.x & ~3, at.y & ~3, at.z & ~3}, 2, 1) == Status::kOk);
        } else if (has_blocks || (at.x & at.y & at.z & 1) == 0) {
          REQUIRE(octree->insert(at, 1) == Status::kOk);
        }
      }
    };
    const WideScene scene = make_scene(9, fill, std::size_t{64} << 20, wide::ListKind::kBoxes);
    REQUIRE(scene.lists().has_blocks() == has_blocks);
    for (int v = 0; v < 4; ++v) {
      CAPTURE(v);
      // Large pictures take long enough for other threads to come, whatever else the machine does.
      for (const int scale : {1, kLarge}) {
        CAPTURE(scale);
        FrameCase frame;
        look_at_corner(v, scale * 200, scale * 280, &frame);
        set_depth_range(scene, &frame);
        wide::Options options;
        options.order = wide::Order::kBlocks;
        std::uint64_t expected_hits = 0;
        std::optional<std::vector<std::uint8_t>> expected;
        if (scale == 1) {
          expected = draw_core(scene, frame, &expected_hits);
        } else {
          expected = draw_wide(scene, frame, options, &expected_hits);
        }
        CHECK(expected_hits > 3000);
        for (const int threads : {2, 3, 8}) {
          CAPTURE(threads);
          options.threads = threads_of(threads);
          int wrong = 0;
          for (int i = 0; i < (scale == 1 ? kRepeats : 2); ++i) {
            std::uint64_t hits = 0;
            const auto ours = draw_wide(scene, frame, options, &hits);
            wrong += ours == expected && hits == expected_hits ? 0 : 1;
          }
          CHECK(wrong == 0);
        }
      }
    }
  }
}

TEST_CASE("wide: numbers of threads that cannot be -> the nearest that can") {
  CHECK(wide::Threads(-1).count() == 1);
  CHECK(wide::Threads(wide::kMaxThreads + 1).count() == wide::kMaxThreads);
}

}  // namespace thimble::tests
