// Balls beside the tree: what a ray meets is judged by a tree with the balls' voxels in it, and by hand.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "scene/random.h"
#include "support/lit_world.h"
#include "thimble/light/render.h"
#include "thimble/trace/ray.h"

namespace {

using namespace thimble;
using namespace thimble::testing;

constexpr int kRed = 6;

/// A ball whose planes are all on those of voxels: `half` is in voxels, and even.
Ball ball_at(const Vec3i& voxel, int half, const Surface& surface) {
  Ball ball;
  ball.center = {voxel.x * 256, voxel.y * 256, voxel.z * 256};
  ball.half_q8 = half * 256;
  ball.bottom_q8 = 0;
  ball.top_q8 = ball.center.z + ball.half_q8;
  ball.surface = surface;
  return ball;
}

/// The same as voxels.
void put_ball(LitWorld* world, const Vec3i& at, int half, int material) {
  const int thin = half / 2;
  world->box({at.x - thin, at.y - half, at.z - half}, {at.x + thin, at.y + half, at.z + half}, material);
  world->box({at.x - half, at.y - thin, at.z - half}, {at.x + half, at.y + thin, at.z + half}, material);
  world->box({at.x - half, at.y - half, at.z - thin}, {at.x + half, at.y + half, at.z + thin}, material);
}

std::vector<Rgb8> draw_with(const LitWorld& world, EffectSet effects, const std::vector<Ball>& balls,
                            std::uint32_t* passed = nullptr, LitCounts* counts = nullptr) {
  return world.picture_of([&](const Band& band) {
    return render_lit_band(effects, world.tree, {{balls.data(), balls.size()}, passed}, world.camera,
                           world.shading, world.scene, band, counts);
  });
}

/// A basin of water, a mirror, glass, a lamp, a cloud, rough metal; with balls in the tree or beside it.
class BallWorld : public LitWorld {
 public:
  explicit BallWorld(bool in_tree) {
    call_for_everything();
    surfaces[kRed] = surface(SurfaceKind::kDiffuse, {250, 92, 64});
    surfaces[7] = surface(SurfaceKind::kMetal, {250, 240, 230});
    surfaces[8] = surface(SurfaceKind::kEmit, {120, 220, 255});
    box({0, 0, 0}, {32, 32, 3}, 0);
    box({0, 29, 3}, {32, 32, 24}, 1);
    box({14, 22, 4}, {20, 27, 12}, 2);
    box({28, 20, 3}, {30, 24, 9}, 3);
    box({20, 14, 12}, {28, 20, 18}, 4);
    box({24, 4, 3}, {29, 9, 10}, 5);
    const Vec3i places[] = {{10, 10, 18}, {20, 12, 6}, {6, 20, 5}};  // in the air, near the water, in it
    const int looks[] = {kRed, 7, 8};
    for (int i = 0; i < 3; ++i) {
      if (in_tree) {
        put_ball(this, places[i], 2, looks[i]);
      } else {
        balls.push_back(ball_at(places[i], 2, surfaces[static_cast<std::size_t>(looks[i])]));
      }
    }
    lights = {sun({-6, -9, 12}), lamp({20 * 256 + 31, 7 * 256 + 90, 20 * 256 + 7}, 300, 12)};
    scene.water = still_water({2, 2, 3}, 28, 27, 2 * 256 + 77);
    finish();
    look({-9 * 256 + 13, -21 * 256 + 57, 26 * 256 + 101}, {16 * 256, 15 * 256, 7 * 256}, 44, 96, 72);
    set_depth_range();
  }

  std::vector<Ball> balls;
};

constexpr EffectSet kLight = Effect::kDirectLight | Effect::kShadows;
constexpr EffectSet kFlat = Effect::kAll & ~(Effect::kSmoothNormals | Effect::kEdges);

}  // namespace

TEST_CASE("balls: on the planes of voxels -> each ray meets what it meets in a tree of the same voxels") {
  LitWorld world;
  put_ball(&world, {16, 14, 12}, 4, kRed);
  world.finish();
  const Ball ball = ball_at({16, 14, 12}, 4, {});
  tools::SplitMix64 random(5);
  int hits = 0;
  int misses = 0;
  for (int round = 0; round < 60000; ++round) {
    Ray ray;
    // Also on planes and edges, along axes and within faces.
    const bool on_planes = round % 3 == 0;
    for (int axis = 0; axis < 3; ++axis) {
      const int place = random.between(0, 28 * 256);
      ray.origin[axis] = Q8::from_raw(on_planes ? place / 256 * 256 : place);
      const int to = ball.center[axis] + random.between(-1200, 1200);
      ray.direction[axis] = on_planes ? random.between(-3, 3) : to - place;
    }
    if (ray.direction == Vec3i{}) {
      continue;
    }
    CAPTURE(round);
    Hit judge;
    REQUIRE(closest_hit(world.tree, ray, &judge) == Status::kOk);
    BoxHit hit;
    const bool met = enter_ball(ray, ball, &hit);
    REQUIRE(met == (judge.kind == HitKind::kHit));
    if (met) {
      // The same t; a voxel may be entered by faces which its neighbour hides, a ball has none.
      CHECK(std::int64_t{hit.at.t_numerator} * judge.t_denominator ==
            std::int64_t{judge.t_numerator} * hit.at.t_denominator);
      CHECK(hit.axis >= judge.axis);
    }
    hits += met ? 1 : 0;
    misses += met ? 0 : 1;
  }
  CHECK(hits > 10000);
  CHECK(misses > 10000);
}

TEST_CASE(
    "balls: a ray that starts on a face and goes in -> has entered there; within -> axis -1; and goes out -> "
    "none") {
  const Ball ball = ball_at({16, 14, 12}, 4, {});
  BoxHit hit;
  const auto enter = [&](int x, int y, int z, const Vec3i& direction) {
    return enter_ball({LitWorld::point({x * 256, y * 256, z * 256}), direction}, ball, &hit);
  };
  REQUIRE(enter(12, 14, 12, {3, 1, 1}));
  CHECK(hit.axis == 0);
  CHECK(hit.at.t_numerator == 0);
  REQUIRE(enter(15, 14, 16, {1, 1, -4}));
  CHECK(hit.axis == 2);
  REQUIRE(enter(15, 14, 15, {1, 1, -4}));
  CHECK(hit.axis == -1);
  CHECK(hit.at.t_numerator == 0);
  CHECK_FALSE(enter(12, 14, 12, {-3, 1, 1}));
  CHECK_FALSE(enter(15, 14, 16, {1, 1, 4}));
  // The edge is cut off: 2 voxels on it comes to the box that is half as thick along y.
  REQUIRE(enter(12, 10, 15, {1, 3, 0}));
  CHECK(hit.axis == 1);
  CHECK(hit.at.t_numerator == 2 * 256);
}

TEST_CASE("balls: a ray of one unit along an axis -> the spot on the face that looks to it") {
  LitWorld world;
  world.finish();
  world.look({0, 0, 0}, {16 * 256, 16 * 256, 16 * 256});
  const Ball ball = ball_at({16, 14, 12}, 4, surface(SurfaceKind::kDiffuse, {1, 2, 3}));
  const LitOptions options;
  lit::BallFrame frame({world.tree, world.camera, world.shading, world.scene, options, kLight},
                       {{&ball, 1}, nullptr});
  for (int axis = 0; axis < 3; ++axis) {
    for (const int way : {-1, 1}) {
      lit::PendingRay now;
      now.ray.origin = LitWorld::point(ball.center);
      now.ray.origin[axis].raw -= way * 2000;
      now.ray.direction[axis] = way;
      lit::Meeting meeting;
      meet_solid(frame, now, &meeting);
      REQUIRE(meeting.opaque);
      const lit::Spot spot = spot_of(frame, now, meeting);
      CHECK(spot.at[axis].raw == ball.center[axis] - way * ball.half_q8);
      CHECK(spot.face.axis == axis);
      CHECK(spot.face.negative == (way > 0));
    }
  }
}

TEST_CASE("balls: a camera within one -> the picture of a tree that has it, where no light comes") {
  BallWorld judge(true);
  BallWorld world(false);
  const Vec3i within{10 * 256 + 31, 10 * 256 - 57, 18 * 256 + 5};
  judge.look(within, {16 * 256, 15 * 256, 7 * 256});
  world.look(within, {16 * 256, 15 * 256, 7 * 256});
  for (const EffectSet effects : {kLight, Effect::kDirectLight}) {
    const std::vector<Rgb8> drawn = draw_with(world, effects, world.balls);
    CHECK(drawn == judge.draw(effects));
    CHECK(drawn != world.draw(effects));
  }
}

TEST_CASE("balls: slopes for the tree -> a ball keeps its faces") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 4}, 0);
  for (int i = 0; i < 28; ++i) {
    world.box({0, i, 4}, {32, 32, 4 + i / 2}, 0);
  }
  world.surfaces[0] = surface(SurfaceKind::kDiffuse, {200, 200, 200});
  world.lights = {sun({-6, -9, 12})};
  set_ambient(&world.scene, 80);
  world.shading.background = {30, 30, 30};
  world.finish();
  world.look({-9 * 256 + 13, -21 * 256 + 57, 26 * 256 + 101}, {16 * 256, 15 * 256, 7 * 256}, 44, 96, 72);
  const std::vector<Ball> balls = {ball_at({14, 8, 8}, 2, surface(SurfaceKind::kDiffuse, {216, 196, 190}))};
  const std::vector<Rgb8> faces = draw_with(world, kLight, balls);
  const std::vector<Rgb8> slopes = draw_with(world, kLight | Effect::kSmoothNormals, balls);
  const std::vector<Rgb8> edges = draw_with(world, kLight | Effect::kEdges, balls);
  int ball = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i].r != faces[i].g) {
      CHECK(slopes[i] == faces[i]);
      CHECK(edges[i] == faces[i]);
      ++ball;
    }
  }
  CHECK(ball > 20);
  CHECK(slopes != faces);
  CHECK(edges != faces);
}

TEST_CASE("balls: on the planes of voxels -> the picture of a tree that has them, by every set of effects") {
  const BallWorld judge(true);
  const BallWorld world(false);
  const std::vector<Rgb8> without = world.draw(kFlat);
  for (const EffectSet effects :
       {kLight, kLight | Effect::kMirror, kLight | Effect::kMirror | Effect::kAmbientOcclusion,
        kLight | Effect::kGlass | Effect::kMedia, kLight | Effect::kWater | Effect::kRipples,
        kLight | Effect::kWater | Effect::kMirror | Effect::kEmission, EffectSet{Effect::kSky}, kFlat}) {
    CAPTURE(effects);
    const std::vector<Rgb8> wanted = judge.draw(effects);
    const std::vector<Rgb8> drawn = draw_with(world, effects, world.balls);
    int differing = 0;
    int changed = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      differing += wanted[i] == drawn[i] ? 0 : 1;
      changed += wanted[i] == without[i] ? 0 : 1;
    }
    CHECK(differing == 0);
    CHECK(changed > 150);
  }
}

TEST_CASE("balls: a sun aslant over a floor -> the shadow that was worked out by hand") {
  // From above, a pixel a column. The ball is 14 .. 18, 8 .. 12 high, and the floor ends at 4. Light comes from +x at
  // 45 degrees: a point x of the floor is dark where the line x + s, 4 + s meets the ball. In the two middle rows the
  // ball's section is the square: 14 - 12 < x - 4 < 18 - 8. In the rows beside them it is a cross, whose corners lie
  // one voxel further in: 3 < x - 4 < 9.
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 4}, 0);
  world.surfaces[0] = surface(SurfaceKind::kDiffuse, {200, 200, 200});
  world.lights = {sun({16, 0, 16})};
  set_ambient(&world.scene, 64);
  world.finish();
  const Vec3Q8 eye = LitWorld::point({16 * 256, 16 * 256, 30 * 256});
  REQUIRE(world.camera.set(OrthographicView{eye, {0, 0, -16}, {0, 16, 0}, Q14::saturate(32), 32, 32, 0}, 5) ==
          Status::kOk);
  const Ball ball = ball_at({16, 16, 10}, 2, surface(SurfaceKind::kDiffuse, {250, 92, 64}));
  const std::vector<Rgb8> lit = world.draw(kLight);
  const std::vector<Rgb8> drawn = draw_with(world, kLight, {ball});
  std::string seen;
  std::string wanted;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      const Rgb8& color = drawn[static_cast<std::size_t>(y * 32 + x)];
      const bool is_floor = color.r == color.g;
      seen += !is_floor ? 'o' : color == lit[static_cast<std::size_t>(y * 32 + x)] ? '.' : 's';
      const bool in_middle = y == 15 || y == 16;
      const bool beside = y == 14 || y == 17;
      const bool is_ball = (in_middle || beside) && x >= 14 && x < 18;
      const bool is_dark = (in_middle && x >= 6 && x < 14) || (beside && x >= 7 && x < 13);
      wanted += is_ball ? 'o' : is_dark ? 's' : '.';
    }
    seen += '\n';
    wanted += '\n';
  }
  CHECK(seen == wanted);
}

TEST_CASE("balls: none, or none that is there -> picture and counts of a scene without") {
  const BallWorld world(false);
  for (const EffectSet effects : {kFlat, EffectSet{Effect::kAll}}) {
    LitCounts counts[3];
    std::uint32_t passed = 0;
    const std::vector<Rgb8> wanted = world.draw(effects, &counts[0]);
    CHECK(draw_with(world, effects, {}, nullptr, &counts[1]) == wanted);
    CHECK(draw_with(world, effects, {Ball{}, Ball{}}, &passed, &counts[2]) == wanted);
    CHECK(passed == 0);
    for (int kind = 0; kind < kLitRayKinds; ++kind) {
      CHECK(counts[1].rays[kind] == counts[0].rays[kind]);
      CHECK(counts[2].hits[kind] == counts[0].hits[kind]);
      CHECK(counts[2].node_visits[kind] == counts[0].node_visits[kind]);
    }
  }
}

TEST_CASE("balls: effects that there are not -> as without any") {
  const BallWorld world(false);
  REQUIRE(draw_with(world, kLight, world.balls) != draw_with(world, Effect::kNone, world.balls));
  CHECK(draw_with(world, ~Effect::kAll, world.balls) == world.draw(Effect::kNone));
  CHECK(draw_with(world, Effect::kNone, world.balls) == world.draw(Effect::kNone));
}

TEST_CASE("balls: rows whose rays pass no fall -> as they were, wherever the ball is on it") {
  const BallWorld world(false);
  Ball ball = world.balls[0];
  const int width = world.camera.width_px();
  const auto row = [&](const Ball& one, int y, std::uint32_t* passed) {
    std::vector<std::uint8_t> bytes(band_bytes(PixelFormat::kRgb888, width, 1));
    const Ball balls[] = {Ball{}, one};
    REQUIRE(render_lit_band(kFlat, world.tree, {{balls, 2}, passed}, world.camera, world.shading, world.scene,
                            {{bytes.data(), bytes.size()}, PixelFormat::kRgb888, 0, y, 1}) == Status::kOk);
    return bytes;
  };
  int changed = 0;
  int spared = 0;
  for (int y = 0; y < world.camera.height_px(); ++y) {
    std::uint32_t passed = 0;
    const std::vector<std::uint8_t> before = row(ball, y, &passed);
    for (const int fallen : {200, 1500, 4000}) {
      Ball lower = ball;
      lower.center.z -= fallen;
      std::uint32_t ignored = 0;
      const bool differs = row(lower, y, &ignored) != before;
      CAPTURE(y);
      CHECK((passed == 2 || (passed == 0 && !differs)));
      changed += differs ? 1 : 0;
    }
    spared += passed == 0 ? 1 : 0;
  }
  CHECK(changed > 40);
  CHECK(spared > 3);
}
