#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "support/counts.h"
#include "support/lit_world.h"
#include "thimble/light/host/optics.h"
#include "thimble/light/host/slope.h"
#include "thimble/light/host/slope_window.h"
#include "thimble/light/render.h"
#include "thimble/trace/secondary_ray.h"

namespace {

using namespace thimble;
using namespace thimble::testing;

using Solid = std::function<bool(int, int, int)>;
struct Real3 {
  double x, y, z;
};
Real3 unit(const Real3& of) {
  const double length = std::sqrt(of.x * of.x + of.y * of.y + of.z * of.z);
  return {of.x / length, of.y / length, of.z / length};
}
double degrees_between(const Vec3i& normal, const Real3& other) {
  const Real3 a = unit({1.0 * normal.x, 1.0 * normal.y, 1.0 * normal.z});
  const Real3 b = unit(other);
  return std::acos(std::min(1.0, a.x * b.x + a.y * b.y + a.z * b.z)) * 57.29577951308232;
}

/// A world of 64 from a function of voxels, and every place on faces of it that show: `per_face` places on
/// each, of 1/256 voxel, another set for every face.
class Body : public LitWorld {
 public:
  explicit Body(Solid solid) : LitWorld(6, 200000), solid_(std::move(solid)) {
    for (int z = 0; z < 64; ++z) {
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          if (solid_(x, y, z)) {
            voxel({x, y, z}, 0);
          }
        }
      }
    }
    finish();
  }
  bool is_solid(const Vec3i& at) const {
    const bool inside = ((at.x | at.y | at.z) & ~63) == 0;
    return inside && solid_(at.x, at.y, at.z);
  }
  template <class Look>
  void each_place(int per_face, const Look& look) const {
    std::uint32_t seed = 1;
    const auto next = [&] { return static_cast<std::int32_t>((seed = seed * 1664525U + 1013904223U) >> 24); };
    for (int z = 0; z < 64; ++z) {
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          for (int face = 0; face < 6 && solid_(x, y, z); ++face) {
            const Face on{face / 2, face % 2 == 0};
            Vec3i before{x, y, z};
            before[on.axis] += on.negative ? -1 : 1;
            for (int i = 0; i < per_face && !is_solid(before); ++i) {
              Vec3i at{x * 256 + next(), y * 256 + next(), z * 256 + next()};
              at[on.axis] = (Vec3i{x, y, z}[on.axis] + (on.negative ? 0 : 1)) * 256;
              look(point(at), on, normal_at(point(at), on));
            }
          }
        }
      }
    }
  }
  Vec3i normal_at(const Vec3Q8& at, const Face& face) const {
    std::uint32_t visits = 0;
    const Vec3i normal = lit::surface_normal(tree, {}, at, face, &visits);
    if (visits > lit::most_slope_visits(tree.level())) {
      FAIL("more nodes than the bound");
    }
    return normal;
  }
  // By definition: the sum of (R^2 - d^2) d over what is solid and near.
  Real3 gradient(const Vec3Q8& at) const {
    const double reach = lit::kSlopeReachHalves / 2.0;
    // The point counts to 1/64 voxel, rounded down.
    const Real3 p{(at.x.raw >> 2) / 64.0, (at.y.raw >> 2) / 64.0, (at.z.raw >> 2) / 64.0};
    Real3 sum{0, 0, 0};
    for (int z = at.z.floor() - 7; z <= at.z.floor() + 7; ++z) {
      for (int y = at.y.floor() - 7; y <= at.y.floor() + 7; ++y) {
        for (int x = at.x.floor() - 7; x <= at.x.floor() + 7; ++x) {
          const Real3 d{x + 0.5 - p.x, y + 0.5 - p.y, z + 0.5 - p.z};
          const double weight = reach * reach - d.x * d.x - d.y * d.y - d.z * d.z;
          if (weight > 0 && is_solid({x, y, z})) {
            sum = {sum.x - weight * d.x, sum.y - weight * d.y, sum.z - weight * d.z};
          }
        }
      }
    }
    return sum;
  }

 private:
  Solid solid_;
};

Vec3i own_normal(const Face& face) {
  Vec3i normal;
  normal[face.axis] = face.negative ? -kUnitQ14 : kUnitQ14;
  return normal;
}

void expect_faces(const Body& body) {
  int wrong = 0;
  int places = 0;
  body.each_place(tests::many_or_few(3, 1), [&](const Vec3Q8&, const Face& face, const Vec3i& normal) {
    ++places;
    wrong += normal == own_normal(face) ? 0 : 1;
  });
  CHECK(places > 0);
  CHECK(wrong == 0);
}

Solid box(const Vec3i& low, const Vec3i& high) {
  return [=](int x, int y, int z) {
    return x >= low.x && x < high.x && y >= low.y && y < high.y && z >= low.z && z < high.z;
  };
}

TEST_CASE("a plane, a cube, a lone voxel, a plate, a room: every face keeps its own normal, exactly") {
  const Solid room = [](int x, int y, int z) {
    const bool wall = x < 8 || y < 8 || z < 8 || x >= 56 || y >= 56 || z >= 56;
    return wall || (x >= 20 && x < 32 && y >= 20 && y < 32 && z < 16);
  };
  const Solid thin_room = [](int x, int y, int z) {
    const bool inside = x < 60 && y < 60 && z < 50 && x >= 2 && y >= 2 && z >= 2;
    return x < 62 && y < 62 && z < 52 && !inside;
  };
  const Solid slab = [](int x, int, int z) { return z < 20 || (z >= 23 && z < 30 && x < 30); };
  const std::pair<const char*, Solid> bodies[] = {{"a plane", box({0, 0, 0}, {64, 64, 21})},
                                                  {"a cube", box({13, 20, 31}, {29, 36, 47})},
                                                  {"a cube of 3", box({13, 20, 31}, {16, 23, 34})},
                                                  {"a voxel", box({30, 31, 33}, {31, 32, 34})},
                                                  {"a plate", box({10, 11, 33}, {40, 50, 34})},
                                                  {"a beam", box({10, 30, 33}, {50, 33, 37})},
                                                  {"a room with a block in it", room},
                                                  {"a room of thin walls", thin_room},
                                                  {"a floor below a slab", slab}};
  for (const auto& [each_name, solid] : bodies) {
    const auto& name = each_name;
    CAPTURE(name);
    expect_faces(Body(solid));
  }
}

TEST_CASE("a staircase: the gradient of its definition, and its slope within a third of a degree") {
  for (int turn = 0; turn < 6; ++turn) {
    CAPTURE(turn);
    const Body stairs([turn](int x, int y, int z) {
      const int along[3] = {x, y, z};
      const int up = along[turn % 3];
      const int side = along[(turn + 1) % 3];
      return turn < 3 ? up + side < 60 : up - side < 4;
    });
    Real3 slope{0, 0, 0};
    double* const of[3] = {&slope.x, &slope.y, &slope.z};
    *of[turn % 3] = 1;
    *of[(turn + 1) % 3] = turn < 3 ? 1 : -1;
    double worst = 0;
    double worst_definition = 0;
    int places = 0;
    stairs.each_place(1, [&](const Vec3Q8& at, const Face& face, const Vec3i& normal) {
      const Vec3i voxel{at.x.floor(), at.y.floor(), at.z.floor()};
      bool inner = true;
      for (int axis = 0; axis < 3; ++axis) {
        inner = inner && voxel[axis] > 8 && voxel[axis] < 56;
      }
      if (!inner || face.axis == (turn + 2) % 3) {
        return;
      }
      ++places;
      worst = std::max(worst, degrees_between(normal, slope));
      worst_definition = std::max(worst_definition, degrees_between(normal, stairs.gradient(at)));
    });
    CHECK(places > 1000);
    CHECK(worst < 0.34);
    CHECK(worst_definition < 0.008);
  }
}

// A floor of 4 voxels, open below, under a ceiling one voxel higher: what is solid above the point weighs as much as what
// is below, so the gradient is what two holes leave of it, below 2^19 in the units in which it is added up.
TEST_CASE("a gradient along the axis of its face: the normal is the face's, and nothing is followed") {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i along{};
    along[axis] = -7;
    Vec3i oblique{2, 2, 2};
    oblique[(axis + 1) % 3] = -5;
    for (const bool negative : {false, true}) {
      const Face face{axis, negative};
      CHECK(lit::slope_axis(along, face) == -1);
      CHECK(lit::slope_axis({}, face) == -1);
      CHECK(lit::slope_axis(oblique, face) == (axis + 1) % 3);
      for (const int other : {(axis + 1) % 3, (axis + 2) % 3}) {
        Vec3i beside = along;
        beside[other] = 5;
        CHECK(lit::slope_axis(beside, face) == axis);
      }
    }
  }
}

TEST_CASE("a gradient in steps: a part that leans behind the face is left out, the rest is a unit") {
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 1; side < 3; ++side) {
      for (const int shrunk : {1, 32}) {  // to 20 bits
        const int size = shrunk == 1 ? 40 : 3 << 21;
        Vec3i normal{};
        normal[axis] = -4 * size;
        normal[(axis + side) % 3] = -3 * size;
        Vec3i unit{};
        unit[(axis + side) % 3] = -kUnitQ14;
        CHECK(lit::unit_of_slope(normal, {axis, false}) == unit);
        CHECK(lit::unit_of_slope(normal, {axis, true}) ==
              unit_q14(Vec3i{normal.x / shrunk, normal.y / shrunk, normal.z / shrunk}));
      }
    }
  }
}

// A slope of 1:2 that steps down once, where a face looks up the slope: in the middle of a voxel's side nothing is left
// but the way up.
TEST_CASE("a face within a slope that leans the other way: straight up, along any axes") {
  for (int along = 0; along < 3; ++along) {
    for (const int up : {(along + 1) % 3, (along + 2) % 3}) {
      const Body slope([=](int x, int y, int z) {
        const Vec3i at{x, y, z};
        return at[up] <= at[along] / 2 + (at[along] < 33 ? 10 : 9);
      });
      Vec3i at{30 * 256 + 128, 30 * 256 + 128, 30 * 256 + 128};
      at[along] = 33 * 256;
      at[up] = 26 * 256 + 128;
      CHECK(slope.normal_at(LitWorld::point(at), {along, false}) == own_normal({up, false}));
    }
  }
}

TEST_CASE("between a floor and a ceiling that balance: the gradient of its definition, small as it is") {
  const Body slot([](int x, int y, int z) {
    const bool hole = (x == 29 && y == 29 && z == 27) || (x == 37 && y == 29 && z == 30);
    return ((z >= 27 && z < 31) || z >= 32) && !hole;
  });
  const Vec3Q8 at = LitWorld::point({8288, 8293, 31 * 256});
  const Vec3i normal = slot.normal_at(at, {2, false});
  const Real3 gradient = slot.gradient(at);
  constexpr double kUnits = 64.0 * 64 * 64;
  for (const double part : {gradient.x, gradient.y, gradient.z}) {
    CHECK(std::abs(part) * kUnits > 0);
    CHECK(std::abs(part) * kUnits < 1 << 19);
  }
  CHECK(std::abs(static_cast<int>(length_of(normal)) - kUnitQ14) <= kUnitLengthError);
  CHECK(degrees_between(normal, gradient) < 0.02);
}

// A ball, or a shell of it; the worst and the mean square of how far its outside's normals are from the true ones.
void expect_round(double radius, double thickness, double middle, double most, double most_mean) {
  CAPTURE(radius);
  CAPTURE(middle);
  const auto square = [](double value) { return value * value; };
  const Body ball([=](int x, int y, int z) {
    const double from = square(x + 0.5 - middle) + square(y + 0.5 - middle) + square(z + 0.5 - middle);
    return from < square(radius) && (thickness >= radius || from >= square(radius - thickness));
  });
  double worst = 0;
  double sum = 0;
  double count = 0;
  ball.each_place(1, [&](const Vec3Q8& at, const Face& face, const Vec3i& normal) {
    const Real3 out{at.x.raw / 256.0 - middle, at.y.raw / 256.0 - middle, at.z.raw / 256.0 - middle};
    if (thickness < radius && (at[face.axis].raw / 256.0 < middle) != face.negative) {
      return;  // its inside
    }
    const double error = degrees_between(normal, out);
    worst = std::max(worst, error);
    sum += error * error;
    ++count;
  });
  CHECK(worst < most);
  CHECK(std::sqrt(sum / count) < most_mean);
}

TEST_CASE("a ball: within 6 degrees of the true normals from radius 6 on, 2.5 in the mean square") {
  for (const double radius : {6.0, 7.3, 10.0, 14.5, 20.0, 28.0}) {
    for (const double middle : {32.0, 32.25, 31.5}) {
      expect_round(radius, radius, middle, 6, radius < 7 ? 2.5 : 1.6);
    }
  }
}

TEST_CASE("a thin shell, as meshes are: within 18 degrees, 2.5 in the mean square") {
  for (const double radius : {6.0, 10.0, 14.5, 20.0, 28.0}) {
    expect_round(radius, 1.5, 32.25, 18, 2.5);
  }
}

TEST_CASE("damaged trees: no more nodes than the bound, and a unit vector") {
  const Body ball([](int x, int y, int z) { return x * x + y * y + z * z < 1600; });
  std::vector<std::uint8_t> bytes(ball.tree.bytes(), ball.tree.bytes() + ball.tree.size_bytes());
  std::uint32_t seed = 7;
  for (int trial = 0; trial < 400; ++trial) {
    seed = seed * 1664525U + 1013904223U;
    const std::size_t at = kCompactHeaderBytes + (seed >> 8) % (bytes.size() - kCompactHeaderBytes);
    bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1U << (seed >> 5 & 7U)));
    CompactTree tree;
    REQUIRE(CompactTree::open({bytes.data(), bytes.size()}, &tree) == Status::kOk);
    std::uint32_t visits = 0;
    const Vec3Q8 place = LitWorld::point({23 * 256 + trial % 256, 24 * 256 + 13, 22 * 256});
    const Vec3i normal = lit::surface_normal(tree, {}, place, {2, trial % 2 == 0}, &visits);
    CHECK(visits <= lit::most_slope_visits(6));
    CHECK(std::abs(static_cast<int>(length_of(normal)) - kUnitQ14) <= kUnitLengthError);
  }
}

constexpr EffectSet kSunlit = Effect::kDirectLight | Effect::kShadows | Effect::kAmbientOcclusion;

TEST_CASE("where all is flat, the picture and its rays are those without the effect") {
  LitWorld world(6);
  world.box({0, 0, 0}, {64, 64, 4}, 0);
  world.box({20, 20, 4}, {36, 36, 20}, 1);
  world.box({44, 12, 4}, {47, 15, 40}, 2);
  world.surfaces[1] = surface(SurfaceKind::kMetal, {230, 200, 120});
  world.surfaces[2] = surface(SurfaceKind::kGlass, {220, 240, 230});
  world.lights = {sun({-6, -9, 12}), lamp({20 * 256, 4 * 256, 20 * 256}, 300, 12)};
  world.scene.occlusion.rays = 8;
  world.finish();
  world.look({-10 * 256, -22 * 256, 40 * 256}, {32 * 256, 30 * 256, 8 * 256}, 60, 80, 60);
  constexpr EffectSet kSet = kSunlit | Effect::kMirror | Effect::kGlass | Effect::kSky;
  LitCounts without;
  LitCounts with;
  CHECK(world.draw(kSet, &without) == world.draw(kSet | Effect::kSmoothNormals, &with));
  for (int kind = 0; kind < kLitRayKinds; ++kind) {
    CHECK(with.rays[kind] == without.rays[kind]);
    CHECK(with.hits[kind] == without.hits[kind]);
  }
  CHECK(with.node_visits[0] > without.node_visits[0]);
}

/// A ball of 22 voxels on nothing, before a black background.
class Ball : public LitWorld {
 public:
  explicit Ball(SurfaceKind kind) : LitWorld(6, 200000) {
    for (int z = 0; z < 64; ++z) {
      for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
          const int d[3] = {2 * x - 63, 2 * y - 63, 2 * z - 63};
          if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < 4 * 22 * 22) {
            voxel({x, y, z}, 1);
          }
        }
      }
    }
    surfaces[1] = surface(kind, {255, 255, 255});
    surfaces[1].density_q8 = 0;
    set_ambient(&scene, 0);
    finish();
    look({32 * 256, -100 * 256, 32 * 256}, {32 * 256, 32 * 256, 32 * 256}, 30, 80, 80);
  }
};

TEST_CASE("a ball in the sun: the brightness of a true ball, with no step in its own shadow") {
  Ball ball(SurfaceKind::kDiffuse);
  const Real3 toward = unit({-6, -5, 7});
  ball.lights = {sun({-6, -5, 7})};
  ball.finish();
  const std::vector<Rgb8> picture = ball.draw(kSunlit | Effect::kSmoothNormals);
  double worst = 0;
  int lit_pixels = 0;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) {
      const Ray ray = ball.camera.ray(x, y);
      Hit hit;
      REQUIRE(closest_hit(ball.tree, ray, &hit) == Status::kOk);
      if (hit.kind != HitKind::kHit) {
        continue;
      }
      const Vec3Q8 at = start_on_face(ray, hit);
      const Real3 out = unit({at.x.raw / 256.0 - 32, at.y.raw / 256.0 - 32, at.z.raw / 256.0 - 32});
      const double cosine = out.x * toward.x + out.y * toward.y + out.z * toward.z;
      const int shown = picture[static_cast<std::size_t>(80 * y + x)].r;
      worst = std::max(worst, std::abs(shown - 255 * std::max(0.0, cosine)));
      lit_pixels += cosine > 0 ? 1 : 0;
    }
  }
  CHECK(lit_pixels > 1000);
  CHECK(worst < 26);  // a tenth of white: 6 degrees where the cosine falls fastest
}

TEST_CASE("a ball of metal and one of glass show the sky as true balls do") {
  // A sky that tells up from down: above white, below black.
  const Sky sky{{255, 255, 255}, {128, 128, 128}, {0, 0, 0}};
  for (const SurfaceKind kind : {SurfaceKind::kMetal, SurfaceKind::kGlass}) {
    CAPTURE(static_cast<int>(kind));
    Ball ball(kind);
    ball.scene.has_sky = true;
    ball.scene.sky = sky;
    const EffectSet set = Effect::kSky | Effect::kMirror | Effect::kGlass | Effect::kDirectLight;
    const std::vector<Rgb8> picture = ball.draw(set | Effect::kSmoothNormals);
    const auto mean = [&](int y) {
      double sum = 0;
      for (int x = 30; x < 50; ++x) {
        sum += picture[static_cast<std::size_t>(80 * y + x)].r / 20.0;
      }
      return sum;
    };
    // A mirror shows what is above where it looks up; a ball of glass turns it upside down.
    const double above = mean(28);
    const double below = mean(52);
    CHECK((kind == SurfaceKind::kMetal ? above - below : below - above) > 60);
    // No face of a voxel shows: neighbours in a row are alike.
    int jumps = 0;
    for (int y = 26; y < 54; ++y) {
      for (int x = 28; x < 52; ++x) {
        const int here = picture[static_cast<std::size_t>(80 * y + x)].r;
        jumps += std::abs(here - picture[static_cast<std::size_t>(80 * y + x + 1)].r) > 24 ? 1 : 0;
      }
    }
    CHECK(jumps == 0);
  }
}

}  // namespace
