// Pictures at the ends of what their functions take: cameras of another world, maps of another tree, cut-offs
// in damaged trees, frames that show one colour only. Each answer is worked out by hand.
#include <doctest/doctest.h>

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
  std::vector<std::uint8_t> bytes;
  Band band;
};

// ---- by bricks

TEST_CASE("picture edges: bytes of bands without columns -> 0; a product beyond size_t -> SIZE_MAX") {
  CHECK(band_bytes(PixelFormat::kRgb888, 0, 5) == 0);
  CHECK(band_bytes(PixelFormat::kRgb888, 1 << 20, 1 << 20) ==
        (sizeof(std::size_t) == 4 ? SIZE_MAX : std::size_t{3} << 20 << 20));
  static_assert(render_bytes() >= sizeof(Camera) + sizeof(Shading));
}

// A world of 64 from one voxel and from all of it: an eye's distance from the farthest side of the world is below
// 2^(31 - bits), that from the farthest side of what is solid 32 voxels less or nearer.
TEST_CASE("picture edges: eyes from farther and farther away -> fast frames up to the last 1/256 voxel") {
  OwnedPool corner(6);
  REQUIRE(corner.octree.insert({0, 0, 0}, 1) == Status::kOk);
  const MappedTree one(compact_of(corner.octree));
  REQUIRE(corner.octree.insert({63, 63, 63}, 1) == Status::kOk);
  const MappedTree all(compact_of(corner.octree));
  const auto is_fast = [](const MappedTree& bricks, int axis, std::int32_t raw, int bits) {
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
    for (const MappedTree* bricks : {&all, &one}) {
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

// ---- with a cut-off

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

}  // namespace
}  // namespace thimble::tests::picture_edges
