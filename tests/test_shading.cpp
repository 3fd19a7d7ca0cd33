#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "scene/random.h"
#include "thimble/shading.h"

namespace {

using namespace thimble;
using thimble::tools::SplitMix64;

#ifdef __SANITIZE_ADDRESS__
constexpr int kCameras = 300;
#else
constexpr int kCameras = 3000;
#endif
constexpr std::int32_t kExtremes[] = {
    INT32_MIN, INT32_MIN + 1, -(1 << 26), -65536,        -1,       0, 1, 255, 256, 65536, 1 << 23,
    1 << 24,   (1 << 24) + 1, 1 << 30,    INT32_MAX - 1, INT32_MAX};

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
  Shading shading;
  shading.mode = ShadeMode::kDepth;
  shading.near_q8 = near_q8;
  shading.far_q8 = far_q8;
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

TEST_CASE("planar_depth_q8: random hits -> too small by at most 2^-11 and one unit") {
  constexpr std::uint64_t kSeed = 0xDE97;
  SplitMix64 random(kSeed);
  int set_up = 0;
  long double worst = 0;
  for (int turn = 0; turn < kCameras; ++turn) {
    Camera camera;
    if (!random_camera(random, camera)) {
      continue;
    }
    ++set_up;
    for (int i = 0; i < 20; ++i) {
      const Ray ray =
          camera.ray(between(random, 0, camera.width_px() - 1), between(random, 0, camera.height_px() - 1));
      Hit hit;
      hit.kind = HitKind::kHit;
      hit.axis = static_cast<std::int8_t>(random.below(3));
      if (ray.direction[hit.axis] == 0) {
        continue;
      }
      hit.t_numerator = between(random, 0, 1 << between(random, 0, 23));
      hit.t_denominator = 256 * std::abs(ray.direction[hit.axis]);
      const long double exact =
          static_cast<long double>(hit.t_numerator) * camera.depth_per_t_q8() / hit.t_denominator;
      const std::int32_t got = planar_depth_q8(hit, camera);
      CAPTURE(kSeed);
      CAPTURE(turn);
      CAPTURE(i);
      if (exact >= static_cast<long double>(INT32_MAX) * 1.001L) {
        CHECK(got == INT32_MAX);
        continue;
      }
      CHECK(got <= exact);
      CHECK(exact - got <= exact / 2048 + 1);
      if (exact > 1) {
        worst = std::max(worst, (exact - 1 - got) / exact);
      }
    }
  }
  CHECK(set_up > kCameras / 4);
  // Not idle: some come close to the bound, 4.9e-4. Measured over 3000 cameras: 4.04e-4.
  CHECK(worst > 1e-4L);
}

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

TEST_CASE("planar_depth_q8: a start inside, or a camera never set up -> 0") {
  const Camera camera = camera_along_x();
  Hit hit = hit_on(-1);
  CHECK(planar_depth_q8(hit, camera) == 0);
  CHECK(planar_depth_q8(hit_at(1000), Camera()) == 0);
}

TEST_CASE("shade depth: distance grows -> brightness falls from 255 at near to kFarBrightness at far") {
  const Camera camera = camera_along_x();
  constexpr DepthRange kRanges[] = {{0, 256}, {1000, 70000}, {0, 1 << 24}, {-500, 8000000}, {77, 78}, {5, 7}};
  for (const DepthRange& range : kRanges) {
    const std::int32_t near_q8 = range.near_q8;
    const std::int32_t far_q8 = range.far_q8;
    CAPTURE(near_q8);
    CAPTURE(far_q8);
    int before = 255;
    const int step = std::max(1, (far_q8 - near_q8) / 1000);
    for (std::int64_t depth = 0; depth <= std::min<std::int64_t>(far_q8 + 3 * step, 1 << 23); depth += step) {
      const int gray = depth_gray(camera, static_cast<std::int32_t>(depth), near_q8, far_q8);
      CHECK(gray <= before);
      before = gray;
      const std::int32_t seen = planar_depth_q8(hit_at(static_cast<std::int32_t>(depth)), camera);
      const double part = std::clamp((seen - double(near_q8)) / (double(far_q8) - near_q8), 0.0, 1.0);
      CHECK(std::fabs(gray - (255 - part * (255 - kFarBrightness))) <= 1.0);
    }
    CHECK(depth_gray(camera, std::max(0, near_q8), near_q8, far_q8) >= (near_q8 < 0 ? 254 : 255));
    if (far_q8 < (1 << 23) - 4096) {
      CHECK(depth_gray(camera, far_q8 + far_q8 / 2000 + 2, near_q8, far_q8) == kFarBrightness);
    }
  }
}

TEST_CASE("shade depth: planes at the ends of the numbers, equal or swapped -> in range, monotone") {
  const Camera camera = camera_along_x();
  for (const std::int32_t near_q8 : kExtremes) {
    for (const std::int32_t far_q8 : kExtremes) {
      CAPTURE(near_q8);
      CAPTURE(far_q8);
      int before = 255;
      for (std::int32_t depth = 0; depth <= 1 << 23; depth = depth * 2 + 1) {
        const int gray = depth_gray(camera, depth, near_q8, far_q8);
        CHECK(gray <= before);
        CHECK(gray >= kFarBrightness);
        before = gray;
        const std::int32_t seen = planar_depth_q8(hit_at(depth), camera);
        if (far_q8 <= near_q8) {
          CHECK(gray == (seen <= near_q8 ? 255 : kFarBrightness));
        } else {
          const double part = std::clamp((double(seen) - near_q8) / (double(far_q8) - near_q8), 0.0, 1.0);
          CHECK(std::fabs(gray - (255 - part * (255 - kFarBrightness))) <= 1.0);
        }
      }
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
      box.min[axis] = std::min(a, b);
      box.max[axis] = std::max(a, b) + (a == b ? 1 : 0);
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
        const int plane = ((corner >> axis) & 1U) != 0 ? box.max[axis] : box.min[axis];
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

TEST_CASE(
    "depth_range: empty box or a camera never set up -> the default; behind the eye -> 0 and one voxel") {
  const Camera camera = camera_along_x();
  CHECK(depth_range(camera, {}).near_q8 == 0);
  CHECK(depth_range(camera, {}).far_q8 == 256);
  CHECK(depth_range(Camera(), {{0, 0, 0}, {4, 4, 4}}).far_q8 == 256);
  CHECK(depth_range(camera, {{3, 0, 0}, {7, 9, 9}}).near_q8 == 3 * 256);
  CHECK(depth_range(camera, {{3, 0, 0}, {7, 9, 9}}).far_q8 == 7 * 256);
  Camera away;
  REQUIRE(away.set(OrthographicView{{}, {-1, 0, 0}, {}, Q14::saturate(8), 8, 8, 8}, 5) == Status::kOk);
  CHECK(depth_range(away, {{3, 0, 0}, {7, 9, 9}}).near_q8 == 0);
  CHECK(depth_range(away, {{3, 0, 0}, {7, 9, 9}}).far_q8 == 256);
}

TEST_CASE("light_from: random lights -> half-Lambert by doubles, within 1.5/256") {
  constexpr std::uint64_t kSeed = 0x11647;
  SplitMix64 random(kSeed);
  for (int turn = 0; turn < kCameras; ++turn) {
    const Vec3i light = random_vector(random, 1 << between(random, 0, 14));
    const double length =
        std::sqrt(double(light.x) * light.x + double(light.y) * light.y + double(light.z) * light.z);
    std::uint16_t faces[6];
    light_from(light, faces);
    CAPTURE(kSeed);
    CAPTURE(turn);
    for (int axis = 0; axis < 3; ++axis) {
      const double cosine = light[axis] / length;
      CHECK(std::fabs(faces[2 * axis] - (141 - 115 * cosine)) <= 1.5);
      CHECK(std::fabs(faces[2 * axis + 1] - (141 + 115 * cosine)) <= 1.5);
    }
  }
}

TEST_CASE("light_from: straight along an axis -> 256 towards it, 26 away, 141 aside; no light -> 141") {
  for (const int size : {1, 100, 1 << 14}) {
    std::uint16_t faces[6];
    light_from({0, 0, size}, faces);
    CHECK(faces[5] == 256);
    CHECK(faces[4] == 26);
    CHECK(faces[0] == 141);
    CHECK(faces[3] == 141);
    light_from({-size, 0, 0}, faces);
    CHECK(faces[0] == 256);
    CHECK(faces[1] == 26);
  }
  std::uint16_t faces[6];
  light_from({0, 0, 0}, faces);
  for (const std::uint16_t face : faces) {
    CHECK(face == 141);
  }
}

TEST_CASE("face_of: an entered face -> looks against the ray") {
  const Vec3i direction{5, -7, 9};
  CHECK(face_of(hit_on(0), direction).axis == 0);
  CHECK(face_of(hit_on(0), direction).negative);
  CHECK(face_of(hit_on(1), direction).axis == 1);
  CHECK_FALSE(face_of(hit_on(1), direction).negative);
  CHECK(face_of(hit_on(2), direction).axis == 2);
  CHECK(face_of(hit_on(2), direction).negative);
}

TEST_CASE("face_of: axis -1 -> opposed to the largest component, the lowest axis on a tie") {
  for (int x = -2; x <= 2; ++x) {
    for (int y = -2; y <= 2; ++y) {
      for (int z = -2; z <= 2; ++z) {
        const Vec3i direction{x * 500000, y * 500000, z * 500000};
        const int sizes[3] = {std::abs(x), std::abs(y), std::abs(z)};
        const int wanted =
            static_cast<int>(std::max_element(sizes, sizes + 3) - sizes);  // the first of equals
        const Face face = face_of(hit_on(-1), direction);
        CAPTURE(x);
        CAPTURE(y);
        CAPTURE(z);
        CHECK(face.axis == wanted);
        CHECK(face.negative == (direction[wanted] > 0));
      }
    }
  }
}

TEST_CASE("shade normal: each face -> its direction, -1..1 as 0..255") {
  const Camera camera = camera_along_x();
  Shading shading;
  shading.mode = ShadeMode::kNormal;
  const auto color = [&](int axis, const Vec3i& direction) {
    return shade(hit_on(axis), {{}, direction}, camera, shading);
  };
  CHECK(color(0, {1, 1, 1}) == Rgb8{0, 128, 128});
  CHECK(color(0, {-1, 1, 1}) == Rgb8{255, 128, 128});
  CHECK(color(1, {1, 1, 1}) == Rgb8{128, 0, 128});
  CHECK(color(1, {1, -1, 1}) == Rgb8{128, 255, 128});
  CHECK(color(2, {1, 1, 1}) == Rgb8{128, 128, 0});
  CHECK(color(2, {1, 1, -1}) == Rgb8{128, 128, 255});
  CHECK(color(-1, {1, 1, -2}) == Rgb8{128, 128, 255});
}

TEST_CASE(
    "shade color: material -> its palette entry, beyond the palette the default, times the face's light") {
  const Camera camera = camera_along_x();
  const Rgb8 palette[] = {{10, 20, 30}, {200, 100, 50}};
  Shading shading;
  shading.mode = ShadeMode::kColor;
  shading.palette = Span<const Rgb8>(palette);
  shading.default_color = {1, 2, 3};
  for (int face = 0; face < 6; ++face) {
    shading.face_light[face] = 256;
  }
  const auto color = [&](int material, const Vec3i& direction) {
    Hit hit = hit_on(0);
    hit.material = static_cast<std::uint8_t>(material);
    return shade(hit, {{}, direction}, camera, shading);
  };
  CHECK(color(0, {1, 0, 0}) == palette[0]);
  CHECK(color(1, {1, 0, 0}) == palette[1]);
  CHECK(color(2, {1, 0, 0}) == Rgb8{1, 2, 3});
  CHECK(color(255, {1, 0, 0}) == Rgb8{1, 2, 3});
  shading.face_light[0] = 128;  // -x, which a ray towards +x sees
  CHECK(color(1, {1, 0, 0}) == Rgb8{100, 50, 25});
  CHECK(color(1, {-1, 0, 0}) == palette[1]);
  shading.face_light[0] = 700;  // clamped, not wrapped
  CHECK(color(1, {1, 0, 0}) == Rgb8{255, 255, 136});
  shading.face_light[0] = 65535;
  CHECK(color(1, {1, 0, 0}) == Rgb8{255, 255, 255});
  shading.face_light[0] = 0;
  CHECK(color(1, {1, 0, 0}) == Rgb8{0, 0, 0});
  shading.palette = {};
  CHECK(color(0, {-1, 0, 0}) == Rgb8{1, 2, 3});
}

TEST_CASE("shade: a miss or a stopped ray -> the background; mono -> black and white") {
  const Camera camera = camera_along_x();
  Shading shading;
  shading.background = {9, 8, 7};
  const Ray ray{{}, {255, 0, 0}};
  Hit stopped;
  stopped.kind = HitKind::kStepLimit;
  for (const ShadeMode mode : {ShadeMode::kDepth, ShadeMode::kNormal, ShadeMode::kColor}) {
    shading.mode = mode;
    CHECK(shade(Hit{}, ray, camera, shading) == Rgb8{9, 8, 7});
    CHECK(shade(stopped, ray, camera, shading) == Rgb8{9, 8, 7});
  }
  shading.mode = ShadeMode::kMono;
  CHECK(shade(Hit{}, ray, camera, shading) == Rgb8{0, 0, 0});
  CHECK(shade(stopped, ray, camera, shading) == Rgb8{0, 0, 0});
  CHECK(shade(hit_at(5), ray, camera, shading) == Rgb8{255, 255, 255});
}
