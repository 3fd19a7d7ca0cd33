// Frames by the map in worlds of level 9 and 10, at their limits: the bytes of render_band.
#include <doctest/doctest.h>

#include <cstdint>
#include <iterator>
#include <random>
#include <vector>

#include "support/deep_worlds.h"
#include "thimble/picture/render.h"

using namespace thimble;
using namespace thimble::tests;

TEST_CASE(
    "deep frames: limits -> the farthest eye by the map, 1/256 voxel farther by the tree, the same bytes") {
  std::mt19937_64 random(20261126);
  for (const int level : {9, 10}) {
    const int side_q8 = 256 << level;
    const ChipScene scene = make_deep_scene(random, DeepWorld::kBlocks, level);
    const VoxelBox& box = scene.tree.bounds();
    for (int turn = 0; turn < 12; ++turn) {
      CAPTURE(level);
      CAPTURE(turn);
      const int axis = turn / 2 % 3;
      const bool beyond = turn % 2 != 0;
      const int distance = kMostDeepDistanceQ8 + (beyond ? 1 : 0);
      Vec3Q8 eye;
      Vec3i forward;
      for (int k = 0; k < 3; ++k) {
        const int middle = 128 * (box.low[k] + box.high[k]);
        eye[k] = Q8::from_raw(k != axis ? side_q8 / 3 : turn < 6 ? distance : side_q8 - distance);
        forward[k] = middle - eye[k].raw;
      }
      Camera camera;
      REQUIRE(camera.set(PerspectiveView{eye, forward, {}, Q16::saturate(30), 160, 90, 15}, level) ==
              Status::kOk);
      CHECK(draws_fast(scene.map, camera) != beyond);
      std::vector<std::uint8_t> wanted(160 * 90);
      std::vector<std::uint8_t> got(wanted.size());
      RenderCounts counts;
      REQUIRE(render_band(scene.tree, camera, Shading(),
                          {{wanted.data(), wanted.size()}, PixelFormat::kGray8, 0, 0, 90},
                          &counts) == Status::kOk);
      REQUIRE(render_band(scene.tree, scene.map, camera, Shading(),
                          {{got.data(), got.size()}, PixelFormat::kGray8, 0, 0, 90}) == Status::kOk);
      CHECK(got == wanted);
      CHECK(counts.hits > 0);
    }
  }
}

// 8 by 3 by 1 pages: where the table of 136 ends, the first page is the empty one.
TEST_CASE("deep frames: beams through empty pages to each page of a small table -> the tree's bytes") {
  const Vec3i voxels[] = {{0, 0, 0}, {24, 5, 8}, {56, 24, 8}, {100, 40, 3}, {127, 47, 15}};
  const ChipScene scene = make_chip_scene(9, {std::begin(voxels), std::end(voxels)});
  Shading shading;
  shading.mode = ShadeMode::kDepth;  // which is not swept
  shading.far_q8 = 256 * 128;
  for (const Vec3i& voxel : voxels) {
    CAPTURE(voxel.x);
    const Vec3Q8 eye{Q8::from_raw(256 * voxel.x + 130), Q8::saturate(-40), Q8::from_raw(256 * voxel.z + 120)};
    Camera camera;
    REQUIRE(camera.set(PerspectiveView{eye, {0, 1, 0}, {}, Q16::saturate(4), 16, 16, 0}, 9) == Status::kOk);
    REQUIRE(draws_fast(scene.map, camera));
    std::vector<std::uint8_t> wanted(16 * 16);
    std::vector<std::uint8_t> got(wanted.size());
    RenderCounts counts;
    REQUIRE(render_band(scene.tree, camera, shading,
                        {{wanted.data(), wanted.size()}, PixelFormat::kGray8, 0, 0, 16},
                        &counts) == Status::kOk);
    REQUIRE(render_band(scene.tree, scene.map, camera, shading,
                        {{got.data(), got.size()}, PixelFormat::kGray8, 0, 0, 16}) == Status::kOk);
    CHECK(got == wanted);
    CHECK(counts.hits > 0);
  }
}
