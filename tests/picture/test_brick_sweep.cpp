// Frames in which faces cover many pixels, where a number of the sweep ends: the bytes of render_band.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "support/ray_cases.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

using Draw = Status (*)(const ChipScene& scene, const Camera& camera, const Shading& shading,
                        const Band& band, RenderCounts* counts);

std::vector<std::uint8_t> drawn(const ChipScene& scene, const Camera& camera, const Shading& shading,
                                PixelFormat format, std::size_t stride, int rows, Draw draw,
                                RenderCounts* counts) {
  const int height = camera.height_px();
  std::vector<std::uint8_t> bytes(stride * static_cast<std::size_t>(height), 0x5A);
  for (int y = 0; y < height; y += rows) {
    const int count = std::min(rows, height - y);
    Band band{{bytes.data() + stride * static_cast<std::size_t>(y), stride * static_cast<std::size_t>(count)},
              format,
              stride,
              y,
              count};
    REQUIRE(draw(scene, camera, shading, band, counts) == Status::kOk);
  }
  return bytes;
}

// The picture by bricks against that of the tree, in these bands.
void check_bricks(const ChipScene& scene, const PerspectiveView& view, ShadeMode mode, int rows) {
  Camera camera;
  REQUIRE(camera.set(view, scene.tree.level()) == Status::kOk);
  Shading shading;
  shading.mode = mode;
  shading.far_q8 = 256 << scene.tree.level();
  const std::size_t stride = row_bytes(PixelFormat::kRgb888, view.width_px);
  RenderCounts counts;
  RenderCounts wanted_counts;
  const auto wanted = drawn(
      scene, camera, shading, PixelFormat::kRgb888, stride, view.height_px,
      [](const ChipScene& of, const Camera& by, const Shading& with, const Band& band, RenderCounts* sum) {
        return render_band(of.tree, by, with, band, sum);
      },
      &wanted_counts);
  const auto got = drawn(
      scene, camera, shading, PixelFormat::kRgb888, stride, rows,
      [](const ChipScene& of, const Camera& by, const Shading& with, const Band& band, RenderCounts* sum) {
        return render_band(of.tree, of.map, by, with, band, sum);
      },
      &counts);
  CHECK(got == wanted);
  CHECK(counts.hits == wanted_counts.hits);
}
Vec3Q8 eye_at(int x, int y, int z) {
  return {Q8::from_raw(x), Q8::from_raw(y), Q8::from_raw(z)};
}

// Narrowed to the pixels that are left, a tile's slope on one axis may come to 2, where that of all of them did not.
TEST_CASE("brick sweep: a tile that cannot be narrowed along its second axis -> stays as it was") {
  const ChipScene scene = make_chip_scene(3, {{5, 6, 3}, {6, 0, 4}});
  const Vec3Q8 eye{Q8::from_raw(2304), Q8::from_raw(1017), Q8::from_raw(1519)};
  Camera camera;
  REQUIRE(camera.set(PerspectiveView{eye, {-1, 0, -1}, {}, Q16::saturate(101), 62, 32, 0}, 3) == Status::kOk);
  Shading shading;
  shading.mode = ShadeMode::kNormal;
  std::vector<std::uint8_t> wanted(62 * 32);
  REQUIRE(render_band(scene.tree, camera, shading,
                      {{wanted.data(), wanted.size()}, PixelFormat::kGray8, 0, 0, 32}) == Status::kOk);
  for (int row = 0; row < 32; ++row) {
    CAPTURE(row);
    std::vector<std::uint8_t> got(62);
    REQUIRE(render_band(scene.tree, scene.map, camera, shading,
                        {{got.data(), got.size()}, PixelFormat::kGray8, 0, row, 1}) == Status::kOk);
    CHECK(std::equal(got.begin(), got.end(), wanted.begin() + 62 * row));
  }
}

TEST_CASE("bricks: rays of 14 bits that start over 64 voxels outside -> the tree's answer") {
  const ChipScene three = make_chip_scene(7, {{30, 102, 55}, {0, 0, 0}, {127, 123, 127}});
  check_bricks(
      three,
      {eye_at(32640, 48145, 15488), {-397, 18, -388}, {-459, -673, -407}, Q16::saturate(120), 3, 4, 14},
      ShadeMode::kColor, 4);
}

TEST_CASE("brick sweep: rays of few bits, far apart on the picture's middle -> no division by nothing") {
  const ChipScene one = make_chip_scene(6, {{11, 32, 32}});
  check_bricks(one, {eye_at(2176, 8320, 8320), {1, 0, 0}, {0, 1, 0}, Q16::saturate(120), 5096, 40, 8},
               ShadeMode::kColor, 8);
  std::mt19937_64 random(65);
  for (int turn = 0; turn < 12; ++turn) {
    CAPTURE(turn);
    Vec3i forward;
    for (int axis = 0; axis < 3; ++axis) {
      forward[axis] = pick_int(random, -20, 20);
    }
    forward[turn % 3] = 1000;
    const PerspectiveView view{eye_at(2176, 8320, 8320),
                               forward,
                               {},
                               Q16::saturate(pick_int(random, 90, 120)),
                               pick_int(random, 3000, 7000),
                               pick_int(random, 8, 60),
                               pick_int(random, kMinDirectionBits, 10)};
    Camera camera;
    if (camera.set(view, 6) == Status::kOk) {
      check_bricks(one, view, ShadeMode::kColor, 8);
    }
  }
}

TEST_CASE("brick sweep: a face whose half plane just holds all pixels of a cell -> painted") {
  std::vector<Vec3i> pillar;
  for (int z = 0; z < 64; ++z) {
    pillar.push_back({20, 30, z});
  }
  check_bricks(make_chip_scene(6, pillar),
               {eye_at(3644, 6941, 8320), {713, 201, 162}, {0, 0, 1}, Q16::saturate(30), 64, 48, 10},
               ShadeMode::kNormal, 48);
}

// Coarse directions round to the edge of a pillar 1/256 voxel away in pixels that see what is beside it.
TEST_CASE("brick sweep: an edge close by, seen by directions of 8 bits -> the tree's bytes") {
  std::vector<Vec3i> pillar;
  for (int z = 0; z < 64; ++z) {
    pillar.push_back({32, 32, z});
  }
  const ChipScene scene = make_chip_scene(6, pillar);
  for (int turn = 0; turn < 12; ++turn) {
    CAPTURE(turn);
    const Vec3i forward{1000 + (turn % 3 - 1) * 2, 1000, turn * 40};
    check_bricks(scene,
                 {eye_at(32 * 256 - 1, 32 * 256 - 1, 32 * 256), forward, {}, Q16::saturate(4), 64, 48, 8},
                 ShadeMode::kNormal, 48);
  }
}

// From pixel to pixel the edges of a pillar 32 voxels away change what tells their sides apart by 2^25 and more: as much
// as distances of 13 bits and steps of 11 come to.
TEST_CASE(
    "brick sweep: a pillar seen along a diagonal by the coarsest pixels of its scale -> the tree's bytes") {
  std::vector<Vec3i> pillar;
  for (int z = 0; z < 64; ++z) {
    pillar.push_back({31, 31, z});
  }
  const ChipScene scene = make_chip_scene(6, pillar);
  for (const int side : {1, -1}) {
    check_bricks(scene, {eye_at(128, 128, 8320), {1, 1, 0}, {0, 0, side}, Q16::saturate(6), 360, 32, 14},
                 ShadeMode::kNormal, 32);
  }
}

// A tile covers so little of a face that its edges are uniform before they are looked at.
TEST_CASE("brick sweep: a wall close by in a picture of 6,000 rows -> the tree's bytes") {
  std::vector<Vec3i> wall;
  for (int y = 20; y < 44; ++y) {
    for (int z = 20; z < 44; ++z) {
      wall.push_back({32, y, z});
    }
  }
  const ChipScene scene = make_chip_scene(6, wall);
  for (const Vec3i& forward : {Vec3i{5, 4, 1}, Vec3i{5, -4, 1}, Vec3i{5, 1, -4}}) {
    check_bricks(
        scene,
        {eye_at(30 * 256 + 40, 31 * 256 + 90, 32 * 256 + 70), forward, {}, Q16::saturate(30), 16, 6000, 14},
        ShadeMode::kNormal, 6000);
  }
}

// The widest view that there is of one row: directions grow along the axis on which the rays run, 510 a tile, and hardly
// across it. Distances lose six bits, more than directions have behind the point.
TEST_CASE("brick sweep: voxels 512 and more away at the end of the widest row -> the tree's bytes") {
  std::vector<Vec3i> voxels;
  for (int x = 100; x < 108; ++x) {
    voxels.push_back({x, 250, 128});
    voxels.push_back({x, 254 - x % 2, 128});
  }
  const ChipScene scene = make_chip_scene(8, voxels);
  for (const int x : {100, 101, 102, 104}) {
    check_bricks(scene,
                 {eye_at(x * 256 + 77, -280 * 256, 128 * 256 + 128),
                  {1, 0, 0},
                  {0, 0, 1},
                  Q16::saturate(120),
                  238,
                  1,
                  12},
                 ShadeMode::kNormal, 1);
  }
}

TEST_CASE("brick sweep: pictures of every size that displays have take the fast way from inside the world") {
  std::mt19937_64 random(3);
  const ChipScene scene = make_chip_scene(random, ChipWorld::kHills, 6);
  const Vec3Q8 eye{Q8::from_raw(20 * 256), Q8::from_raw(9 * 256 + 7), Q8::from_raw(40 * 256)};
  const struct {
    int width;
    int height;
  } kSizes[] = {{128, 64}, {160, 128}, {240, 240}, {320, 240}, {640, 480}, {800, 600}};
  for (const auto& size : kSizes) {
    Camera camera;
    REQUIRE(camera.set(PerspectiveView{eye, {3, 5, -2}, {}, Q16::saturate(60), size.width, size.height, 0},
                       6) == Status::kOk);
    CAPTURE(size.width);
    CHECK(draws_fast(scene.map, camera));
  }
}

}  // namespace
