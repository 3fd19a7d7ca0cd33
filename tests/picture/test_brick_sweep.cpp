// Frames by bricks where a number of theirs ends: faces of many pixels, worlds of level 9 and 10 at their limits, the bytes
// of render_band; arguments that contradict the picture, small buffers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "support/chip_worlds.h"
#include "support/frames.h"
#include "support/ray_cases.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"

namespace {

using namespace thimble;
using namespace thimble::tests;

// By bricks, whole and in bands, against the tree. -> what it hit.
std::uint64_t check_bricks(const WideScene& scene, const PerspectiveView& view, ShadeMode mode,
                           bool is_fast = false) {
  FrameCase frame;
  REQUIRE(frame.camera.set(view, scene.level) == Status::kOk);
  frame.shading.mode = mode;
  frame.shading.far_q8 = 256 << scene.level;
  frame.band.format = PixelFormat::kRgb888;
  frame.band.rows = view.height_px;
  Subject subject(scene_of({scene.tree.bytes(), scene.tree.size_bytes()}, ""));
  CHECK((!is_fast || draws_fast(subject.map(), frame.camera)));
  std::mt19937_64 random(7);
  Tallies tallies;
  std::uint64_t hits = 0;
  for (int turn = 0; turn < 3; ++turn) {
    hits = draw_by_all(brick_engines(), subject, frame, random, 0, &tallies);
  }
  CHECK(tallies.pixels_of("bricks") != 0);
  return hits;
}
WideScene voxels_at(int level, const std::vector<Vec3i>& voxels) {
  return make_scene(level, [&](Octree* octree) {
    for (const Vec3i& voxel : voxels) {
      REQUIRE(octree->insert(voxel, 1) == Status::kOk);
    }
  });
}
// All voxels of a box.
WideScene box_of(int level, const VoxelBox& box) {
  return make_scene(level, [&](Octree* octree) { REQUIRE(octree->insert_box(box, 1) == Status::kOk); });
}
Vec3Q8 eye_at(int x, int y, int z) {
  return {Q8::from_raw(x), Q8::from_raw(y), Q8::from_raw(z)};
}

// Narrowed to the pixels that are left, a tile's slope on one axis may come to 2, where that of all of them did not.
TEST_CASE("brick sweep: a tile that cannot be narrowed along its second axis -> stays as it was") {
  const PerspectiveView view{eye_at(2304, 1017, 1519), {-1, 0, -1}, {}, Q16::saturate(101), 62, 32, 0};
  check_bricks(voxels_at(3, {{5, 6, 3}, {6, 0, 4}}), view, ShadeMode::kNormal);
}

TEST_CASE("bricks: rays of 14 bits that start over 64 voxels outside -> the tree's answer") {
  check_bricks(
      voxels_at(7, {{30, 102, 55}, {0, 0, 0}, {127, 123, 127}}),
      {eye_at(32640, 48145, 15488), {-397, 18, -388}, {-459, -673, -407}, Q16::saturate(120), 3, 4, 14},
      ShadeMode::kColor);
}

TEST_CASE("brick sweep: rays of few bits, far apart on the picture's middle -> no division by nothing") {
  const WideScene one = voxels_at(6, {{11, 32, 32}});
  check_bricks(one, {eye_at(2176, 8320, 8320), {1, 0, 0}, {0, 1, 0}, Q16::saturate(120), 5096, 40, 8},
               ShadeMode::kColor);
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
      check_bricks(one, view, ShadeMode::kColor);
    }
  }
}

TEST_CASE("brick sweep: a face whose half plane just holds all pixels of a cell -> painted") {
  check_bricks(box_of(6, {{20, 30, 0}, {21, 31, 64}}),
               {eye_at(3644, 6941, 8320), {713, 201, 162}, {0, 0, 1}, Q16::saturate(30), 64, 48, 10},
               ShadeMode::kNormal);
}

// Coarse directions round to the edge of a pillar 1/256 voxel away in pixels that see what is beside it.
TEST_CASE("brick sweep: an edge close by, seen by directions of 8 bits -> the tree's bytes") {
  const WideScene scene = box_of(6, {{32, 32, 0}, {33, 33, 64}});
  for (int turn = 0; turn < 12; ++turn) {
    CAPTURE(turn);
    const Vec3i forward{1000 + (turn % 3 - 1) * 2, 1000, turn * 40};
    check_bricks(scene,
                 {eye_at(32 * 256 - 1, 32 * 256 - 1, 32 * 256), forward, {}, Q16::saturate(4), 64, 48, 8},
                 ShadeMode::kNormal);
  }
}

// From pixel to pixel the edges of a pillar 32 voxels away change what tells their sides apart by 2^25 and more: as much
// as distances of 13 bits and steps of 11 come to.
TEST_CASE(
    "brick sweep: a pillar seen along a diagonal by the coarsest pixels of its scale -> the tree's bytes") {
  const WideScene scene = box_of(6, {{31, 31, 0}, {32, 32, 64}});
  for (const int side : {1, -1}) {
    check_bricks(scene, {eye_at(128, 128, 8320), {1, 1, 0}, {0, 0, side}, Q16::saturate(6), 360, 32, 14},
                 ShadeMode::kNormal);
  }
}

// A tile covers so little of a face that its edges are uniform before they are looked at.
TEST_CASE("brick sweep: a wall close by in a picture of 6,000 rows -> the tree's bytes") {
  const WideScene scene = box_of(6, {{32, 20, 20}, {33, 44, 44}});
  for (const Vec3i& forward : {Vec3i{5, 4, 1}, Vec3i{5, -4, 1}, Vec3i{5, 1, -4}}) {
    check_bricks(
        scene,
        {eye_at(30 * 256 + 40, 31 * 256 + 90, 32 * 256 + 70), forward, {}, Q16::saturate(30), 16, 6000, 14},
        ShadeMode::kNormal);
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
  const WideScene scene = voxels_at(8, voxels);
  for (const int x : {100, 101, 102, 104}) {
    check_bricks(scene,
                 {eye_at(x * 256 + 77, -280 * 256, 128 * 256 + 128),
                  {1, 0, 0},
                  {0, 0, 1},
                  Q16::saturate(120),
                  238,
                  1,
                  12},
                 ShadeMode::kNormal);
  }
}

TEST_CASE(
    "deep frames: limits -> the farthest eye by the map, 1/256 voxel farther by the tree, the same bytes") {
  std::mt19937_64 random(20261126);
  for (const int level : {9, 10}) {
    const int side_q8 = 256 << level;
    const MappedTree scene = make_chip_scene(random, ChipWorld::kBlocks, level);
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
      const PerspectiveView view{eye, forward, {}, Q16::saturate(30), 160, 90, 15};
      Camera camera;
      REQUIRE(camera.set(view, level) == Status::kOk);
      CHECK(draws_fast(scene.map, camera) != beyond);
      CHECK(check_bricks(scene_of(scene.tree_bytes.view(), ""), view, ShadeMode::kDepth) > 0);
    }
  }
}

// 8 by 3 by 1 pages: where the table of 136 ends, the first page is the empty one.
TEST_CASE("deep frames: beams through empty pages to each page of a small table -> the tree's bytes") {
  const std::vector<Vec3i> voxels{{0, 0, 0}, {24, 5, 8}, {56, 24, 8}, {100, 40, 3}, {127, 47, 15}};
  const WideScene scene = voxels_at(9, voxels);
  for (const Vec3i& voxel : voxels) {
    CAPTURE(voxel.x);
    CHECK(check_bricks(scene,
                       {eye_at(256 * voxel.x + 130, -40 * 256, 256 * voxel.z + 120),
                        {0, 1, 0},
                        {},
                        Q16::saturate(4),
                        16,
                        16,
                        0},
                       ShadeMode::kDepth, true) > 0);  // kDepth is not swept
  }
}

TEST_CASE("brick frames: arguments that contradict the picture -> a status, and not a byte is written") {
  std::mt19937_64 random(11);
  const MappedTree scene = make_chip_scene(random, ChipWorld::kBlocks, 5);
  const MappedTree other = make_chip_scene(random, ChipWorld::kBlocks, 5);
  const CompactTree& tree = scene.tree;
  const BrickMap& map = scene.map;
  Camera camera;
  const Vec3Q8 eye{Q8::from_raw(-3000), Q8::from_raw(-2000), Q8::from_raw(9000)};
  REQUIRE(camera.set(PerspectiveView{eye, {3, 3, -2}, {}, Q16::saturate(60), 21, 16, 0}, 5) == Status::kOk);
  REQUIRE(draws_fast(map, camera));
  const Shading shading;
  std::vector<std::uint8_t> pixels(11 * 16, 0x5A);
  const std::vector<std::uint8_t> before = pixels;
  Band band{.pixels = {pixels.data(), pixels.size() - 1}, .format = PixelFormat::kGray4, .rows = 16};
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOutOfMemory);
  band.pixels.size = pixels.size();
  band.stride_bytes = 10;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kBadArgument);
  band.stride_bytes = 12;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOutOfMemory);
  band.stride_bytes = 0;
  band.first_row = 1;
  CHECK(render_band(tree, map, camera, shading, band) == Status::kBadArgument);
  band.first_row = 0;
  CHECK(render_band(other.tree, map, camera, shading, band) == Status::kDamaged);
  CHECK(render_band(tree, BrickMap(), camera, shading, band) == Status::kDamaged);
  CHECK(render_band_32(other.tree, map, camera, shading, band) == Status::kDamaged);
  CHECK(render_band_32(tree, BrickMap(), camera, shading, band) == Status::kDamaged);
  CHECK(render_band(tree, map, Camera(), shading, band) == Status::kBadArgument);
  CHECK(pixels == before);
  CHECK(render_band(tree, map, camera, shading, band) == Status::kOk);
  CHECK(pixels != before);
}

TEST_CASE(
    "brick map: too few bytes, wrong levels, odd addresses -> a status, and the least that works is known") {
  std::mt19937_64 random(5);
  for (const ChipWorld world : kChipWorlds) {
    const MappedTree scene = make_chip_scene(random, world, 5);
    const CompactTree& tree = scene.tree;
    BrickMap map = scene.map;
    const std::size_t size = map.size_bytes();
    const HeapBytes map_bytes(size);
    std::memcpy(map_bytes.span().data, scene.map_room.view().data, size);
    CHECK(size == brick_map_bytes(static_cast<std::uint32_t>((map.box().high.x - map.box().low.x) *
                                                             (map.box().high.y - map.box().low.y) *
                                                             (map.box().high.z - map.box().low.z)),
                                  map.brick_count(), map.mixed_count()));
    std::size_t written = 0;
    // Exactly as many bytes on the heap: the sanitizer sees the first beyond.
    for (std::size_t less = 0; less <= size; less += 1 + less / 2) {
      const HeapBytes room(size - less);
      CHECK(BrickMap::make(tree, room.span(), nullptr, &written) == Status::kOutOfMemory);
      BrickMap none;
      if (less != 0) {
        CHECK(BrickMap::open({map_bytes.view().data, size - less}, &none) == Status::kDamaged);
      }
    }
    bool built = false;
    for (std::size_t more = 0; !built && more < 100000; more += 64) {
      const HeapBytes room(size + more);
      built = BrickMap::make(tree, room.span(), nullptr, &written) == Status::kOk;
      if (built) {
        CHECK(written == size);
        CHECK(std::equal(map_bytes.view().begin(), map_bytes.view().end(), room.view().data));
      }
    }
    CHECK(built);
    const HeapBytes shifted(size, 4);
    CHECK(BrickMap::open(shifted.view(), &map) == Status::kBadArgument);
    CHECK(BrickMap::make(tree, shifted.span(), nullptr, &written) == Status::kBadArgument);
  }
  const HeapBytes room(most_brick_map_bytes(2));
  std::size_t written = 0;
  CHECK(BrickMap::make(CompactTree(), room.span(), nullptr, &written) == Status::kOutOfRange);
}

}  // namespace
