// Shadows and occlusion, held to the exact reference and to what is known of simple places.
#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "reference/reference.h"
#include "scene/random.h"
#include "support/counts.h"
#include "support/lit_world.h"
#include "thimble/trace/secondary_ray.h"

namespace {

using namespace thimble;
using namespace thimble::testing;
using thimble::tools::SplitMix64;
namespace ref = thimble::reference;

constexpr int kSide = 32;

/// Random blocks and voxels, in the tree and in the reference's grid.
struct Place {
  LitWorld world;
  ref::BitGrid grid{{kSide, kSide, kSide}};

  void box(const Vec3i& min, const Vec3i& max) {
    world.box(min, max, 0);
    for (int z = min.z; z < max.z; ++z) {
      for (int y = min.y; y < max.y; ++y) {
        for (int x = min.x; x < max.x; ++x) {
          grid.set({x, y, z});
        }
      }
    }
  }
};

std::int64_t floored(std::int64_t dividend, std::int64_t divisor) {
  const std::int64_t quotient = dividend / divisor;
  return quotient * divisor == dividend || (dividend < 0) == (divisor < 0) ? quotient : quotient - 1;
}

/// The rule in words (lit_surface.cpp, secondary_ray.h): of the faces entered at once the lowest that is not
/// hidden; that coordinate exact, the two others rounded down to 1/256 and kept within the voxel. Where all
/// are hidden, all of their coordinates exact.
ref::Ray start_of(const ref::BitGrid& grid, const ref::Ray& ray, const ref::Hit& hit, int* face) {
  std::array<bool, 3> entered{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t a = static_cast<std::size_t>(axis);
    if (ray.direction[a] == 0) {
      continue;
    }
    const std::int64_t plane = 256 * (hit.voxel[a] + (ray.direction[a] < 0 ? 1 : 0));
    // plane = origin + 256 t direction
    entered[a] = (plane - ray.origin_q8[a]) * hit.t_denominator == 256 * hit.t_numerator * ray.direction[a];
  }
  *face = -1;
  int lowest = -1;
  for (int axis = 2; axis >= 0; --axis) {
    const std::size_t a = static_cast<std::size_t>(axis);
    if (entered[a]) {
      ref::Voxel before = hit.voxel;
      before[a] += ray.direction[a] > 0 ? -1 : 1;
      lowest = axis;
      *face = grid.contains(before) && grid.test(before) ? *face : axis;
    }
  }
  const bool crease = *face < 0;
  ref::Ray start;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t a = static_cast<std::size_t>(axis);
    const std::int64_t low = 256 * hit.voxel[a];
    if (axis == *face || (crease && entered[a])) {
      start.origin_q8[a] = low + (ray.direction[a] < 0 ? 256 : 0);
      continue;
    }
    const std::int64_t at =
        ray.origin_q8[a] + floored(256 * hit.t_numerator * ray.direction[a], hit.t_denominator);
    start.origin_q8[a] = at < low ? low : at > low + 255 ? low + 255 : at;
  }
  *face = crease ? lowest : *face;
  return start;
}

ref::Ray ref_ray(const Ray& ray) {
  return {{ray.origin.x.raw, ray.origin.y.raw, ray.origin.z.raw},
          {ray.direction.x, ray.direction.y, ray.direction.z}};
}

TEST_CASE(
    "shadows: in every pixel what the exact reference says of the ray to the sun, or as far as the lamp") {
  const int kWorlds = thimble::tests::many_or_few(12, 3);
  for (const bool is_lamp : {false, true}) {
    CAPTURE(is_lamp);
    int shadowed = 0;
    int lit = 0;
    int behind = 0;  // something solid, beyond the lamp
    for (int seed = 0; seed < kWorlds; ++seed) {
      CAPTURE(seed);
      SplitMix64 random(static_cast<std::uint64_t>(seed) + (is_lamp ? 1977 : 77));
      const auto below = [&](int bound) {
        return static_cast<int>(random.below(static_cast<std::uint64_t>(bound)));
      };
      Place place;
      place.box({0, 0, 0}, {kSide, kSide, 2});
      if (is_lamp) {
        place.box({kSide - 1, 0, 2},
                  {kSide, kSide, kSide});  // what stands beyond the lamp, seen from the floor
      }
      for (int i = 0; i < 30; ++i) {
        const Vec3i low{below(28), below(28), below(is_lamp ? 20 : 28)};
        const int size = i < 10 ? 4 : 1;
        place.box(low, {low.x + size, low.y + size, low.z + size});
      }
      LitWorld& world = place.world;
      world.surfaces[0].albedo = {255, 255, 255};
      set_ambient(&world.scene, 0);
      const Vec3i to = is_lamp ? Vec3i{256 * 4 + below(256 * 24), 256 * 4 + below(256 * 24),
                                       256 * (6 + below(20)) + below(256)}
                               : Vec3i{below(2001) - 1000, below(2001) - 1000, 300 + below(2000)};
      world.lights = {is_lamp ? lamp(to, 60000, 100) : sun(to, 60000)};
      world.finish();
      // Whole numbers for the eye: edges are met exactly now and then.
      world.look({-20 * 256 - 256 * below(5), -20 * 256, (10 + below(30)) * 256},
                 {16 * 256, 16 * 256, 8 * 256}, 50, 80, 60);
      const std::vector<Rgb8> picture = world.draw(Effect::kDirectLight | Effect::kShadows);
      int wrong = 0;
      for (int pixel = 0; pixel < 80 * 60; ++pixel) {
        const ref::Ray ray = ref_ray(world.camera.ray(pixel % 80, pixel / 80));
        const ref::Hit hit = ref::walk(place.grid, ray);
        // So bright a light leaves no face that it reaches black.
        const bool is_bright = picture[static_cast<std::size_t>(pixel)].r != 0;
        if (!hit.hit) {
          wrong += is_bright ? 1 : 0;
          continue;
        }
        int face = -1;
        ref::Ray shadow = start_of(place.grid, ray, hit, &face);
        RayPoint end;
        shadow.direction = {to.x, to.y, to.z};
        if (is_lamp) {
          Ray towards;
          const auto q8 = [&](std::size_t axis) {
            return Q8::from_raw(static_cast<std::int32_t>(shadow.origin_q8[axis]));
          };
          REQUIRE(ray_towards({q8(0), q8(1), q8(2)}, LitWorld::point(to), 15, &towards, &end));
          shadow.direction = ref_ray(towards).direction;
        }
        const auto f = static_cast<std::size_t>(face);
        const std::int64_t away = ray.direction[f] > 0 ? -shadow.direction[f] : shadow.direction[f];
        if (away <= 0) {
          wrong += is_bright ? 1 : 0;
          continue;
        }
        const ref::Hit met = ref::walk(place.grid, shadow);
        const bool is_dark = met.hit && (!is_lamp || met.t_numerator * end.t_denominator <
                                                         end.t_numerator * met.t_denominator);
        behind += met.hit && !is_dark ? 1 : 0;
        shadowed += is_dark ? 1 : 0;
        if (is_dark) {
          wrong += is_bright ? 1 : 0;
        } else if (!is_lamp || away > 1 << 9) {  // else light so slanting that it may round to black
          ++lit;
          wrong += is_bright ? 0 : 1;
        }
      }
      CHECK(wrong == 0);
    }
    CHECK(shadowed > 42 * kWorlds);
    CHECK(lit > (is_lamp ? 200 : 417) * kWorlds);
    CHECK((behind > 20 * kWorlds) == is_lamp);
  }
}

TEST_CASE("shadows: a lamp is not darkened by the voxels that shine around it") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 2}, 0);
  world.box({15, 15, 10}, {17, 17, 12}, 1);
  world.surfaces[1] = surface(SurfaceKind::kEmit, {255, 255, 255});
  set_ambient(&world.scene, 0);
  world.lights = {lamp({16 * 256, 16 * 256, 11 * 256}, 1000)};
  world.finish();
  world.look({16 * 256, -20 * 256, 8 * 256}, {16 * 256 + 37, 12 * 256, 2 * 256});
  CHECK(world.middle(Effect::kDirectLight | Effect::kShadows | Effect::kEmission).r > 100);
  CHECK(world.middle(Effect::kDirectLight | Effect::kShadows).r == 0);
}

TEST_CASE("occlusion: an open plane is exactly as bright as without it") {
  for (const int rays : {4, 8, 16, 32}) {
    LitWorld world;
    world.box({0, 0, 0}, {32, 32, 2}, 0);
    world.surfaces[0].albedo = {255, 255, 255};
    world.scene.occlusion.rays = static_cast<std::uint8_t>(rays);
    set_ambient(&world.scene, 256);
    world.finish();
    world.look({-10 * 256, -20 * 256, 20 * 256}, {16 * 256, 16 * 256, 2 * 256});
    LitCounts counts;
    CHECK(world.draw(Effect::kDirectLight | Effect::kAmbientOcclusion, &counts) ==
          world.draw(Effect::kDirectLight));
    CHECK(counts.rays[static_cast<int>(LitRayKind::kOcclusion)] ==
          counts.hits[0] * static_cast<std::uint64_t>(rays));
    CHECK(counts.hits[static_cast<int>(LitRayKind::kOcclusion)] == 0);
  }
}

TEST_CASE("occlusion: the deeper a pit the darker its floor, down to black") {
  int last = 256;
  for (const int depth : {0, 2, 4, 8, 16, 24}) {
    LitWorld shaft;  // of 2 x 2
    shaft.box({0, 0, 0}, {32, 32, 4}, 0);
    if (depth > 0) {
      shaft.box({0, 0, 4}, {15, 32, 4 + depth}, 0);
      shaft.box({17, 0, 4}, {32, 32, 4 + depth}, 0);
      shaft.box({15, 0, 4}, {17, 15, 4 + depth}, 0);
      shaft.box({15, 17, 4}, {17, 32, 4 + depth}, 0);
    }
    shaft.surfaces[0].albedo = {255, 255, 255};
    shaft.scene.occlusion.rays = 32;
    shaft.scene.occlusion.reach = 64;
    set_ambient(&shaft.scene, 256);
    shaft.finish();
    shaft.look({16 * 256, 16 * 256, 60 * 256}, {16 * 256, 16 * 256, 0}, 4);
    const int brightness = shaft.middle(Effect::kDirectLight | Effect::kAmbientOcclusion).r;
    CAPTURE(depth);
    CHECK((depth <= 8 ? brightness < last : brightness <= last));
    last = brightness;
  }
  CHECK(last < 12);
}

TEST_CASE("occlusion: its strength says how dark a closed place is") {
  LitWorld world;
  world.box({0, 0, 0}, {32, 32, 2}, 0);
  world.box({0, 20, 2}, {32, 32, 32}, 0);
  world.scene.occlusion.rays = 16;
  world.scene.occlusion.reach = 16;
  set_ambient(&world.scene, 256);
  world.finish();
  world.look({16 * 256, 5 * 256, 12 * 256}, {16 * 256, 19 * 256, 2 * 256}, 10);
  const int open = world.middle(Effect::kDirectLight).r;
  const int closed = world.middle(Effect::kDirectLight | Effect::kAmbientOcclusion).r;
  world.scene.occlusion.strength = 128;
  const int half = world.middle(Effect::kDirectLight | Effect::kAmbientOcclusion).r;
  world.scene.occlusion.strength = 0;
  CHECK(world.middle(Effect::kDirectLight | Effect::kAmbientOcclusion).r == open);
  CHECK(closed < half);
  CHECK(half < open);
  CHECK(half - (closed + open) / 2 <= 2);
}

}  // namespace
