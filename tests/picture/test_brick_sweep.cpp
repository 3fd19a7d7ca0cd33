// Frames in which faces cover many pixels: cameras that make ties, in scenes of every kind, give the bytes of
// render_band. THIMBLE_LONG draws 100 million pixels; THIMBLE_SEED begins elsewhere.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "support/random_up.h"
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

TEST_CASE("brick sweep: a million pixels of hard cameras -> the bytes and hits of render_band, none wrong") {
  std::mt19937_64 random(seed_or(20260401));
  std::vector<Rgb8> palette(256);
  for (Rgb8& color : palette) {
    color = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
             static_cast<std::uint8_t>(random())};
  }
  const std::uint64_t wanted_pixels = pixels_to_draw();
  std::uint64_t pixels = 0;
  std::uint64_t fast = 0;
  std::uint64_t last_bit = 0;
  std::uint64_t hits = 0;
  for (unsigned turn = 0;
       pixels < wanted_pixels || (last_bit <= wanted_pixels / 100 && pixels < 40 * wanted_pixels); ++turn) {
    const std::uint64_t seed = random();
    CAPTURE(seed);
    std::mt19937_64 own(seed);
    const int level = pick_int(own, 3, 6);
    const ChipScene scene = make_chip_scene(own, kChipWorlds[turn % 6], level);
    for (int view = 0; view < 6; ++view) {
      CAPTURE(view);
      const Camera camera = hard_chip_camera(own, level);
      Shading shading;
      shading.mode = pick_int(own, 0, 5) == 0 ? ShadeMode::kDepth : ShadeMode::kColor;
      shading.palette = {palette.data(), palette.size()};
      shading.far_q8 = 256 << level;
      const PixelFormat format = static_cast<PixelFormat>(pick_int(own, 0, 4));
      const std::size_t stride =
          row_bytes(format, camera.width_px()) + static_cast<std::size_t>(pick_int(own, 0, 3));
      RenderCounts counts;
      RenderCounts counts_wanted;
      const auto wanted = drawn(
          scene, camera, shading, format, stride, camera.height_px(),
          [](const ChipScene& of, const Camera& by, const Shading& with, const Band& band,
             RenderCounts* sum) { return render_band(of.tree, by, with, band, sum); },
          &counts_wanted);
      const auto got = drawn(
          scene, camera, shading, format, stride,
          pick_int(own, 0, 1) == 0 ? camera.height_px() : pick_int(own, 1, 20),
          [](const ChipScene& of, const Camera& by, const Shading& with, const Band& band,
             RenderCounts* sum) { return render_band(of.tree, of.map, by, with, band, sum); },
          &counts);
      REQUIRE(got == wanted);  // the gaps between rows too
      REQUIRE(counts.hits == counts_wanted.hits);
      const auto area =
          static_cast<std::uint64_t>(camera.width_px()) * static_cast<std::uint64_t>(camera.height_px());
      pixels += area;
      const bool is_fast = draws_fast(scene.map, camera);
      fast += is_fast ? area : 0;
      last_bit += is_fast && takes_31_bits(camera) ? area : 0;
      hits += counts.hits;
    }
  }
  CHECK(fast > wanted_pixels / 2);
  CHECK(last_bit > wanted_pixels / 100);
  CHECK(hits > wanted_pixels / 10);
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
TEST_CASE("brick sweep: a tile that cannot be narrowed along its second axis -> goes on as it was") {
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

TEST_CASE(
    "brick sweep: wide pictures of few pixels along diagonals, in bands of few rows -> the tree's bytes") {
  std::mt19937_64 random(seed_or(20261127));
  const std::uint64_t wanted_pixels = 20 * pixels_to_draw();
  Shading shading;
  shading.mode = ShadeMode::kNormal;
  const auto by_tree = [](const ChipScene& scene, const Camera& camera, const Shading& with, const Band& band,
                          RenderCounts* counts) {
    return render_band(scene.tree, camera, with, band, counts);
  };
  const auto by_map = [](const ChipScene& scene, const Camera& camera, const Shading& with, const Band& band,
                         RenderCounts* counts) {
    return render_band(scene.tree, scene.map, camera, with, band, counts);
  };
  std::uint64_t pixels = 0;
  for (int turn = 0; pixels < wanted_pixels; ++turn) {
    const std::uint64_t seed = random();
    CAPTURE(seed);
    std::mt19937_64 own(seed);
    const int level = pick_int(own, 3, 5);
    const int side_q8 = 256 << level;
    const ChipScene scene = make_chip_scene(own, kChipWorlds[turn % 6], level);
    for (int view = 0; view < 8; ++view) {
      CAPTURE(view);
      Vec3Q8 eye;
      Vec3i forward;
      for (int axis = 0; axis < 3; ++axis) {
        eye[axis] = Q8::from_raw(pick_int(own, -600, side_q8 + 600));
        forward[axis] = pick_int(own, -1, 1);
      }
      const Q16 fov = Q16::saturate(pick_int(own, 60, 120));
      const int width = pick_int(own, 16, 70);
      const int height = pick_int(own, 8, 40);
      const int bits = pick_int(own, 0, 1) == 0 ? 0 : pick_int(own, kMinDirectionBits, 12);
      Camera camera;
      if (camera.set(PerspectiveView{eye, forward, random_up(own), fov, width, height, bits}, level) !=
          Status::kOk) {
        continue;
      }
      const std::size_t stride = row_bytes(PixelFormat::kGray8, width);
      const auto wanted =
          drawn(scene, camera, shading, PixelFormat::kGray8, stride, height, by_tree, nullptr);
      for (const int rows : {1, 3, height}) {
        CAPTURE(rows);
        REQUIRE(drawn(scene, camera, shading, PixelFormat::kGray8, stride, rows, by_map, nullptr) == wanted);
        pixels += wanted.size();
      }
    }
  }
}

TEST_CASE("bricks: rays of 14 bits and more that start over 64 voxels outside -> the tree's answer") {
  const ChipScene three = make_chip_scene(7, {{30, 102, 55}, {0, 0, 0}, {127, 123, 127}});
  check_bricks(
      three,
      {eye_at(32640, 48145, 15488), {-397, 18, -388}, {-459, -673, -407}, Q16::saturate(120), 3, 4, 14},
      ShadeMode::kColor, 4);
  // Any far eye, worlds of 128 and 256 voxels a side.
  std::mt19937_64 random(64);
  int drawn_views = 0;
  for (int world = 0; world < 6; ++world) {
    const int level = 7 + world % 2;
    const int side = 256 << level;
    std::vector<Vec3i> voxels;
    for (int i = 0; i < 4000; ++i) {
      const auto at = [&] { return pick_int(random, 0, (1 << level) - 1); };
      voxels.push_back({at(), at(), at()});
    }
    const ChipScene scene = make_chip_scene(level, voxels);
    for (int turn = 0; turn < 40; ++turn) {
      CAPTURE(world);
      CAPTURE(turn);
      Vec3Q8 eye;
      Vec3i forward;
      for (int axis = 0; axis < 3; ++axis) {
        eye[axis] = Q8::from_raw(pick_int(random, -side, 2 * side));
        forward[axis] = pick_int(random, 0, side) - eye[axis].raw;
      }
      const PerspectiveView view{eye,
                                 forward,
                                 {},
                                 Q16::from_raw(pick_int(random, 65536, 120 * 65536)),
                                 pick_int(random, 1, 60),
                                 pick_int(random, 1, 40),
                                 pick_int(random, 0, 1) == 0 ? 0 : pick_int(random, kMinDirectionBits, 20)};
      Camera camera;
      if (camera.set(view, level) != Status::kOk) {
        continue;
      }
      ++drawn_views;
      check_bricks(scene, view, ShadeMode::kColor, view.height_px);
    }
  }
  CHECK(drawn_views > 100);
}

// Worlds that are full, and a voxel in a corner, from which eyes are farthest; pictures of few pixels, whose rays start
// far from the box.
TEST_CASE("bricks: eyes as far away as frames by bricks take them -> the tree's answer") {
  std::mt19937_64 random(31);
  int last_bit = 0;
  for (int world = 0; world < 12; ++world) {
    const int level = 6 + world % 3;
    const int last = (1 << level) - 1;
    std::vector<Vec3i> voxels;
    for (int i = world % 2 == 0 ? 3000 : 2; i > 0; --i) {
      const auto at = [&] {
        return world % 2 == 0 ? pick_int(random, 0, last) : last * pick_int(random, 0, 1);
      };
      voxels.push_back({at(), at(), at()});
    }
    const ChipScene scene = make_chip_scene(level, voxels);
    for (int turn = 0; turn < 60; ++turn) {
      CAPTURE(world);
      CAPTURE(turn);
      const int bits = pick_int(random, 13, 15);
      Vec3Q8 eye;
      Vec3i forward;
      const int look = pick_int(random, 0, 2);
      const Vec3i& target = voxels[static_cast<std::size_t>(pick_int(random, 0, 1))];
      for (int axis = 0; axis < 3; ++axis) {
        eye[axis] = Q8::from_raw(far_coordinate(random, level, bits));
        forward[axis] = look == 0   ? pick_int(random, -1, 1)
                        : look == 1 ? pick_int(random, -1000, 1000)
                                    : 256 * target[axis] + 128 - eye[axis].raw;
      }
      const bool small = pick_int(random, 0, 1) == 0;
      const PerspectiveView view{eye,
                                 forward,
                                 {},
                                 Q16::from_raw(pick_int(random, 65536, 120 * 65536)),
                                 small ? pick_int(random, 1, 6) : pick_int(random, 1, 60),
                                 small ? pick_int(random, 1, 6) : pick_int(random, 1, 40),
                                 bits};
      Camera camera;
      if (camera.set(view, level) != Status::kOk) {
        continue;
      }
      last_bit += draws_fast(scene.map, camera) && takes_31_bits(camera) ? 1 : 0;
      check_bricks(scene, view, ShadeMode::kColor, view.height_px);
    }
  }
  CHECK(last_bit > 100);
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
