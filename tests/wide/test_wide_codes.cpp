// Pictures that keep a code a pixel: greys and faces that are found as voxels are met, in every format, and
// pictures of which little is written. Every pixel is the core's.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/wide_cases.h"

namespace thimble::tests {
namespace {

// Single voxels of one material: so many, near one another in part.
WideScene strewn(std::mt19937_64& random, int level, std::int64_t voxels) {
  const std::int64_t side = std::int64_t{1} << level;
  return make_scene(level, [&](Octree* octree) {
    for (std::int64_t n = 0; n < voxels; ++n) {
      const std::int64_t most = pick(random, 0, 2) == 0 ? side - 1 : std::min<std::int64_t>(side - 1, 40);
      const Vec3i at = random_voxel(random, 0, most);
      if ((at.x & at.y & at.z & 1) == 0) {  // no eight that make a block
        REQUIRE(octree->insert(at, 1) == Status::kOk);
      }
    }
  });
}

void check_same(const WideScene& scene, const FrameCase& frame, const wide::Options& options,
                wide::Stats* stats) {
  std::uint64_t hits = 0;
  std::uint64_t expected_hits = 0;
  const auto ours = draw_wide(scene, frame, options, &hits, stats);
  if (ours) {
    CHECK(*ours == draw_core(scene, frame, &expected_hits));
    CHECK(hits == expected_hits);
  }
}

}  // namespace

TEST_CASE("wide: faces found as voxels are met, any format -> every pixel is the core's") {
  const BestInstructionSet after;
  const int kFrames = many_or_few(1500, 200);
  std::uint64_t met = 0;
  for (int i = 0; i < kFrames; ++i) {
    const std::uint64_t seed = 61000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    const WideScene scene = strewn(random, static_cast<int>(pick(random, 2, 10)), pick(random, 1, 4000));
    REQUIRE_FALSE(scene.lists.has_blocks());
    use_random_instruction_set(random);
    FrameCase frame;
    if (!random_frame(random, scene, &frame)) {
      continue;
    }
    constexpr ShadeMode kModes[] = {ShadeMode::kNormal, ShadeMode::kColor, ShadeMode::kMono,
                                    ShadeMode::kDepth};
    frame.shading.mode = kModes[i % 4];
    CAPTURE(wide::instruction_set());
    CAPTURE(static_cast<int>(frame.band.format));
    CAPTURE(static_cast<int>(frame.shading.mode));
    wide::Stats stats;
    check_same(scene, frame, random_options(random), &stats);
    met += stats.counts.hits;
  }
  CHECK(met > 20 * static_cast<std::uint64_t>(kFrames));
}

TEST_CASE("wide: few voxels in a large picture, far, near and around the eye -> every pixel is the core's") {
  const BestInstructionSet after;
  const int kFrames = many_or_few(400, 40);
  int sparse = 0;
  for (int i = 0; i < kFrames; ++i) {
    const std::uint64_t seed = 73000 + static_cast<std::uint64_t>(i);
    std::mt19937_64 random(seed);
    CAPTURE(seed);
    const int level = static_cast<int>(pick(random, 2, 10));
    const WideScene scene = strewn(random, level, pick(random, 1, pick(random, 0, 3) == 0 ? 600 : 40));
    const std::int32_t world = 256 << level;
    FrameCase frame;
    PerspectiveView view;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t out = pick(random, 0, 2) == 0 ? 0 : 1;
      view.eye[axis] =
          Q8::from_raw(static_cast<std::int32_t>(pick(random, -out * world, world + out * world)));
    }
    const auto target = [&] { return Q8::from_raw(static_cast<std::int32_t>(pick(random, 0, world))); };
    view.forward = look_at(view.eye, {target(), target(), target()});
    view.fov_degrees = Q16::from_raw(static_cast<std::int32_t>(pick(random, 20, 110)) * 65536);
    view.width_px = static_cast<std::int32_t>(pick(random, 33, 400));
    view.height_px = static_cast<std::int32_t>(pick(random, 20, 260));
    if (frame.camera.set(view, scene.level) != Status::kOk) {
      continue;
    }
    constexpr ShadeMode kModes[] = {ShadeMode::kDepth, ShadeMode::kNormal, ShadeMode::kColor,
                                    ShadeMode::kMono};
    frame.shading.mode = kModes[pick(random, 0, 3)];
    if (pick(random, 0, 1) == 0) {
      frame.shading.background = {40, static_cast<std::uint8_t>(pick(random, 0, 255)), 200};
    }
    set_depth_range(scene, &frame);
    frame.band.format = static_cast<PixelFormat>(pick(random, 0, kPixelFormats - 1));
    frame.band.first_row = static_cast<std::int32_t>(pick(random, 0, 1)) * 8;
    frame.band.rows = view.height_px - frame.band.first_row;
    if (pick(random, 0, 1) == 0) {
      frame.band.stride_bytes = row_bytes(frame.band.format, view.width_px) + 5;
    }
    const std::size_t pieces =
        static_cast<std::size_t>((view.width_px + 31) / 32) * static_cast<std::size_t>(frame.band.rows) / 8;
    sparse += scene.lists.entries().size < pieces ? 1 : 0;
    for (int set = 0; set < wide::instruction_set_count(); ++set) {
      wide::use_instruction_set(set);
      CAPTURE(wide::instruction_set());
      CAPTURE(static_cast<int>(frame.band.format));
      wide::Stats stats;
      check_same(scene, frame, options_of(1, set % 2 == 0 ? wide::Order::kFlat : wide::Order::kAuto), &stats);
    }
  }
  CHECK(sparse > kFrames / 3);
}

}  // namespace thimble::tests
