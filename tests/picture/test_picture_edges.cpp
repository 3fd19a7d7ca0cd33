// Pictures at the ends of what their functions take: cameras of another world, maps of another tree, cut-offs
// in damaged trees, frames that show one colour only. Each answer is worked out by hand.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/compact_damage.h"
#include "support/scene_under_test.h"
#include "thimble/picture/anytime.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/render.h"
#include "thimble/tree/brick_map.h"
#include "thimble/tree/octree.h"

namespace thimble::tests::picture_edges {
namespace {

// From 1.5 worlds before the world along y, 90 degrees: the world fills the middle of the picture.
Camera ahead(int level, int width_px = 24, int height_px = 24, int bits = 0) {
  PerspectiveView view;
  const std::int32_t half = 128 << level;
  view.eye = {Q8::from_raw(half), Q8::from_raw(-3 * half), Q8::from_raw(half)};
  view.forward = {0, 1, 0};
  view.fov_degrees = Q16::saturate(90);
  view.width_px = width_px;
  view.height_px = height_px;
  view.direction_bits = bits;
  Camera camera;
  REQUIRE(camera.set(view, level) == Status::kOk);
  return camera;
}

struct Picture {
  Picture(const Camera& camera, PixelFormat format)
      : bytes(band_bytes(format, camera.width_px(), camera.height_px()), 0x5A),
        band{{bytes.data(), bytes.size()}, format, 0, 0, camera.height_px()} {}
  bool untouched() const {
    return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0x5A; });
  }
  std::vector<std::uint8_t> bytes;
  Band band;
};

// ---- by bricks

struct Bricks {
  explicit Bricks(const CompactTree& from)
      : room(most_brick_map_bytes(from.level())), status(BrickMap::make(from, room.span(), &map)) {
    REQUIRE(status == Status::kOk);
  }
  HeapBytes room;
  BrickMap map;
  Status status;
};

// A world of 64 from one voxel and from all of it: an eye's distance from the farthest side of the world is below
// 2^(31 - bits), that from the farthest side of what is solid 32 voxels less or nearer.
TEST_CASE("picture edges: eyes from farther and farther away -> fast frames up to the last 1/256 voxel") {
  OwnedPool corner(6);
  REQUIRE(corner.octree.insert({0, 0, 0}, 1) == Status::kOk);
  const HeapBytes corner_bytes = compact_of(corner.octree);
  const CompactTree corner_tree = open_or_throw(corner_bytes);
  const Bricks one(corner_tree);
  REQUIRE(corner.octree.insert({63, 63, 63}, 1) == Status::kOk);
  const HeapBytes whole_bytes = compact_of(corner.octree);
  const CompactTree whole_tree = open_or_throw(whole_bytes);
  const Bricks all(whole_tree);
  const auto is_fast = [](const Bricks& bricks, int axis, std::int32_t raw, int bits) {
    PerspectiveView view;
    view.eye = {Q8::saturate(32), Q8::saturate(32), Q8::saturate(32)};
    view.eye[axis] = Q8::from_raw(raw);
    view.forward = {1, 2, 3};
    view.fov_degrees = Q16::saturate(60);
    view.width_px = 8;
    view.height_px = 8;
    view.direction_bits = bits;
    Camera camera;
    REQUIRE(camera.set(view, 6) == Status::kOk);
    return draws_fast(bricks.map, camera);
  };
  const std::int32_t side = 64 * 256;
  const std::int32_t margin = 32 * 256;
  const std::int32_t reach = 1 << (31 - 15);
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    for (const Bricks* bricks : {&all, &one}) {
      CHECK(is_fast(*bricks, axis, reach - margin, 15));
      CHECK_FALSE(is_fast(*bricks, axis, reach - margin + 1, 15));
    }
    CHECK(is_fast(all, axis, side - (reach - margin), 15));
    CHECK_FALSE(is_fast(all, axis, side - (reach - margin) - 1, 15));
    CHECK(is_fast(one, axis, side - reach + 1, 15));
    CHECK_FALSE(is_fast(one, axis, side - reach, 15));
    // As far away as an eye may be.
    CHECK(is_fast(all, axis, 5 * side, 14));
    CHECK(is_fast(all, axis, -4 * side, 14));
  }
}

TEST_CASE("picture edges: cameras that no frame by bricks takes -> told, and refused or drawn ray by ray") {
  OwnedPool pool(4);
  REQUIRE(pool.octree.insert_block({4, 4, 4}, 2, 1) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const CompactTree tree = open_or_throw(bytes);
  const Bricks bricks(tree);
  CHECK(draws_fast(bricks.map, ahead(4)));
  CHECK_FALSE(draws_fast(bricks.map, Camera()));
  CHECK_FALSE(draws_fast(bricks.map, ahead(5)));
  CHECK_FALSE(draws_fast(bricks.map, ahead(3)));
  CHECK(draws_fast(bricks.map, ahead(4, 24, 24, 14)));
  CHECK_FALSE(draws_fast(bricks.map, ahead(4, 24, 24, 20)));
  OrthographicView flat;
  flat.eye = {Q8::saturate(8), Q8::saturate(-8), Q8::saturate(8)};
  flat.forward = {0, 1, 0};
  flat.span = Q14::saturate(20);
  flat.width_px = 24;
  flat.height_px = 24;
  Camera parallel;
  REQUIRE(parallel.set(flat, 4) == Status::kOk);
  CHECK_FALSE(draws_fast(bricks.map, parallel));

  Shading shading;
  for (const Camera& camera : {ahead(5), ahead(4, 24, 24, 20), parallel}) {
    Picture fast(camera, PixelFormat::kGray8);
    CHECK(render_band_32(tree, bricks.map, camera, shading, fast.band) == Status::kBadArgument);
    CHECK(fast.untouched());
    Picture any(camera, PixelFormat::kGray8);
    const Status status = render_band(tree, bricks.map, camera, shading, any.band);
    CHECK(status == (camera.level() == 4 ? Status::kOk : Status::kBadArgument));
    if (status == Status::kOk) {
      REQUIRE(render_band(tree, camera, shading, fast.band) == Status::kOk);
      CHECK(any.bytes == fast.bytes);
    }
  }
  // Without pixels there is nothing to ask for.
  Band nothing;
  CHECK(render_band_32(tree, bricks.map, Camera(), shading, nothing) == Status::kBadArgument);
  CHECK(render_band(tree, bricks.map, Camera(), shading, nothing) == Status::kBadArgument);
}

// ---- with a cut-off

TEST_CASE("picture edges: a ray with a cut-off that no path takes -> a status, and the hit as it was") {
  OwnedPool pool(12);
  REQUIRE(pool.octree.insert({5, 1, 1}, 3) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const CompactTree tree = open_or_throw(bytes);
  Ray ray;
  ray.origin = {Q8::from_raw(-256), Q8::from_raw(300), Q8::from_raw(300)};
  CutHit found;
  found.node = 77;
  CHECK(closest_hit_cut(tree, ray, Cutoff(), &found) == Status::kBadArgument);
  ray.direction = {1024, 0, 0};
  CHECK(closest_hit_cut(tree, ray, Cutoff(), &found, {UINT32_MAX, Width::k32}) == Status::kOutOfRange);
  CHECK(found.node == 77);
  ray.direction = {1023, 0, 0};
  REQUIRE(closest_hit_cut(tree, ray, Cutoff(), &found, {UINT32_MAX, Width::k32}) == Status::kOk);
  CHECK_FALSE(found.cut);
  CHECK(found.hit.voxel == Vec3i{5, 1, 1});
  // 21 bits to the far plane: of cameras in this world those of 11 bits are none for 32 bits.
  Cutoff cutoff;
  const Camera camera = ahead(12, 24, 24, 14);
  REQUIRE(cutoff.set(camera, Q16::saturate(1)) == Status::kOk);
  Picture picture(camera, PixelFormat::kGray8);
  CHECK(render_band_cut(tree, camera, {}, cutoff, NodeColors(), picture.band, nullptr,
                        {UINT32_MAX, Width::k32}) == Status::kBadArgument);
  CHECK(picture.untouched());
}

TEST_CASE("picture edges: a level to cut that is below the one set -> the higher one stays") {
  Cutoff cutoff;
  REQUIRE(cutoff.set_level(3) == Status::kOk);
  CHECK(cutoff.level() == 3);
  for (const int level : {2, 0, 3}) {
    REQUIRE(cutoff.set_level(level) == Status::kOk);
    CHECK(cutoff.level() == 3);
  }
  for (const int level : {-1, kMaxLevel + 1, INT32_MIN, INT32_MAX}) {
    CHECK(cutoff.set_level(level) == Status::kOutOfRange);
    CHECK(cutoff.level() == 3);
  }
  REQUIRE(cutoff.set_level(kMaxLevel) == Status::kOk);
  CHECK(cutoff.level() == kMaxLevel);
}

// The root says that it has eight children, of which there is one; the others lead behind the nodes.
TEST_CASE("picture edges: a cut node that a damaged tree does not have -> in the default colour") {
  OwnedPool pool(2);
  REQUIRE(pool.octree.insert({0, 0, 0}, 0) == Status::kOk);
  REQUIRE(pool.octree.insert({1, 0, 0}, 1) == Status::kOk);
  HeapBytes bytes = compact_of(pool.octree);
  bytes.span()[kCompactHeaderBytes] = 0xFF;
  for (int axis = 0; axis < 3; ++axis) {
    bytes.span()[34 + 2 * static_cast<std::size_t>(axis)] = 4;  // and the whole world is said to be its box
  }
  repair_checksum(bytes.span());
  const CompactTree tree = open_or_throw(bytes);
  REQUIRE(tree.node_count() == 2);
  constexpr Rgb8 kPalette[] = {{255, 0, 0}, {255, 0, 0}};
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = Span<const Rgb8>(kPalette);
  shading.default_color = {0, 0, 255};
  shading.background = {0, 255, 0};
  for (std::uint16_t& light : shading.face_light) {
    light = 256;
  }
  // 2 bytes a node, as if the tree were sound.
  OwnedPool sound(2);
  REQUIRE(sound.octree.insert({0, 0, 0}, 0) == Status::kOk);
  REQUIRE(sound.octree.insert({1, 0, 0}, 1) == Status::kOk);
  const HeapBytes sound_bytes = compact_of(sound.octree);
  const CompactTree sound_tree = open_or_throw(sound_bytes);
  std::vector<std::uint8_t> table(node_colors_bytes(sound_tree));
  NodeColors colors;
  REQUIRE(NodeColors::make(sound_tree, shading.palette, shading.default_color, {table.data(), table.size()},
                           &colors) == Status::kOk);
  Cutoff cutoff;
  REQUIRE(cutoff.set_level(1) == Status::kOk);
  const Camera camera = ahead(2);
  Picture picture(camera, PixelFormat::kRgb888);
  REQUIRE(render_band_cut(tree, camera, shading, cutoff, colors, picture.band) == Status::kOk);
  // The world fills the middle third: below on the left the first octant, all others of the default colour.
  const auto pixel = [&](int x, int y) {
    const std::size_t at = 3 * static_cast<std::size_t>(24 * y + x);
    return Rgb8{picture.bytes[at], picture.bytes[at + 1], picture.bytes[at + 2]};
  };
  const auto near = [](Rgb8 a, Rgb8 b) {
    return std::abs(a.r - b.r) < 12 && std::abs(a.g - b.g) < 12 && std::abs(a.b - b.b) < 12;
  };
  CHECK(near(pixel(10, 13), {255, 0, 0}));
  CHECK(near(pixel(13, 13), {0, 0, 255}));
  CHECK(near(pixel(10, 10), {0, 0, 255}));
  CHECK(near(pixel(13, 10), {0, 0, 255}));
  CHECK(near(pixel(1, 1), {0, 255, 0}));
}

// ---- any-time frames

TEST_CASE(
    "picture edges: an any-time frame in which all looks alike -> no range of greys; of two colours -> one") {
  OwnedPool pool(3);
  REQUIRE(pool.octree.insert_block({0, 0, 0}, 2, 0) == Status::kOk);
  const HeapBytes bytes = compact_of(pool.octree);
  const CompactTree tree = open_or_throw(bytes);
  const Camera camera = ahead(3);
  struct Row {
    PixelFormat format;
    Rgb8 color;  // beside a background of 100, 100, 100
    int range;
  };
  // A paper's pixel may be black or white; two bits have greys 85 apart, 100 and 101 lie between two, 60 and
  // 200 among four.
  for (const Row& row :
       {Row{PixelFormat::kPaper3, {100, 100, 100}, 0}, Row{PixelFormat::kPaper3, {100, 100, 101}, 255},
        Row{PixelFormat::kPaper7, {100, 100, 100}, 0}, Row{PixelFormat::kPaper7, {101, 100, 100}, 255},
        Row{PixelFormat::kGray2, {100, 100, 100}, 0}, Row{PixelFormat::kGray2, {101, 101, 101}, 85},
        Row{PixelFormat::kGray2, {200, 200, 200}, 170}, Row{PixelFormat::kGray8, {100, 100, 100}, 0},
        Row{PixelFormat::kGray8, {103, 103, 103}, 3}}) {
    Shading shading;
    shading.mode = ShadeMode::kColor;
    shading.palette = {&row.color, 1};
    shading.default_color = row.color;
    shading.background = {100, 100, 100};
    for (std::uint16_t& light : shading.face_light) {
      light = 256;
    }
    std::vector<std::uint8_t> memory(anytime_bytes(24, 24, row.format));
    AnytimeFrame frame;
    REQUIRE(AnytimeFrame::make(tree, camera, shading, row.format, {memory.data(), memory.size()}, &frame) ==
            Status::kOk);
    CAPTURE(static_cast<int>(row.format));
    CAPTURE(row.range);
    CHECK(frame.gray_range() == row.range);
    CHECK((frame.mean_error_bound_q8() == 0) == (row.range == 0));
    // And rows: none, some, more than there are.
    CHECK(frame.band(0, -1).rows == 0);
    CHECK(frame.band(0, -1).pixels.size == 0);
    CHECK(frame.band(0, INT32_MIN).rows == 0);
    CHECK(frame.band(8, 8).rows == 8);
    CHECK(frame.band(8, 800).rows == 16);
    CHECK(frame.band(-5, 8).first_row == 0);
    CHECK(frame.band(1000, 8).rows == 0);
  }
}

// A tree of two nodes lets a ray visit two. In damaged bytes each of the root's eight children is the other
// node, which has voxels where no ray of the picture's middle passes: it is read four times and more.
TEST_CASE(
    "picture edges: an any-time frame of a tree whose nodes are met again and again -> told, and it ends") {
  OwnedPool pool(2);
  REQUIRE(pool.octree.insert({0, 0, 0}, 0) == Status::kOk);
  HeapBytes bytes = compact_of(pool.octree);
  std::uint8_t* const base = bytes.span().data;
  base[kCompactHeaderBytes] = 0x05;  // children at (0,0,0) and (0,1,0): numbers 1 and 2, of which 2 is none
  for (int axis = 0; axis < 3; ++axis) {
    base[34 + 2 * axis] = 4;
  }
  // A directory that begins one too early: the root's children are then nodes 0 and 1.
  std::uint8_t* const ranks = base + kCompactHeaderBytes + 4;
  REQUIRE(ranks[0] == 0);
  for (int i = 0; i < 4; ++i) {
    ranks[i] = 0xFF;
  }
  repair_checksum(bytes.span());
  const CompactTree tree = open_or_throw(bytes);
  REQUIRE(tree.node_count() == 2);
  REQUIRE(tree.first_child(0) == 0);
  const Camera camera = ahead(2);
  std::vector<std::uint8_t> memory(anytime_bytes(24, 24, PixelFormat::kGray8));
  AnytimeFrame frame;
  REQUIRE(AnytimeFrame::make(tree, camera, {}, PixelFormat::kGray8, {memory.data(), memory.size()}, &frame) ==
          Status::kOk);
  CHECK(frame.reserve_visits() == 2);
  REQUIRE(frame.refine(tree, UINT32_MAX) == Status::kOk);
  CHECK(frame.done());
  CHECK(frame.counts().step_limited > 0);
  // As many as the core finds with that limit.
  std::uint64_t limited = 0;
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 24; ++x) {
      Hit hit;
      REQUIRE(closest_hit(tree, camera.ray(x, y), &hit, {2, Width::kAuto}) == Status::kOk);
      limited += hit.kind == HitKind::kStepLimit ? 1 : 0;
    }
  }
  CHECK(frame.counts().step_limited == limited);
}

// ---- samples

}  // namespace
}  // namespace thimble::tests::picture_edges
