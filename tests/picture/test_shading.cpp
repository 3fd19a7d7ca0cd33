#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "scene/random.h"
#include "support/counts.h"
#include "thimble/picture/shading.h"

namespace {

using namespace thimble;
using thimble::tools::SplitMix64;

const int kCameras = thimble::tests::many_or_few(3000, 300);
int between(SplitMix64& random, std::int64_t low, std::int64_t high) {
  return static_cast<int>(low + random.below(static_cast<std::uint64_t>(high - low + 1)));
}
Vec3i random_vector(SplitMix64& random, int largest) {
  Vec3i vector;
  do {
    vector = {between(random, -largest, largest), between(random, -largest, largest),
              between(random, -largest, largest)};
  } while (vector == Vec3i{});
  return vector;
}

/// A camera of either kind anywhere it may stand, sometimes with a very wide or high picture; set up or not.
bool random_camera(SplitMix64& random, Camera& camera) {
  const int level = between(random, kMinLevel, kMaxLevel);
  const int side_q8 = Q8::kOne << level;
  const auto coordinate = [&] {
    return Q8::from_raw(between(random, -4 * side_q8, 5 * std::int64_t{side_q8}));
  };
  const Vec3Q8 eye{coordinate(), coordinate(), coordinate()};
  const Vec3i forward = random_vector(random, 1 << between(random, 1, 30));
  const int width = 1 << between(random, 0, 14);
  const int height = 1 << between(random, 0, 14);
  const int bits = random.below(2) == 0 ? 0 : between(random, kMinDirectionBits, kMaxDirectionBits);
  if (random.below(2) == 0) {
    const Q16 fov = Q16::from_raw(between(random, kMinFov.raw, kMaxFov.raw));
    return camera.set(PerspectiveView{eye, forward, {}, fov, width, height, bits}, level) == Status::kOk;
  }
  const Q14 span = Q14::from_raw(between(random, 1, std::int64_t{Q14::kOne} << std::min(level + 2, 16)));
  return camera.set(OrthographicView{eye, forward, {}, span, width, height, bits}, level) == Status::kOk;
}

/// A parallel camera along +x whose t is just depth: a hit with numerator n lies at depth n.
Camera camera_along_x() {
  Camera camera;
  REQUIRE(camera.set(OrthographicView{{}, {1, 0, 0}, {}, Q14::saturate(8), 8, 8, 8}, 5) == Status::kOk);
  REQUIRE(camera.direction() == Vec3i{255, 0, 0});
  REQUIRE(camera.depth_per_t_q8() == 255 * 256);
  return camera;
}
Hit hit_at(std::int32_t depth_q8) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = 0;
  hit.t_numerator = depth_q8;
  hit.t_denominator = 255 * 256;
  return hit;
}
int depth_gray(const Camera& camera, std::int32_t depth_q8, std::int32_t near_q8, std::int32_t far_q8) {
  Shading shading{.mode = ShadeMode::kDepth, .palette = {}, .near_q8 = near_q8, .far_q8 = far_q8};
  const Rgb8 color = shade(hit_at(depth_q8), {{}, {255, 0, 0}}, camera, shading);
  CHECK(color.r == color.g);
  CHECK(color.g == color.b);
  return color.r;
}

Hit hit_on(int axis) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = static_cast<std::int8_t>(axis);
  return hit;
}

}  // namespace

TEST_CASE("planar_depth_q8: a picture much wider than high -> keeps its accuracy in the corner") {
  Camera camera;
  const PerspectiveView view{{}, {1, 0, 0}, {0, 0, 1}, kMaxFov, 16384, 1, 20};
  REQUIRE(camera.set(view, 6) == Status::kOk);
  const Ray ray = camera.ray(0, 0);
  const int side = std::abs(ray.direction.y);
  REQUIRE(side > 1000000);
  Hit hit = hit_on(1);
  hit.t_numerator = 1 << 23;
  hit.t_denominator = 256 * side;
  const double exact = std::ldexp(1.0, 23) * camera.depth_per_t_q8() / hit.t_denominator;
  CHECK(exact > 100);
  CHECK(std::fabs(planar_depth_q8(hit, camera) - exact) <= exact / 2048 + 1);
}

TEST_CASE("shade depth: planes just less than 2^24 apart -> the exact share, rounded up") {
  const Camera camera = camera_along_x();
  for (const std::int32_t far_q8 : {(1 << 23) + 255, (1 << 24) - 1}) {
    for (std::int32_t depth = 1000; depth < 1 << 23; depth += 4001) {
      const std::int64_t seen = planar_depth_q8(hit_at(depth), camera);
      CAPTURE(seen);
      CHECK(depth_gray(camera, depth, 0, far_q8) == 255 - seen * (255 - kFarBrightness) / far_q8);
    }
  }
}

TEST_CASE("depth_range: random cameras and boxes -> the nearest and farthest corner, by doubles") {
  constexpr std::uint64_t kSeed = 0x4A46E;
  SplitMix64 random(kSeed);
  int compared[2] = {0, 0};
  for (int turn = 0; turn < kCameras; ++turn) {
    Camera camera;
    if (!random_camera(random, camera)) {
      continue;
    }
    const int side = 1 << camera.level();
    VoxelBox box;
    for (int axis = 0; axis < 3; ++axis) {
      const int a = between(random, 0, side);
      const int b = between(random, 0, side);
      box.low[axis] = std::min(a, b);
      box.high[axis] = std::max(a, b) + (a == b ? 1 : 0);
    }
    // Forward: the direction itself, or the affine function at the picture's middle.
    double forward[3];
    double length = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Camera::Affine& affine = camera.affine();
      forward[axis] = camera.is_perspective()
                          ? static_cast<double>(affine.base[axis]) +
                                static_cast<double>(affine.step_x[axis]) * (camera.width_px() - 1) / 2 +
                                static_cast<double>(affine.step_y[axis]) * (camera.height_px() - 1) / 2
                          : camera.direction()[axis];
      length += forward[axis] * forward[axis];
    }
    length = std::sqrt(length);
    double nearest = 1e30;
    double farthest = -1e30;
    double reach = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      double dot = 0;
      double square = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const int plane = ((corner >> axis) & 1U) != 0 ? box.high[axis] : box.low[axis];
        const double offset = plane * 256.0 - camera.eye()[axis].raw;
        dot += offset * forward[axis] / length;
        square += offset * offset;
      }
      nearest = std::min(nearest, dot);
      farthest = std::max(farthest, dot);
      reach = std::max(reach, std::sqrt(square));
    }
    // depth_per_t_q8 is within 4 (parallel: 1) of its value; a component is cut to 1/4096 of a direction's
    // unit, which is 1/16 of depth_per_t's. A parallel direction's length is its projection on the ideal
    // forward vector, from which it is at most 222/256 of a unit away.
    const double per_t = camera.depth_per_t_q8();
    const double tolerance = camera.is_perspective() ? 2 + reach * 4.2 / per_t
                                                     : 2 + reach * (2 / per_t + 222 * 222 / (per_t * per_t));
    const DepthRange range = depth_range(camera, box);
    CAPTURE(kSeed);
    CAPTURE(turn);
    CHECK(range.near_q8 >= 0);
    CHECK(range.far_q8 >= range.near_q8 + 256);
    CHECK(std::fabs(range.near_q8 - std::max(nearest, 0.0)) <= tolerance);
    CHECK(std::fabs(range.far_q8 - std::max(farthest, std::max(nearest, 0.0) + 256)) <= tolerance + 1);
    ++compared[camera.is_perspective() ? 1 : 0];
  }
  CHECK(compared[0] > kCameras / 10);
  CHECK(compared[1] > kCameras / 10);
}
