// Lit pictures in which something ends: a mirrored ray in its face, glass in glass, water at its edges. What each pixel
// must show is known without tracing a ray: what takes no light away shows a background of one colour everywhere,
// whichever way it bends.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "support/lit_world.h"
#include "thimble/light/host/optics.h"
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
  Slab() {
    box({0, 0, 0}, {32, 32, 4}, 1);
    surfaces[1] = surface(SurfaceKind::kDiffuse, kGround);
    set_ambient(&scene, 128);
  }
};

// ---- metal

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
      world.scene.water_material = medium(SurfaceKind::kGlass, {255, 255, 255}, 0, kWaterIndexQ12);
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
    world.scene.water_material = medium(SurfaceKind::kGlass, {0, 0, 0}, 256);
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
    world.surfaces[2] = medium(SurfaceKind::kGlass, {0, 0, 0}, 64);
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
