// Lit frames by the brick map and with balls, where a format, a list or a world ends: each is the picture
// that the tree alone gives, or a status.
#include <doctest/doctest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "support/map_world.h"
#include "support/scene_under_test.h"
#include "thimble/light/map_render.h"
#include "thimble/light/render.h"

namespace thimble::testing::map_edges {
namespace {

using tests::HeapBytes;

// A house of a few walls, in all materials.
struct House : MapWorld {
  explicit House(bool empty = false, int level = 5) : MapWorld(level) {
    if (!empty) {
      box({2, 2, 0}, {30, 30, 2}, 1);
      box({6, 6, 2}, {8, 26, 14}, 2);
      box({6, 24, 2}, {26, 26, 10}, 3);
      box({16, 10, 2}, {20, 14, 20}, 4);
      voxel({24, 8, 5}, 2);
    }
    surfaces[1] = surface(SurfaceKind::kDiffuse, {210, 190, 150});
    surfaces[2] = surface(SurfaceKind::kDiffuse, {200, 60, 30});
    surfaces[3] = surface(SurfaceKind::kEmit, {90, 120, 220});
    surfaces[4] = surface(SurfaceKind::kDiffuse, {40, 160, 70});
    scene.has_sky = true;
    lights.push_back(sun({7, -3, 4}, 120));
    map_it();
    look({-14 * 256 + 3, -20 * 256 + 17, 24 * 256}, {16 * 256, 16 * 256, 6 * 256}, 46, 53, 37);
  }
};

// What is proven of a world's first sun.
struct ProvenSun {
  explicit ProvenSun(const MapWorld& world) : bytes(SunBricks::bytes(world.map)) {
    REQUIRE(SunBricks::make(world.map, world.lights[0].place, bytes.span(), &sun) == Status::kOk);
    sun.prove();
  }
  HeapBytes bytes;
  SunBricks sun;
};

constexpr EffectSet kSun = Effect::kDirectLight | Effect::kShadows;

// The tree's bytes, and its rays one by one.
template <EffectSet kSet = kSun>
void compare(const House& world, Span<const SunBricks> suns = {}, PixelFormat format = PixelFormat::kRgb888,
             std::size_t offset = 0) {
  CAPTURE(static_cast<int>(format));
  CAPTURE(suns.size);
  const BothCounts both = draw_both<kSet>(world, format, offset, suns);
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    CHECK(both.by_map.rays[kind] == both.by_tree.rays[kind]);
    CHECK(both.by_map.hits[kind] == both.by_tree.hits[kind]);
  }
}
// By each set of the sun's, and by light without shadows.
void compare_sets(const House& world, Span<const SunBricks> suns, Span<const SunBricks> of_all,
                  PixelFormat format, std::size_t offset = 0) {
  compare(world, suns, format, offset);
  compare<Effect::kDirectLight>(world, {}, format, offset);
  compare<kSun | Effect::kEmission | Effect::kSky>(world, of_all, format, offset);
  compare<kSun | Effect::kEmission>(world, suns, format, offset);
  compare<kSun | Effect::kSky>(world, suns, format, offset);
}

TEST_CASE("lit frames by the map: every format, with dither and without -> the tree's bytes") {
  for (const bool empty : {false, true}) {
    House world(empty);
    const ProvenSun proven(world);
    for (int number = 0; number < kPixelFormats; ++number) {
      for (int bits = 0; bits < 4; ++bits) {
        world.options.dither = (bits & 1) != 0;
        // Also in a buffer that begins between halfwords.
        compare_sets(world, {&proven.sun, 1}, {&proven.sun, bits < 2 ? 1U : 0U},
                     static_cast<PixelFormat>(number), bits < 2 ? 0 : 1);
      }
    }
  }
}

// Faces of many pixels are drawn as wholes.
TEST_CASE("lit frames by the map: large faces in formats of halfwords and less -> the tree's bytes") {
  House world;
  const ProvenSun proven(world);
  world.look({-6 * 256 + 3, -9 * 256 + 17, 18 * 256}, {16 * 256, 16 * 256, 4 * 256}, 40, 240, 176);
  for (const PixelFormat format : {PixelFormat::kRgb565, PixelFormat::kRgb565Be, PixelFormat::kBgr565,
                                   PixelFormat::kGray4, PixelFormat::kMono1Pages}) {
    compare_sets(world, {&proven.sun, 1}, {&proven.sun, 1}, format);
  }
}

TEST_CASE("lit frames by the map: rows of whole tiles -> nothing is written behind the last") {
  House world;
  for (const Vec3i& target : {Vec3i{16 * 256, 16 * 256, 0}, Vec3i{0, 16 * 256, 60 * 256}}) {  // ground, sky
    world.look({16 * 256, 3 * 256, 12 * 256}, target, 60, 96, 48);
    std::vector<std::uint16_t> pixels(96 * 64, 0x5A5A);
    const Band band{{static_cast<std::uint8_t*>(static_cast<void*>(pixels.data())), 2 * 96 * 48},
                    PixelFormat::kRgb565,
                    0,
                    0,
                    48};
    REQUIRE(render_lit_band<kSun>(world.tree, world.map, world.camera, world.shading, world.scene, {},
                                  band) == Status::kOk);
    int written = 0;
    for (std::size_t i = 96 * 48; i < pixels.size(); ++i) {
      written += pixels[i] == 0x5A5A ? 0 : 1;
    }
    CHECK(written == 0);
  }
}

TEST_CASE("lit frames by the map: effects that there are not -> by the map as without, no node is read") {
  House world;
  LitCounts counts[2];
  std::vector<std::uint8_t> pixels[2];
  for (int i = 0; i < 2; ++i) {
    pixels[i].resize(band_bytes(PixelFormat::kRgb888, 53, 37));
    const EffectSet effects = kSun | (i == 0 ? Effect::kNone : ~Effect::kAll);
    REQUIRE(render_lit_band(effects, world.tree, world.map, world.camera, world.shading, world.scene, {},
                            {{pixels[i].data(), pixels[i].size()}, PixelFormat::kRgb888, 0, 0, 37},
                            &counts[i]) == Status::kOk);
  }
  CHECK(pixels[0] == pixels[1]);
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    CHECK(counts[0].node_visits[kind] == counts[1].node_visits[kind]);
  }
}

// The middle row's points lie on a plane between voxels, in which the light of a level sun runs; suns of 12 bits.
TEST_CASE(
    "lit frames by the map: large faces under a sun without x, y or z, or of 12 bits -> the tree's bytes") {
  House world;
  world.look({-6 * 256 + 3, -9 * 256 + 17, 6 * 256}, {16 * 256, 16 * 256, 6 * 256}, 40, 240, 177);
  for (const Vec3i& direction :
       {Vec3i{0, -9, 16}, Vec3i{-5, 0, 16}, Vec3i{-5, -9, 0}, Vec3i{-1, -9, 0}, Vec3i{-9, -5, 0},
        Vec3i{-3900, -4000, 4095}, Vec3i{-4000, -2100, 4090}, Vec3i{2900, -4095, 4000}}) {
    CAPTURE(direction.x);
    world.lights[0].place = direction;
    compare(world);
  }
}

TEST_CASE("lit frames by the map: views in which something ends -> the tree's bytes") {
  House world;
  constexpr Vec3i kAbove{18 * 256, 44 * 256, 30 * 256};
  constexpr Vec3i kWithin{2176, 2320, 1552};
  const struct {
    Vec3i eye;
    Vec3i forward;
    int fov;
    int width;
    int height;
    int bits;
    Vec3i sun;
  } kViews[] = {
      // A column of points less than 1/256 beside an edge of two voxels, at the end of the shadow of both.
      {kAbove, {-1, -16500, -28000}, 3, 31, 24, 15, {0, -9, 40}},
      {kAbove, {1, -16500, -28000}, 3, 31, 24, 15, {0, -9, 40}},
      {kAbove, {-1, -16500, -28000}, 3, 33, 24, 15, {0, -9, 40}},
      {kAbove, {1, -16500, -28000}, 3, 33, 24, 15, {0, -9, 40}},
      // Neighbours that go opposite ways along the axis on which they are fastest, so a quad has no such axis.
      {kWithin, {-3, 3, -1}, 111, 2, 1, 8, {-5, -9, 16}},
      {kWithin, {0, 788, 910}, 56, 7, 1, 8, {-5, -9, 16}},
      {kWithin, {985, 3, 177}, 55, 14, 1, 8, {-5, -9, 16}},
      {kWithin, {-902, 2, 668}, 96, 23, 3, 8, {-5, -9, 16}}};
  for (const auto& view : kViews) {
    CAPTURE(view.width);
    world.lights[0].place = view.sun;
    REQUIRE(world.camera.set(PerspectiveView{LitWorld::point(view.eye),
                                             view.forward,
                                             {},
                                             Q16::saturate(view.fov),
                                             view.width,
                                             view.height,
                                             view.bits},
                             5) == Status::kOk);
    compare(world);
  }
}

TEST_CASE(
    "lit frames by the map: a set that is known only at run time, with lamps and without -> the tree's "
    "bytes") {
  House world;
  world.scene.occlusion = {6, 160, 8};
  world.surfaces[4].kind = SurfaceKind::kMetal;
  world.surfaces[4].mirror = 190;
  const auto draw = [&](EffectSet effects, const BrickMap& by, std::vector<std::uint8_t>* bytes,
                        LitCounts* counts) {
    bytes->assign(band_bytes(PixelFormat::kRgb888, 53, 37), 0x5A);
    return render_lit_band(effects, world.tree, by, world.camera, world.shading, world.scene, {},
                           {{bytes->data(), bytes->size()}, PixelFormat::kRgb888, 0, 0, 37}, counts, {});
  };
  constexpr EffectSet kBeside[] = {Effect::kAmbientOcclusion, Effect::kEmission, Effect::kSky,
                                   Effect::kMirror, Effect::kFog};
  int fast = 0;
  for (const bool lamps : {false, true}) {
    if (lamps) {
      world.lights.push_back(lamp({12 * 256, 14 * 256 + 9, 9 * 256}, 300, 12));
      world.finish();
      world.map_it();
    }
    std::vector<EffectSet> sets{Effect::kDirectLight};
    for (unsigned bits = 0; bits < 32; ++bits) {
      sets.push_back(kSun);
      for (unsigned i = 0; i < 5; ++i) {
        sets.back() |= (bits >> i & 1U) != 0 ? kBeside[i] : Effect::kNone;
      }
    }
    for (const EffectSet effects : sets) {
      CAPTURE(lamps);
      CAPTURE(effects);
      std::vector<std::uint8_t> bytes;
      LitCounts by_map;
      LitCounts by_tree;
      REQUIRE(draw(effects, world.map, &bytes, &by_map) == Status::kOk);
      const std::vector<Rgb8> right = world.draw(effects, &by_tree);
      REQUIRE(3 * right.size() == bytes.size());
      bool same = true;
      for (std::size_t i = 0; i < right.size(); ++i) {
        same = same && right[i] == Rgb8{bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]};
      }
      CHECK(same);
      constexpr auto kShadow = static_cast<int>(LitRayKind::kShadow);
      CHECK(by_map.rays[kShadow] == by_tree.rays[kShadow]);
      constexpr auto kMirrored = static_cast<int>(LitRayKind::kMirrorRay);
      CHECK(by_map.rays[kMirrored] == by_tree.rays[kMirrored]);
      CHECK((by_map.rays[kMirrored] != 0) == ((effects & Effect::kMirror) != 0));
      fast += by_map.node_visits[0] < by_tree.node_visits[0] ? 1 : 0;
    }
    std::vector<std::uint8_t> bytes;
    CHECK(draw(kSun, BrickMap(), &bytes, nullptr) == Status::kDamaged);
  }
  // The tree draws those with fog, and lamps without shadows.
  CHECK(fast == 17 + 16);
}

TEST_CASE(
    "lit frames by the map: too little room, a stranger's map, too many lights -> a status, nothing "
    "drawn") {
  House world;
  std::vector<std::uint8_t> bytes(band_bytes(PixelFormat::kGray8, 53, 37), 0x5A);
  const std::vector<std::uint8_t> before = bytes;
  const auto draw = [&](const BrickMap& by, std::size_t size) {
    return render_lit_band<kSun>(world.tree, by, world.camera, world.shading, world.scene, {},
                                 {{bytes.data(), size}, PixelFormat::kGray8, 0, 0, 37});
  };
  CHECK(draw(world.map, bytes.size() - 1) == Status::kOutOfMemory);
  CHECK(draw(BrickMap(), bytes.size()) == Status::kDamaged);
  const House stranger(true);
  CHECK(draw(stranger.map, bytes.size()) == Status::kDamaged);
  const std::vector<Light> lights = world.lights;
  world.lights.resize(kMaxLights + 1, lamp({2000, 2000, 2000}));
  world.finish();
  CHECK(draw(world.map, bytes.size()) == Status::kOutOfRange);
  world.lights = lights;
  world.surfaces.resize(kMaxSurfaces + 1);
  world.finish();
  CHECK(draw(world.map, bytes.size()) == Status::kOutOfRange);
  CHECK(bytes == before);
}

TEST_CASE("lit frames by the map: worlds of level 9 and 10 -> the tree's bytes, by nodes of few pixels") {
  for (const int level : {9, 10}) {
    House world(false, level);
    if (level == 10) {  // a wall whose occlusion is farther than worlds up to level 8 are wide
      world.box({640, 0, 0}, {704, 512, 512}, 1);
      world.map_it();
    }
    world.scene.occlusion = {32, 255, 65535};
    draw_both<kSun | Effect::kAmbientOcclusion>(world);
    const ProvenSun proven(world);
    for (const bool is_proven : {false, true}) {
      compare_sets(world, {&proven.sun, is_proven ? 1U : 0U}, {&proven.sun, 1}, PixelFormat::kRgb565);
      const BothCounts both =
          draw_both<kSun>(world, PixelFormat::kGray8, 0, {&proven.sun, is_proven ? 1U : 0U});
      constexpr int kShadow = static_cast<int>(LitRayKind::kShadow);
      CHECK(both.by_map.node_visits[kShadow] * 10 < both.by_tree.node_visits[kShadow]);
    }
  }
}

TEST_CASE(
    "a ray to the sun through lattice points, in a brick with nothing behind it -> still meets what is in "
    "it") {
  // The middle row's rays run at z = 8 exactly and end on a face of the first voxel; from there the sun's go through
  // edges only, to the second one in the same brick.
  MapWorld world(4);
  world.voxel({8, 9, 8}, 1);
  world.voxel({11, 9, 10}, 1);
  world.lights = {sun({1, 0, 1})};
  world.map_it();
  const ProvenSun proven(world);
  const Vec3i eye{15 * 256, 9 * 256 + 100, 8 * 256};
  world.look(eye, {0, eye.y, eye.z}, 20, 33, 17);
  const BothCounts both = draw_both<kSun>(world, PixelFormat::kRgb888, 0, {&proven.sun, 1});
  CHECK(both.by_map.hits[static_cast<int>(LitRayKind::kShadow)] > 0);
  CHECK(both.by_map.node_visits[static_cast<int>(LitRayKind::kShadow)] == 0);
}

TEST_CASE("a wall of every brightness -> each step of the dither is the tree's") {
  std::mt19937_64 random(9);
  MapWorld world(4);
  world.box({0, 0, 0}, {16, 16, 2}, 1);
  world.map_it();
  world.look({8 * 256, 8 * 256, 8 * 256}, {8 * 256, 9 * 256, -256}, 20, 8, 8);
  for (int i = 0; i < 600; ++i) {
    CAPTURE(i);
    world.lights[0] = sun({0, 0, 1}, i);
    world.surfaces[1].albedo = {static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()),
                                static_cast<std::uint8_t>(random())};
    for (const PixelFormat format : {PixelFormat::kMono1, PixelFormat::kGray4, PixelFormat::kRgb565}) {
      draw_both<Effect::kDirectLight>(world, format);
    }
  }
}

// ---- balls

Ball ball_at(const Vec3i& voxel, int half_q8, Rgb8 color) {
  Ball ball;
  ball.center = {voxel.x * 256, voxel.y * 256, voxel.z * 256};
  ball.half_q8 = half_q8;
  ball.bottom_q8 = ball.center.z - half_q8;
  ball.top_q8 = ball.center.z + half_q8;
  ball.surface = surface(SurfaceKind::kDiffuse, color);
  return ball;
}

struct BallPicture {
  Status status;
  std::vector<std::uint8_t> bytes;
};
BallPicture draw_balls(const House& world, EffectSet effects, const std::vector<Ball>& balls) {
  BallPicture made{Status::kOk, std::vector<std::uint8_t>(band_bytes(PixelFormat::kRgb888, 53, 37), 0x5A)};
  made.status = render_lit_band(effects, world.tree, {{balls.data(), balls.size()}, nullptr}, world.camera,
                                world.shading, world.scene,
                                {{made.bytes.data(), made.bytes.size()}, PixelFormat::kRgb888, 0, 0, 37});
  return made;
}

TEST_CASE("balls: one behind another, in either order, within one another -> the same picture") {
  const House world;
  // On the line from the eye to what it looks at, the second half way behind the first; then the same place,
  // one larger.
  const std::vector<Ball> rows[] = {
      {ball_at({4, 1, 13}, 768, {255, 0, 0}), ball_at({8, 5, 11}, 768, {0, 0, 255})},
      {ball_at({4, 1, 13}, 768, {255, 0, 0}), ball_at({4, 1, 13}, 512, {0, 0, 255})}};
  for (const std::vector<Ball>& balls : rows) {
    for (const EffectSet effects :
         {kSun, Effect::kDirectLight, kSun | Effect::kMirror | Effect::kAmbientOcclusion}) {
      const BallPicture one = draw_balls(world, effects, balls);
      const BallPicture other = draw_balls(world, effects, {balls[1], balls[0]});
      REQUIRE(one.status == Status::kOk);
      CHECK(one.bytes == other.bytes);
      CHECK(one.bytes != draw_balls(world, effects, {balls[1]}).bytes);
    }
  }
}

TEST_CASE("balls: of no such side, or where no ray may start -> a status, nothing drawn") {
  const House world;
  const auto with = [&](const Vec3i& center_q8, std::int32_t half) {
    Ball ball = ball_at({4, 1, 13}, 256, {255, 0, 0});
    ball.half_q8 = half;
    ball.center = center_q8;
    const BallPicture made = draw_balls(world, kSun, {ball});
    CHECK((made.status == Status::kOk || made.bytes == std::vector<std::uint8_t>(made.bytes.size(), 0x5A)));
    return made.status;
  };
  const Vec3i middle{4096, 4096, 4096};
  CHECK(with(middle, 512) == Status::kOk);
  CHECK(with(middle, 0) == Status::kOk);
  CHECK(with(middle, 511) == Status::kBadArgument);
  CHECK(with(middle, -2) == Status::kBadArgument);
  for (const std::int32_t half : {1 << 20, 1 << 30, INT32_MAX - 1}) {
    CHECK(with(middle, half) == Status::kOutOfRange);
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::int32_t far : {1 << 20, -(1 << 20), 1 << 30, INT32_MAX, INT32_MIN}) {
      Vec3i center = middle;
      center[axis] = far;
      CHECK(with(center, 512) == Status::kOutOfRange);
    }
  }
  CHECK(draw_balls(world, kSun, std::vector<Ball>(kMaxDrawnBalls + 1)).status == Status::kOutOfRange);
  CHECK(draw_balls(world, kSun, std::vector<Ball>(kMaxDrawnBalls)).status == Status::kOk);
}

}  // namespace
}  // namespace thimble::testing::map_edges
