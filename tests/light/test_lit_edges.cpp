// Lit pictures where what an effect counts on is not there: lamps without reach or out of it, metal that
// mirrors nothing, occlusion of no rays, glass in glass, water's edges. What each pixel must show is known
// without tracing a ray: what takes no light away shows a background of one colour everywhere, whichever way
// it bends.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/lit_world.h"
#include "thimble/light/host/optics.h"
#include "thimble/light/host/slope.h"
#include "thimble/light/render.h"
#include "thimble/light/scene.h"
#include "thimble/light/water.h"

namespace thimble::testing::lit_edges {
namespace {

constexpr Rgb8 kGround{200, 200, 200};

// Whether every pixel is the colour, within `slack` of each channel.
int unlike(const std::vector<Rgb8>& picture, const Rgb8& color, int slack) {
  int count = 0;
  for (const Rgb8& pixel : picture) {
    count += std::abs(pixel.r - color.r) > slack || std::abs(pixel.g - color.g) > slack ||
                     std::abs(pixel.b - color.b) > slack
                 ? 1
                 : 0;
  }
  return count;
}

// A slab whose upper side fills the picture.
struct Slab : LitWorld {
  explicit Slab(int level = 5) : LitWorld(level) {
    const std::int32_t side = 1 << level;
    box({0, 0, 0}, {side, side, 4}, 1);
    surfaces[1] = surface(SurfaceKind::kDiffuse, kGround);
    set_ambient(&scene, 128);
  }
  void look_down(int level = 5) {
    finish();
    const std::int32_t middle = 128 << level;
    look({middle, middle, 256 * 12}, {middle, middle + 1, 0}, 40);
  }
};

// ---- lights

TEST_CASE("lit edges: a lamp of no reach, or too far away for its reach -> as if there were none") {
  for (const EffectSet more : {Effect::kNone, Effect::kSmoothNormals, Effect::kShadows}) {
    const EffectSet effects = Effect::kDirectLight | more;
    for (const std::int32_t reach : {0, 1}) {
      Slab dark(9);
      dark.look_down(9);
      Slab lamps(9);
      // 256 voxels above and more, a lamp of reach 1 leaves less than 1 of 65536.
      lamps.lights = {lamp({256 << 8, 256 << 8, reach == 0 ? 12 << 8 : 300 << 8}, 65535, reach)};
      lamps.look_down(9);
      CHECK(lamps.draw(effects) == dark.draw(effects));
      // Near enough, it lights.
      lamps.lights = {lamp({256 << 8, 256 << 8, 12 << 8}, 256, 1)};
      lamps.finish();
      CHECK(lamps.draw(effects) != dark.draw(effects));
    }
  }
}

// The middle pixel of a picture of an odd size looks straight down, and meets the slab at a corner of four
// voxels.
TEST_CASE(
    "lit edges: a lamp in the plane of a face, in its very middle -> the face stays dark; above it, bright") {
  Slab slab;
  slab.finish();
  slab.look_straight_down({16 * 256, 16 * 256, 12 * 256}, 9 << 14, 9, 9);
  const std::vector<Rgb8> dark = slab.draw(Effect::kDirectLight);
  CHECK(unlike(dark, dark[0], 0) == 0);
  slab.lights = {lamp({16 << 8, 16 << 8, 4 << 8}, 65535, 200)};
  slab.finish();
  CHECK(slab.draw(Effect::kDirectLight) == dark);
  slab.lights = {lamp({16 << 8, 16 << 8, 5 << 8}, 65535, 200)};
  slab.finish();
  CHECK(unlike(slab.draw(Effect::kDirectLight), dark[0], 0) == 81);
}

// A staircase of 45 degrees has bent normals.
TEST_CASE("lit edges: lamps over a slope, one out of reach, one of no reach -> the slope's own light") {
  for (const std::int32_t reach : {0, 1}) {
    std::vector<Rgb8> pictures[3];
    for (int lit = 0; lit < 3; ++lit) {
      LitWorld world(9);
      for (std::int32_t x = 0; x < 32; ++x) {
        world.box({240 + x, 230, 0}, {241 + x, 290, 200 + x}, 1);
      }
      world.surfaces[1] = surface(SurfaceKind::kDiffuse, kGround);
      set_ambient(&world.scene, 128);
      if (lit != 0) {
        const std::int32_t high = lit == 1 && reach == 1 ? 500 : 240;
        world.lights = {lamp({256 << 8, 256 << 8, high << 8}, 65535, lit == 1 ? reach : 60)};
      }
      world.finish();
      world.look({256 << 8, 256 << 8, 300 << 8}, {256 << 8, (256 << 8) + 1, 210 << 8}, 12);
      pictures[lit] = world.draw(Effect::kDirectLight | Effect::kSmoothNormals);
    }
    CHECK(pictures[1] == pictures[0]);
    CHECK(pictures[2] != pictures[0]);
  }
}

// Rays leave a slope 3/2 of a voxel above it, along its normal: a lamp in that very place has no direction.
TEST_CASE(
    "lit edges: a lamp where the rays of a slope begin -> as dark as without it; a hair beside it, bright") {
  LitWorld world;
  for (std::int32_t x = 0; x < 24; ++x) {
    world.box({4 + x, 2, 0}, {5 + x, 30, 3 + x / 2}, 1);
  }
  world.surfaces[1] = surface(SurfaceKind::kDiffuse, kGround);
  set_ambient(&world.scene, 100);
  world.finish();
  world.look_straight_down({16 * 256 + 128, 16 * 256 + 128, 30 * 256}, 1 << 14, 1, 1);
  const Vec3Q8 spot = LitWorld::point({16 * 256 + 128, 16 * 256 + 128, 9 * 256});
  std::uint32_t visits = 0;
  const Vec3i normal = lit::surface_normal(world.tree, lit::Body{world.scene.surfaces, Effect::kNone, 0},
                                           spot, Face{2, false}, &visits);
  REQUIRE(normal.z != kUnitQ14);
  const Vec3i start{spot.x.raw + normal.x * 384 / kUnitQ14, spot.y.raw + normal.y * 384 / kUnitQ14,
                    spot.z.raw + normal.z * 384 / kUnitQ14};
  constexpr EffectSet kSmooth = Effect::kDirectLight | Effect::kSmoothNormals;
  const std::vector<Rgb8> dark = world.draw(kSmooth);
  world.lights = {lamp(start, 300, 50)};
  world.finish();
  CHECK(world.draw(kSmooth) == dark);
  world.lights = {lamp({start.x, start.y, start.z + 1}, 300, 50)};
  world.finish();
  CHECK(world.draw(kSmooth)[0].r > dark[0].r + 50);
}

// ---- occlusion

TEST_CASE("lit edges: occlusion of no rays or of no reach -> the picture without it, flat or on a slope") {
  for (const EffectSet smooth : {Effect::kNone, Effect::kSmoothNormals}) {
    LitWorld world;
    for (std::int32_t x = 0; x < 16; ++x) {
      world.box({8 + x, 4, 0}, {9 + x, 28, 4 + x / 2}, 1);
    }
    world.box({0, 0, 0}, {32, 32, 3}, 1);
    world.surfaces[1] = surface(SurfaceKind::kDiffuse, kGround);
    world.finish();
    world.look({16 << 8, -4 << 8, 24 << 8}, {16 << 8, 16 << 8, 5 << 8});
    const EffectSet without = Effect::kDirectLight | smooth;
    const std::vector<Rgb8> open = world.draw(without);
    for (const int rays : {0, 4}) {
      for (const int reach : {0, 8}) {
        world.scene.occlusion.rays = static_cast<std::uint8_t>(rays);
        world.scene.occlusion.reach = static_cast<std::uint16_t>(reach);
        LitCounts counts;
        const bool alike = world.draw(without | Effect::kAmbientOcclusion, &counts) == open;
        CAPTURE(smooth);
        CAPTURE(reach);
        CHECK(alike == (rays == 0 || reach == 0));
        CHECK((counts.rays[static_cast<int>(LitRayKind::kOcclusion)] == 0) == (rays == 0 || reach == 0));
      }
    }
  }
}

// ---- metal

TEST_CASE("lit edges: metal that mirrors nothing -> as a diffuse surface of its colour, and no ray more") {
  for (const EffectSet smooth : {Effect::kNone, Effect::kSmoothNormals}) {
    std::vector<Rgb8> pictures[2];
    for (int metal = 0; metal < 2; ++metal) {
      LitWorld world;
      for (std::int32_t x = 0; x < 16; ++x) {
        world.box({8 + x, 4, 0}, {9 + x, 28, 4 + x}, 1);
      }
      world.surfaces[1] = surface(metal == 0 ? SurfaceKind::kDiffuse : SurfaceKind::kMetal, {150, 120, 90});
      world.surfaces[1].mirror = 0;
      world.finish();
      world.look({16 << 8, -4 << 8, 34 << 8}, {16 << 8, 16 << 8, 8 << 8});
      LitCounts counts;
      pictures[metal] = world.draw(Effect::kMirror | smooth, &counts);
      CHECK(counts.rays[static_cast<int>(LitRayKind::kMirrorRay)] == 0);
    }
    CHECK(pictures[0] == pictures[1]);
  }
}

TEST_CASE("lit edges: black metal seen straight on, or hardly a mirror -> what it mirrors is not followed") {
  // Schlick: a metal mirrors its albedo straight on, so a black one nothing.
  for (const bool black : {true, false}) {
    Slab slab;
    slab.surfaces[1] = surface(SurfaceKind::kMetal, black ? Rgb8{0, 0, 0} : Rgb8{255, 255, 255});
    slab.finish();
    slab.look_straight_down({16 * 256, 16 * 256, 12 * 256}, 8 << 14, 16, 12);
    slab.shading.background = {90, 160, 230};
    LitCounts counts;
    const std::vector<Rgb8> picture = slab.draw(Effect::kMirror, &counts);
    CHECK(counts.rays[static_cast<int>(LitRayKind::kMirrorRay)] == (black ? 0 : 16 * 12));
    CHECK(unlike(picture, black ? Rgb8{0, 0, 0} : Rgb8{90, 160, 230}, 1) == 0);
  }
}

// Facets bend a ray by 20 / 2^14 up or down for each step of roughness; two of the four go down. Bent back from the
// face it is sent on, bent into the face's own plane not.
TEST_CASE("lit edges: rough metal that mirrors exactly along its face -> what goes along it is lost") {
  for (const int roughness : {99, 100, 101}) {
    CAPTURE(roughness);
    Slab slab;
    slab.surfaces[1] = surface(SurfaceKind::kMetal, {255, 255, 255});
    slab.surfaces[1].roughness = static_cast<std::uint8_t>(roughness);
    slab.finish();
    OrthographicView view;
    view.eye = {Q8::saturate(0), Q8::saturate(16), Q8::saturate(6)};
    view.forward = {10000, 0, -1230};
    view.span = Q14::saturate(1);
    view.width_px = 8;
    view.height_px = 6;
    view.direction_bits = 15;
    REQUIRE(slab.camera.set(view, 5) == Status::kOk);
    REQUIRE(unit_q14(slab.camera.ray(0, 0).direction).z == -20 * 100);
    slab.shading.background = {200, 120, 40};
    LitCounts counts;
    const std::vector<Rgb8> picture = slab.draw(Effect::kMirror, &counts);
    const int sent = roughness == 100 ? 2 : 4;
    CHECK(counts.rays[static_cast<int>(LitRayKind::kMirrorRay)] == static_cast<unsigned>(sent) * 8 * 6);
    const auto share = [sent](int channel) { return static_cast<std::uint8_t>(channel * sent / 4); };
    CHECK(unlike(picture, {share(200), share(120), share(40)}, 1) == 0);
  }
}

TEST_CASE("lit edges: an eye inside metal -> its own colour everywhere, as inside anything solid") {
  std::vector<Rgb8> pictures[2];
  for (int metal = 0; metal < 2; ++metal) {
    LitWorld world;
    world.box({0, 0, 0}, {32, 32, 32}, 1);
    world.surfaces[1] = surface(metal == 0 ? SurfaceKind::kDiffuse : SurfaceKind::kMetal, {150, 120, 90});
    world.finish();
    world.look({16 * 256 + 77, 16 * 256 + 55, 16 * 256 + 33}, {0, 0, 0});
    LitCounts counts;
    pictures[metal] = world.draw(Effect::kMirror, &counts);
    CHECK(counts.rays[static_cast<int>(LitRayKind::kMirrorRay)] == 0);
  }
  CHECK(pictures[0] == pictures[1]);
}

// ---- glass that takes nothing away: all of the background comes through

// A ball of glass 1 within one of glass 2, of other indices, both clear, or cloud of no density within, which bends nothing:
// glass to cloud bends as glass to air.
TEST_CASE(
    "lit edges: clear glass round clear glass or a cloud of no density, flat or smooth -> the background, "
    "whichever "
    "way it bends") {
  struct Row {
    int outer;
    int inner;  // 0: a cloud
  };
  for (const Row& row : {Row{6144, 4800}, Row{4800, 6144}, Row{6144, 6144}, Row{9000, 4096}, Row{5325, 0}}) {
    for (const EffectSet smooth : {Effect::kNone, Effect::kSmoothNormals}) {
      LitWorld world;
      for (std::int32_t i = 0; i < 32 * 32 * 32; ++i) {
        const Vec3i at{i & 31, i >> 5 & 31, i >> 10};
        const std::int32_t square =
            (at.x - 16) * (at.x - 16) + (at.y - 16) * (at.y - 16) + (at.z - 16) * (at.z - 16);
        if (square < 130) {
          world.voxel(at, square < 40 ? 2 : 1);
        }
      }
      for (const std::size_t i : {1U, 2U}) {
        const int index = i == 1 ? row.outer : row.inner;
        world.surfaces[i] = surface(index == 0 ? SurfaceKind::kMedia : SurfaceKind::kGlass, {255, 255, 255});
        world.surfaces[i].index_q12 = static_cast<std::uint16_t>(index);
        world.surfaces[i].density_q8 = 0;
      }
      world.scene.bounces = kMaxBounces;
      world.shading.background = kGround;
      world.finish();
      world.look({-8 << 8, 10 << 8, 22 << 8}, {16 << 8, 16 << 8, 16 << 8});
      LitCounts counts;
      const std::vector<Rgb8> picture = world.draw(Effect::kGlass | Effect::kMedia | smooth, &counts);
      CAPTURE(row.inner);
      CAPTURE(smooth);
      CHECK(counts.rays[static_cast<int>(LitRayKind::kGlassRay)] > 1000);
      // Each of the rays that a pixel sends may lose what is too faint to follow.
      CHECK(unlike(picture, kGround, 12) == 0);
    }
  }
}

// The ray comes into the cloud 0.16 / 256 voxel from the world's side and goes towards it: it leaves the world before it
// leaves the voxel. Where there is water it begins anew on the face, rounded down: on the world's side.
TEST_CASE("lit edges: a cloud at the world's side, left by less than a unit of place -> the background") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 10}, 1);
  world.voxel({0, 16, 10}, 2);
  world.surfaces[1] = surface(SurfaceKind::kDiffuse, {255, 0, 0});
  world.surfaces[2] = surface(SurfaceKind::kMedia, {255, 255, 255});
  world.surfaces[2].density_q8 = 0;
  set_ambient(&world.scene, 256);
  world.finish();
  world.shading.background = {90, 160, 230};
  REQUIRE(world.camera.set(PerspectiveView{LitWorld::point({15, 16 * 256 + 128, 30 * 256}),
                                           {-100, 0, -32767},
                                           {},
                                           Q16::saturate(1),
                                           1,
                                           1,
                                           15},
                           5) == Status::kOk);
  REQUIRE(world.camera.ray(0, 0).direction == Vec3i{-100, 0, -32767});
  for (const EffectSet water : {Effect::kNone, Effect::kWater}) {
    CAPTURE(water);
    LitCounts counts;
    CHECK(unlike(world.draw(Effect::kMedia | water, &counts), world.shading.background, 0) == 0);
    CHECK(counts.hits[0] == 1);
    // Into the cloud, and out of it where it is still in the world.
    CHECK(counts.rays[static_cast<int>(LitRayKind::kMediaRay)] == (water == Effect::kNone ? 2 : 1));
  }
}

// ---- water that takes nothing away

// Rays that come to the surface within 1/256 of a voxel of the pond's lower edges are sent on from the edge
// itself.
TEST_CASE(
    "lit edges: clear water seen at its very edges and corners, 1/256 voxel by 1/256 -> the background") {
  for (const bool moving : {false, true}) {
    std::vector<std::int32_t> heights(4 * 4, 2 * 65536);
    heights[5] = -1;  // a dry column in the middle
    for (int corner = 0; corner < 4; ++corner) {
      LitWorld world;
      world.voxel({0, 0, 0}, 1);
      world.scene.has_water = true;
      world.scene.water = still_water({10, 10, 4}, 4, 4, 2 * 256);
      if (moving) {
        world.scene.water.heights_q16 = heights.data();
        world.scene.water.has_blocked = true;
      }
      world.scene.water_material = surface(SurfaceKind::kGlass, {255, 255, 255});
      world.scene.water_material.index_q12 = kWaterIndexQ12;
      world.scene.water_material.density_q8 = 0;
      world.shading.background = kGround;
      world.scene.bounces = 4;
      world.finish();
      const int x = corner % 2;
      const int y = corner / 2;
      for (const Vec3i& way : {Vec3i{x != 0 ? 5 : -5, y != 0 ? 3 : -3, -7}, Vec3i{x != 0 ? 5 : -5, 0, -7},
                               Vec3i{0, y != 0 ? 9 : -9, -4}, Vec3i{x != 0 ? -5 : 5, y != 0 ? -3 : 3, -7}}) {
        const Vec3i edge{moving && corner == 0 ? 11 * 256 : (10 + 4 * x) * 256,
                         moving && corner == 0 ? 11 * 256 : (10 + 4 * y) * 256, 6 * 256};
        for (std::int32_t shift = 0; shift < 8; ++shift) {
          OrthographicView view;
          view.eye = LitWorld::point(
              {edge.x - 300 * way.x + shift, edge.y - 300 * way.y + shift, edge.z - 300 * way.z});
          view.forward = way;
          view.span = Q14::from_raw(1 << 14);  // pixels of 8/256 voxel
          view.width_px = 32;
          view.height_px = 32;
          REQUIRE(world.camera.set(view, 5) == Status::kOk);
          LitCounts counts;
          CHECK(unlike(world.draw(Effect::kWater, &counts), kGround, 12) == 0);
          CHECK(counts.rays[static_cast<int>(LitRayKind::kWaterRay)] > 0);
          CHECK(unlike(world.draw(Effect::kWater | Effect::kRipples), kGround, 12) == 0);
        }
      }
    }
  }
}

// A lamp under water lights what is under it by the way in the water alone; one above it by the way up to the
// surface.
TEST_CASE("lit edges: a floor under dark water -> each lamp is dimmed by its own way in the water") {
  // Light halves a voxel: half a voxel to a lamp in the water, and two to the surface for one above.
  const auto shade_of = [](std::int32_t lamp_z_q8, bool water, bool sunlit) {
    LitWorld world;
    world.box({0, 0, 0}, {32, 32, 4}, 1);
    world.surfaces[1] = surface(SurfaceKind::kDiffuse, {255, 255, 255});
    set_ambient(&world.scene, 0);
    world.lights = {sunlit ? sun({0, 0, 1}, 100)
                           : lamp({16 * 256 + 128, 16 * 256 + 128, lamp_z_q8}, 150, 60000)};
    world.scene.has_shadows = true;
    world.scene.has_water = water;
    world.scene.water = still_water({0, 0, 4}, 32, 32, 2 * 256);
    world.scene.water_material = surface(SurfaceKind::kGlass, {0, 0, 0});
    world.scene.water_material.index_q12 = kMinIndexQ12;
    world.scene.water_material.density_q8 = 256;
    world.finish();
    world.look_straight_down({16 * 256 + 128, 16 * 256 + 128, 4 * 256 + 64}, 1 << 10, 1, 1);
    return int{
        world.draw(Effect::kDirectLight | Effect::kShadows | (water ? Effect::kWater : Effect::kNone))[0].r};
  };
  const auto halved = [](int bright, double voxels) { return bright * std::exp2(-voxels); };
  // The eye's own way is a quarter of a voxel in the water.
  const int in_air = shade_of(4 * 256 + 128, false, false);
  CHECK(in_air > 100);
  CHECK(shade_of(4 * 256 + 128, true, false) == doctest::Approx(halved(in_air, 0.25 + 0.5)).epsilon(0.03));
  const int above = shade_of(10 * 256, false, false);
  CHECK(shade_of(10 * 256, true, false) == doctest::Approx(halved(above, 0.25 + 2)).epsilon(0.05));
  const int sunlit = shade_of(0, false, true);
  CHECK(shade_of(0, true, true) == doctest::Approx(halved(sunlit, 0.25 + 2)).epsilon(0.05));
}

// eta^2 (a^2 + b^2) is below 2^24 (a^2 + b^2 + c^2) by so little that a quarter of a unit is left along the
// axis.
TEST_CASE(
    "lit edges: light a hair short of total reflection -> it leaves along the face, and still through it") {
  struct Row {
    std::uint32_t eta;
    Vec3i unit;
    std::int64_t left;
  };
  for (const Row& row : {Row{4829, {3190, 13526, 8678}, 116344}, Row{4570, {1821, 14567, 7264}, 217816},
                         Row{4385, {104, 15305, 5850}, 1984431}}) {
    const std::int64_t across = std::int64_t{row.unit.x} * row.unit.x + std::int64_t{row.unit.y} * row.unit.y;
    const std::int64_t square = across + std::int64_t{row.unit.z} * row.unit.z;
    REQUIRE((square << 24) - std::int64_t{row.eta} * row.eta * across == row.left);
    for (int axis = 0; axis < 3; ++axis) {
      for (const int sign : {1, -1}) {
        Vec3i unit;
        unit[axis] = sign * row.unit.z;
        unit[axis == 2 ? 0 : axis + 1] = row.unit.x;
        unit[axis == 0 ? 2 : axis - 1] = -row.unit.y;
        Vec3i out{7, 7, 7};
        REQUIRE(refract(unit, axis, row.eta, &out));
        CHECK(out[axis] * sign >= 1);
        CHECK(out[axis] * sign <= 2);
        CHECK(std::abs(std::sqrt(double(out.x) * out.x + double(out.y) * out.y + double(out.z) * out.z) -
                       16384) < 66);
        Vec3i normal;
        normal[axis] = -sign * kUnitQ14;
        Vec3i bent{7, 7, 7};
        CHECK(refract(unit, normal, row.eta, &bent));
        CHECK(bent[axis] * sign >= 0);
        CHECK(bent[axis] * sign <= 2);
        Vec3i none{7, 7, 7};
        CHECK_FALSE(refract(unit, axis, row.eta + 1, &none));
        CHECK(none == Vec3i{7, 7, 7});
      }
    }
  }
}

// ---- water that is touched

TEST_CASE("lit edges: water touched outside its basin, by nothing, or beyond the limits -> as it was") {
  std::vector<std::uint8_t> bytes(water_bytes(12, 9));
  WaterConfig config;
  config.width = 12;
  config.depth = 9;
  config.rest_q8 = 500;
  config.greatest_q8 = 1000;
  Water water;
  REQUIRE(Water::make(config, {bytes.data(), bytes.size()}, &water) == Status::kOk);
  const std::uint32_t before = water.state_crc32();
  const auto unchanged = [&] {
    return water.state_crc32() == before && water.surface({0, 0, 0}).heights_q16 == nullptr;
  };
  // Within 2^13 voxels, but farther than a radius and a column from the basin: on each side.
  for (const Vec3i& at :
       {Vec3i{-900, 1000, 0}, Vec3i{12 * 256 + 900, 1000, 0}, Vec3i{1000, -900, 0},
        Vec3i{1000, 9 * 256 + 900, 0}, Vec3i{1 << 21, 1000, 0}, Vec3i{1000, -(1 << 21), 0}}) {
    CHECK(water.touch(at.x, at.y, 300, 200) == Status::kOk);
    CHECK(water.drop(at.x, at.y, 300, 5000, 5000) == Status::kOk);
    CHECK(unchanged());
  }
  CHECK(water.touch(1000, 1000, 300, 0) == Status::kOk);
  CHECK(water.drop(1000, 1000, 300, 0, 5000) == Status::kOk);
  CHECK(water.drop(1000, 1000, 300, 5000, 0) == Status::kOk);
  CHECK(unchanged());
  constexpr std::int32_t kFar = (1 << 21) + 1;
  constexpr std::int32_t kWide = (1 << 14) + 1;
  for (const Vec3i& at : {Vec3i{kFar, 0, 300}, Vec3i{-kFar, 0, 300}, Vec3i{0, kFar, 300},
                          Vec3i{0, -kFar, 300}, Vec3i{INT32_MIN, 0, 300}, Vec3i{0, INT32_MIN, 300},
                          Vec3i{0, 0, -1}, Vec3i{0, 0, kWide}, Vec3i{0, 0, INT32_MIN}}) {
    CHECK(water.touch(at.x, at.y, at.z, 200) == Status::kOutOfRange);
    CHECK(water.drop(at.x, at.y, at.z, 5000, 5000) == Status::kOutOfRange);
  }
  for (const std::int32_t depth : {kWide, -kWide, INT32_MIN, INT32_MAX}) {
    CHECK(water.touch(1000, 1000, 300, depth) == Status::kOutOfRange);
  }
  for (const std::int32_t mass : {-1, (1 << 20) + 1, INT32_MIN, INT32_MAX}) {
    CHECK(water.drop(1000, 1000, 300, mass, 5000) == Status::kOutOfRange);
  }
  for (const std::int32_t speed : {(1 << 16) + 1, -(1 << 16) - 1, INT32_MIN, INT32_MAX}) {
    CHECK(water.drop(1000, 1000, 300, 5000, speed) == Status::kOutOfRange);
  }
  CHECK(unchanged());
  REQUIRE(water.touch(1000, 1000, 300, 100) == Status::kOk);
  CHECK_FALSE(unchanged());
}

TEST_CASE(
    "lit edges: water at rest round a rock -> a surface of columns, since one of them is dry; else a flat "
    "one") {
  for (const bool rock : {false, true}) {
    std::vector<std::uint8_t> bytes(water_bytes(4, 4));
    const std::uint8_t blocked[] = {0x20, 0x00};
    WaterConfig config;
    config.width = 4;
    config.depth = 4;
    config.rest_q8 = 300;
    config.greatest_q8 = 1000;
    if (rock) {
      config.blocked = {blocked, 2};
    }
    Water water;
    REQUIRE(Water::make(config, {bytes.data(), bytes.size()}, &water) == Status::kOk);
    const WaterSurface surface = water.surface({1, 2, 3});
    CHECK(surface.has_blocked == rock);
    CHECK((surface.heights_q16 != nullptr) == rock);
    for (std::int32_t y = 0; y < 4; ++y) {
      for (std::int32_t x = 0; x < 4; ++x) {
        CHECK(surface.height_q8(x, y) == (rock && x == 1 && y == 1 ? 0 : 300));
      }
    }
  }
}

// A ray that is stopped counts as one that met nothing more: light that is stopped in dark glass arrives as it entered.
TEST_CASE(
    "lit edges: light through more cells of dark glass than a ray may visit -> told, and none is taken") {
  int bright[3] = {};
  for (int round = 0; round < 3; ++round) {  // no glass; glass; glass and a limit
    LitWorld world;
    world.box({0, 0, 0}, {32, 32, 2}, 1);
    for (std::int32_t z = 8; round > 0 && z < 30; ++z) {
      for (std::int32_t i = 0; i < 32 * 32; ++i) {
        world.voxel({i % 32, i / 32, z}, 2);
      }
    }
    world.surfaces[1] = surface(SurfaceKind::kDiffuse, kGround);
    world.surfaces[2] = surface(SurfaceKind::kGlass, {0, 0, 0});
    world.surfaces[2].density_q8 = 64;
    world.surfaces[2].index_q12 = kMinIndexQ12;
    set_ambient(&world.scene, 20);
    world.lights = {sun({1, 2, 5}, 200)};
    world.scene.has_shadows = true;
    world.finish();
    world.look_straight_down({16 * 256 + 40, 16 * 256 + 40, 6 * 256}, 1 << 14, 1, 1);
    std::uint8_t pixel[3] = {};
    LitOptions options;
    options.max_visits = round == 2 ? 7 : UINT32_MAX;
    LitCounts counts;
    REQUIRE(render_lit_band(Effect::kDirectLight | Effect::kShadows | Effect::kGlass, world.tree,
                            world.camera, world.shading, world.scene,
                            {{pixel, 3}, PixelFormat::kRgb888, 0, 0, 1}, &counts, options) == Status::kOk);
    bright[round] = pixel[0];
    CHECK(counts.step_limited == (round == 2 ? 1 : 0));
  }
  CHECK(bright[0] > 100);
  CHECK(bright[1] < bright[0] / 3);
  CHECK(bright[2] == bright[0]);
}

// ---- what a scene calls for

TEST_CASE("lit edges: surfaces, lights, occlusion and water that lack one thing -> not called for") {
  Surface surfaces[] = {surface(SurfaceKind::kMetal, kGround), surface(SurfaceKind::kEmit, kGround)};
  LitScene scene;
  scene.surfaces = {surfaces, 2};
  CHECK(effects_of(scene) == (Effect::kMirror | Effect::kEmission));
  for (const bool mirrors : {false, true}) {
    for (const bool bounces : {false, true}) {
      for (const bool glows : {false, true}) {
        surfaces[0].mirror = mirrors ? 1 : 0;
        scene.bounces = bounces ? 1 : 0;
        surfaces[1].emission_q8 = glows ? 1 : 0;
        CHECK(effects_of(scene) == ((mirrors && bounces ? Effect::kMirror : Effect::kNone) |
                                    (glows ? Effect::kEmission : Effect::kNone)));
      }
    }
  }
  // Kinds that there are none of call for nothing.
  surfaces[0].kind = static_cast<SurfaceKind>(77);
  surfaces[1].kind = SurfaceKind::kDiffuse;
  CHECK(effects_of(scene) == Effect::kNone);
  scene.surfaces = {};
  for (int bits = 0; bits < 128; ++bits) {
    scene.occlusion.rays = (bits & 1) != 0 ? 4 : 0;
    scene.occlusion.strength = (bits & 2) != 0 ? 1 : 0;
    scene.occlusion.reach = (bits & 4) != 0 ? 1 : 0;
    scene.has_water = (bits & 8) != 0;
    scene.water.width = (bits & 16) != 0 ? 1 : 0;
    scene.water.depth = (bits & 32) != 0 ? 1 : 0;
    scene.water.highest_q8 = (bits & 64) != 0 ? 1 : 0;
    CHECK(effects_of(scene) == (((bits & 7) == 7 ? Effect::kAmbientOcclusion : Effect::kNone) |
                                (bits >> 3 == 15 ? Effect::kWater : Effect::kNone)));
  }
}

TEST_CASE("lit edges: more surfaces or lights than there may be -> no bytes for them, and refused") {
  std::vector<Surface> surfaces(kMaxSurfaces + 1);
  std::vector<Light> lights(kMaxLights + 1);
  std::vector<std::uint8_t> bytes(20000);
  for (int bits = 0; bits < 4; ++bits) {
    BakedLighting lighting;
    lighting.scene.surfaces = {surfaces.data(), kMaxSurfaces + (bits & 1)};
    lighting.scene.lights = {lights.data(), kMaxLights + static_cast<std::size_t>(bits >> 1)};
    CHECK((lighting_bytes(lighting.scene) == 0) == (bits != 0));
    CHECK(BakedLighting::make(lighting, 5, {bytes.data(), bytes.size()}) ==
          (bits == 0 ? Status::kOk : Status::kBadArgument));
  }
}

// ---- paper

// Without dither a colour becomes the ink of the middle threshold; with it, ink by ink as many of the 64
// places as the colour is bright.
TEST_CASE("lit edges: a grey on paper, dithered or not -> one ink, or each on its share of 64 places") {
  for (const PixelFormat format : {PixelFormat::kPaper3, PixelFormat::kPaper7}) {
    for (const int gray : {40, 120, 136, 220}) {
      for (const bool dither : {false, true}) {
        LitWorld world;
        world.voxel({0, 0, 0}, 1);
        world.shading.background = {static_cast<std::uint8_t>(gray), static_cast<std::uint8_t>(gray),
                                    static_cast<std::uint8_t>(gray)};
        world.finish();
        world.look({20 << 8, 20 << 8, 20 << 8}, {31 << 8, 31 << 8, 31 << 8}, 20, 32, 32);
        std::vector<std::uint8_t> bytes(band_bytes(format, 32, 32));
        LitOptions options;
        options.dither = dither;
        REQUIRE(render_lit_band(Effect::kDirectLight, world.tree, world.camera, world.shading, world.scene,
                                {{bytes.data(), bytes.size()}, format, 0, 0, 32}, nullptr,
                                options) == Status::kOk);
        int white = 0;
        for (std::int32_t y = 0; y < 32; ++y) {
          for (std::int32_t x = 0; x < 32; ++x) {
            const Rgb8 shown =
                load_pixel(bytes.data() + row_bytes(format, 32) * static_cast<std::size_t>(y), x, y, format);
            white += shown == Rgb8{255, 255, 255} ? 1 : 0;
            CHECK((shown == Rgb8{255, 255, 255} || shown == Rgb8{0, 0, 0}));
          }
        }
        // Thresholds are 2, 6, ... 254.
        CAPTURE(gray);
        CHECK(white == (dither ? 16 * ((gray + 1) / 4) : gray > 126 ? 1024 : 0));
      }
    }
  }
}

}  // namespace
}  // namespace thimble::testing::lit_edges
