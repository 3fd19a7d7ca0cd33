// Frames by the map in worlds of level 9 and 10: hard cameras give the bytes of render_band. THIMBLE_LONG draws 100 million
// pixels; THIMBLE_SEED begins elsewhere.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <random>
#include <vector>

#include "support/deep_worlds.h"
#include "support/ray_cases.h"
#include "thimble/picture/render.h"

using namespace thimble;
using namespace thimble::tests;

TEST_CASE(
    "deep frames: hard cameras in worlds of level 9 and 10 -> the bytes and hits of render_band, none "
    "wrong") {
  std::mt19937_64 random(seed_or(20261026));
  std::vector<Rgb8> palette(256);
  for (Rgb8& color : palette) {
    color = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  const std::uint64_t wanted_pixels = pixels_to_draw(100'000'000, 1'000'000);
  std::uint64_t pixels = 0;
  std::uint64_t fast = 0;
  std::uint64_t hits = 0;
  for (int turn = 0; pixels < wanted_pixels || (hits <= wanted_pixels / 10 && pixels < 10 * wanted_pixels);
       ++turn) {
    const std::uint64_t seed = random();
    CAPTURE(seed);
    CAPTURE(turn);
    std::mt19937_64 own(seed);
    const int level = pick_int(own, 9, 10);
    const ChipScene scene = make_deep_scene(own, static_cast<DeepWorld>(turn % kDeepWorldKinds), level);
    for (int view = 0; view < 24; ++view) {
      CAPTURE(view);
      const Camera camera = hard_deep_camera(own, scene.tree);
      Shading shading;
      shading.mode = pick_int(own, 0, 5) == 0 ? ShadeMode::kDepth : ShadeMode::kColor;
      shading.palette = {palette.data(), palette.size()};
      shading.far_q8 = 256 << level;
      const auto format = static_cast<PixelFormat>(pick_int(own, 0, 4));
      const std::size_t row = row_bytes(format, camera.width_px());
      std::vector<std::uint8_t> wanted(row * static_cast<std::size_t>(camera.height_px()), 0x5A);
      std::vector<std::uint8_t> got = wanted;
      RenderCounts counts_wanted;
      RenderCounts counts;
      REQUIRE(render_band(scene.tree, camera, shading,
                          {{wanted.data(), wanted.size()}, format, 0, 0, camera.height_px()},
                          &counts_wanted) == Status::kOk);
      const int rows = pick_int(own, 0, 1) == 0 ? camera.height_px() : pick_int(own, 1, 20);
      for (int y = 0; y < camera.height_px(); y += rows) {
        const int count = std::min(rows, camera.height_px() - y);
        REQUIRE(render_band(
                    scene.tree, scene.map, camera, shading,
                    {{got.data() + row * static_cast<std::size_t>(y), row * static_cast<std::size_t>(count)},
                     format,
                     0,
                     y,
                     count},
                    &counts) == Status::kOk);
      }
      REQUIRE(got == wanted);
      REQUIRE(counts.hits == counts_wanted.hits);
      const auto area =
          static_cast<std::uint64_t>(camera.width_px()) * static_cast<std::uint64_t>(camera.height_px());
      pixels += area;
      fast += draws_fast(scene.map, camera) ? area : 0;
      hits += counts.hits;
    }
  }
  CHECK(fast > wanted_pixels / 2);
  CHECK(hits > wanted_pixels / 10);
}

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
