// Dark edges between faces of one grey (Effect::kEdges).
#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/lit_world.h"
#include "thimble/trace/ray.h"

namespace thimble::testing {
namespace {

constexpr EffectSet kLit = Effect::kDirectLight;

struct EdgePictures {
  std::vector<Rgb8> plain;
  std::vector<Rgb8> edged;
  int dark = 0;  // pixels that differ
};

// Draws with and without. A pixel either stays as it is or keeps 48 of 256 parts.
EdgePictures draw_both(const LitWorld& world, EffectSet effects = kLit) {
  EdgePictures pictures{world.draw(effects), world.draw(effects | Effect::kEdges)};
  for (std::size_t i = 0; i < pictures.plain.size(); ++i) {
    const Rgb8 is = pictures.edged[i];
    const Rgb8 was = pictures.plain[i];
    if (is == was) {
      continue;
    }
    ++pictures.dark;
    REQUIRE(std::abs(is.r - was.r * 48 / 256) <= 1);
    REQUIRE(std::abs(is.g - was.g * 48 / 256) <= 1);
    REQUIRE(std::abs(is.b - was.b * 48 / 256) <= 1);
  }
  return pictures;
}

// A block before a wall; both show the camera a face to -y.
void put_block(LitWorld* world, int block_albedo, int wall_albedo) {
  world->box({8, 10, 4}, {24, 14, 20}, 1);
  world->box({0, 26, 0}, {32, 30, 32}, 2);
  const auto gray = [](int value) {
    const auto one = static_cast<std::uint8_t>(value);
    return Rgb8{one, one, one};
  };
  world->surfaces[1].albedo = gray(block_albedo);
  world->surfaces[2].albedo = gray(wall_albedo);
  world->lights = {sun({0, -1, 0}, 180)};
  world->finish();
  world->look({16 * 256, -34 * 256, 12 * 256}, {16 * 256, 10 * 256, 12 * 256}, 40, 96, 72);
}

// The y of the plane of the face that a pixel shows, in voxels; -1 for none.
int plane_of(const LitWorld& world, int x, int y) {
  Hit hit;
  REQUIRE(closest_hit(world.tree, world.camera.ray(x, y), &hit) == Status::kOk);
  return hit.kind == HitKind::kHit && hit.axis == 1 ? hit.voxel.y : -1;
}

}  // namespace

TEST_CASE("edges: a block before a wall of its grey -> its outline, where the next pixel shows the wall") {
  LitWorld world;
  put_block(&world, 160, 160);
  const EdgePictures pictures = draw_both(world);
  const int width = world.camera.width_px();
  int outlines = 0;
  for (int y = 0; y + 1 < world.camera.height_px(); ++y) {
    for (int x = 0; x + 1 < width; ++x) {
      const auto at = static_cast<std::size_t>(y * width + x);
      const int here = plane_of(world, x, y);
      const bool changes = here != plane_of(world, x + 1, y) || here != plane_of(world, x, y + 1);
      const bool is_dark = !(pictures.edged[at] == pictures.plain[at]);
      // A step of the camera is rounded: next to an edge it may be the pixel beside.
      const bool is_near = changes || (x > 0 && plane_of(world, x - 1, y) != here) ||
                           (y > 0 && plane_of(world, x, y - 1) != here);
      CAPTURE(x);
      CAPTURE(y);
      CHECK((is_near || !is_dark));
      const bool both = here >= 0 && plane_of(world, x + 1, y) >= 0 && plane_of(world, x, y + 1) >= 0;
      outlines += changes && both ? 1 : 0;
    }
  }
  // As many as there are changes, but for those of rounded steps.
  CHECK(outlines > 100);
  CHECK(std::abs(pictures.dark - outlines) < outlines / 4);
}

TEST_CASE(
    "edges: faces of other greys, one face, steps of a voxel from afar, what the camera is in -> none") {
  LitWorld other;
  put_block(&other, 60, 200);
  CHECK(draw_both(other).dark == 0);

  LitWorld plane;
  plane.box({0, 0, 0}, {32, 32, 2}, 1);
  plane.lights = {sun({0, 0, 1})};
  plane.finish();
  plane.look({16 * 256, -10 * 256, 40 * 256}, {16 * 256, 16 * 256, 2 * 256}, 50);
  CHECK(draw_both(plane).dark == 0);

  LitWorld stairs;
  for (int i = 0; i < 32; ++i) {
    stairs.box({0, i, 0}, {32, i + 1, i / 2 + 1}, 1);
  }
  stairs.lights = {sun({0, -1, 1})};  // treads and risers have one grey
  stairs.finish();
  stairs.scene.ambient_q8[0] = stairs.scene.ambient_q8[1] = stairs.scene.ambient_q8[2] = 0;
  stairs.look({16 * 256, -30 * 256, 40 * 256}, {16 * 256, 16 * 256, 8 * 256}, 35);
  CHECK(draw_both(stairs).dark == 0);

  LitWorld inside;
  inside.box({0, 0, 0}, {32, 32, 32}, 1);
  inside.finish();
  inside.look({16 * 256, 16 * 256, 16 * 256}, {16 * 256, 30 * 256, 18 * 256});
  CHECK(draw_both(inside).dark == 0);
}

TEST_CASE("edges: two faces of one grey that meet -> the corner between them, in either projection") {
  LitWorld world;
  world.box({8, 8, 0}, {24, 24, 24}, 1);
  world.surfaces[1].albedo = {180, 180, 180};
  world.lights = {sun({-1, -1, 0}, 200)};
  world.finish();
  set_ambient(&world.scene, 0);
  world.look({-20 * 256, -20 * 256, 12 * 256}, {16 * 256, 16 * 256, 12 * 256}, 40);
  const int perspective = draw_both(world).dark;
  CHECK(perspective > 15);  // rows of the corner
  CHECK(perspective < 40);
  const Vec3Q8 eye = LitWorld::point({-20 * 256, -20 * 256, 12 * 256});
  OrthographicView view{eye, {1, 1, 0}, {}, Q14::saturate(40), 48, 36};
  REQUIRE(world.camera.set(view, world.tree.level()) == Status::kOk);
  const int parallel = draw_both(world).dark;
  CHECK(parallel > 15);
  CHECK(parallel < 40);
}

TEST_CASE(
    "edges: directions of so few bits that neighbours share a ray -> none, as no pixel sees beyond its own") {
  LitWorld world;
  put_block(&world, 160, 160);
  const Vec3Q8 eye = LitWorld::point({8 * 256, -34 * 256, 12 * 256});
  const PerspectiveView view{eye, {0, 1, 0}, {}, Q16::saturate(5), 96, 72, kMinDirectionBits};
  REQUIRE(world.camera.set(view, world.tree.level()) == Status::kOk);
  const Camera::Vec3Q32& step = world.camera.affine().step_x;
  for (int axis = 0; axis < 3; ++axis) {
    REQUIRE(Camera::rounded(step[axis]) == 0);
  }
  CHECK(plane_of(world, 0, 36) != plane_of(world, 95, 36));
  CHECK(draw_both(world).dark == 0);
}

TEST_CASE("edges: one ray or two of the camera's more a pixel that shows a face, none where they are off") {
  LitWorld world;
  put_block(&world, 160, 160);
  LitCounts with;
  LitCounts without;
  world.draw(kLit, &without);
  world.draw(kLit | Effect::kEdges, &with);
  const std::uint64_t pixels = 96 * 72;
  CHECK(without.rays[0] == pixels);
  CHECK(with.rays[0] > pixels + without.hits[0]);
  CHECK(with.rays[0] <= pixels + 2 * without.hits[0]);
}

TEST_CASE("edges: a face that lies behind another one -> an edge from four pixels' sizes apart") {
  // Parallel rays: a pixel is half a voxel wide, so four of them are two voxels.
  const auto dark = [](int behind) {
    LitWorld world;
    world.box({0, 12, 0}, {16, 30, 32}, 1);
    world.box({16, 12 + behind, 0}, {32, 30, 32}, 1);
    world.lights = {sun({0, -1, 0}, 180)};
    world.finish();
    OrthographicView view{LitWorld::point({16 * 256 + 70, -20 * 256, 16 * 256 + 70}),
                          {0, 16, 0},
                          {},
                          Q14::saturate(16),
                          32,
                          24};
    REQUIRE(world.camera.set(view, world.tree.level()) == Status::kOk);
    LitCounts counts;
    world.draw(kLit | Effect::kEdges, &counts);
    // A row has one edge, seen to the right: all other pixels look at the one below, too.
    CHECK(counts.rays[0] == (behind >= 2 ? 3U * 32 * 24 - 24 : 3U * 32 * 24));
    return draw_both(world).dark;
  };
  CHECK(dark(1) == 0);
  CHECK(dark(2) == 24);
  CHECK(dark(3) == 24);
}

TEST_CASE(
    "edges: directions of 8 bits, which change by 1 from pixel to pixel -> an edge from four such sizes "
    "apart") {
  const auto dark = [](int away) {
    LitWorld world;
    world.box({0, 12, 0}, {16, 30, 32}, 1);
    world.box({16, 13, 0}, {32, 30, 32}, 1);
    world.lights = {sun({0, -1, 0}, 180)};
    world.finish();
    REQUIRE(
        world.camera.set(PerspectiveView{LitWorld::point({16 * 256 + 70, (12 - away) * 256, 16 * 256 + 70}),
                                         {0, 16, 0},
                                         {},
                                         Q16::saturate(60),
                                         300,
                                         300,
                                         8},
                         world.tree.level()) == Status::kOk);
    return draw_both(world).dark;
  };
  // A pixel is 1/255 of the way.
  CHECK(dark(40) > 0);
  CHECK(dark(60) > 0);
  CHECK(dark(70) == 0);
}

TEST_CASE("edges: greys a tenth of white apart -> none, nearer ones -> an edge; green counts most") {
  const auto dark = [](const Rgb8& one, const Rgb8& other) {
    LitWorld world;
    put_block(&world, 0, 0);
    world.surfaces[1].albedo = one;
    world.surfaces[2].albedo = other;
    world.lights = {sun({0, -1, 0}, 256)};
    world.finish();
    set_ambient(&world.scene, 0);
    return draw_both(world).dark;
  };
  CHECK(dark({100, 100, 100}, {124, 124, 124}) > 100);
  CHECK(dark({100, 100, 100}, {129, 129, 129}) == 0);
  CHECK(dark({100, 100, 100}, {100, 139, 100}) > 100);  // 0.59 of it
  CHECK(dark({100, 100, 100}, {100, 148, 100}) == 0);
  CHECK(dark({100, 100, 100}, {181, 100, 100}) > 100);  // 0.30
  CHECK(dark({100, 100, 100}, {191, 100, 100}) == 0);
}

TEST_CASE(
    "edges: a face that extends to one side alone -> an edge; a pixel of no size -> none; glass -> none") {
  // A corner in the middle of a face 3 voxels wide, whose other side is empty.
  LitWorld narrow;
  narrow.box({8, 8, 0}, {11, 24, 24}, 1);
  narrow.surfaces[1].albedo = {180, 180, 180};
  narrow.lights = {sun({-1, -1, 0}, 200)};
  narrow.finish();
  set_ambient(&narrow.scene, 0);
  narrow.look({-20 * 256, -20 * 256, 12 * 256}, {8 * 256, 8 * 256, 12 * 256}, 60);
  CHECK(draw_both(narrow).dark > 10);  // a pixel is 1.3 voxels, so 2 are wide enough
  LitWorld mirrored;
  mirrored.box({21, 8, 0}, {24, 24, 24}, 1);
  mirrored.surfaces[1].albedo = {180, 180, 180};
  mirrored.lights = {sun({1, -1, 0}, 200)};
  mirrored.finish();
  set_ambient(&mirrored.scene, 0);
  mirrored.look({52 * 256, -20 * 256, 12 * 256}, {24 * 256, 8 * 256, 12 * 256}, 60);
  CHECK(draw_both(mirrored).dark > 10);

  // So near that a pixel is less than 1/256 voxel.
  LitWorld tiny;
  put_block(&tiny, 160, 160);
  tiny.look({16 * 256, 10 * 256 - 3, 12 * 256}, {16 * 256, 12 * 256, 12 * 256}, 40, 96, 72);
  CHECK(draw_both(tiny).dark == 0);

  LitWorld clear;
  put_block(&clear, 160, 160);
  clear.surfaces[1] = surface(SurfaceKind::kGlass, {160, 160, 160});
  CHECK(draw_both(clear).dark > 100);  // without the effect glass is a face like any
  CHECK(draw_both(clear, kLit | Effect::kGlass).dark == 0);
}

}  // namespace thimble::testing
