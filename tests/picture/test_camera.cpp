// The promises of camera.h one by one. How far rays and depths are from the ideal camera's is swept by
// tools/instruments/operation_errors.cpp, which test_hard_cases runs.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "../../src/base/wide_arithmetic.h"
#include "../../src/picture/cotangent.h"
#include "portable/scene.h"
#include "support/counts.h"
#include "thimble/picture/camera.h"
#include "thimble/trace/ray.h"

namespace thimble::tools {
namespace {

using portable::simple_orthographic;
using portable::simple_perspective;

using Real = long double;
using Real3 = std::array<Real, 3>;

const int kCameras = thimble::tests::many_or_few(20000, 1000);

Real dot(const Real3& a, const Real3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Real3 cross(const Real3& a, const Real3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Real3 unit(const Real3& a) {
  const Real length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}
Real3 real(const Vec3i& a) {
  return {Real(a.x), Real(a.y), Real(a.z)};
}

struct Axes {
  Real3 forward, right, up;
  template <class View>
  explicit Axes(const View& view) : forward(unit(real(view.forward))) {
    right = unit(cross(forward, real(view.up == Vec3i{} ? default_up(view.forward) : view.up)));
    up = cross(right, forward);
  }
};

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  std::int32_t whole(std::int32_t low, std::int32_t high) {
    return std::uniform_int_distribution<std::int32_t>(low, high)(engine_);
  }
  /// Log-uniform, low .. high.
  std::int32_t log_whole(std::int32_t low, std::int32_t high) {
    const double value = std::uniform_real_distribution<double>(std::log(low), std::log(high + 1.0))(engine_);
    return std::clamp(static_cast<std::int32_t>(std::exp(value)), low, high);
  }
  /// Vectors of all lengths, with zero, equal and nearly parallel components now and then.
  Vec3i vector() {
    Vec3i result;
    do {
      const std::int32_t size = log_whole(1, kMaxViewComponent);
      for (int axis = 0; axis < 3; ++axis) {
        result[axis] = whole(0, 9) == 0 ? 0 : whole(0, 9) == 0 ? size : whole(-size, size);
      }
    } while (result == Vec3i{});
    return result;
  }
  Vec3Q8 eye(int level) {
    Vec3Q8 result;
    for (int axis = 0; axis < 3; ++axis) {
      result[axis] = Q8::from_raw(whole(-4 * (256 << level), 5 * (256 << level)));
    }
    return result;
  }
  /// Corners of the picture, then pixels anywhere.
  std::vector<std::array<int, 2>> pixels(int width, int height, int count) {
    std::vector<std::array<int, 2>> result{{0, 0}, {width - 1, 0}, {0, height - 1}, {width - 1, height - 1}};
    for (int index = 0; index < count; ++index) {
      result.push_back({whole(0, width - 1), whole(0, height - 1)});
    }
    return result;
  }

 private:
  std::mt19937 engine_;
};

PerspectiveView random_perspective(Random& random, int level) {
  PerspectiveView view;
  view.eye = random.eye(level);
  view.forward = random.whole(0, 3) == 0 ? look_at(view.eye, random.eye(level)) : random.vector();
  view.up = random.whole(0, 2) == 0 ? Vec3i{} : random.vector();
  view.fov_degrees = Q16::from_raw(random.whole(0, 7) == 0 ? (random.whole(0, 1) == 0 ? kMinFov : kMaxFov).raw
                                                           : random.whole(kMinFov.raw, kMaxFov.raw));
  const std::int32_t most_px = random.whole(0, 7) == 0 ? kMaxPicturePx : 2000;
  view.width_px = random.log_whole(1, most_px);
  view.height_px = random.log_whole(1, most_px);
  return view;
}

OrthographicView random_orthographic(Random& random, int level) {
  OrthographicView view;
  view.eye = random.eye(level);
  view.forward = random.whole(0, 3) == 0 ? look_at(view.eye, random.eye(level)) : random.vector();
  view.up = random.whole(0, 2) == 0 ? Vec3i{} : random.vector();
  const std::int32_t most_px = random.whole(0, 7) == 0 ? kMaxPicturePx : 2000;
  view.width_px = random.log_whole(1, most_px);
  view.height_px = random.log_whole(1, most_px);
  view.span = Q14::from_raw(random.log_whole(1 << 12, (1 << level) * 16384));
  return view;
}

template <class View>
Camera made(const View& view, int level = 6) {
  Camera camera;
  REQUIRE(camera.set(view, level) == Status::kOk);
  return camera;
}

// All rays are accepted, as given bits are kept and others hold 1/8 pixel. -> the largest component of a direction.
template <class View>
std::int32_t check_rays(Random& random, const View& view, const Camera& camera, int level) {
  if (view.direction_bits == 0) {
    REQUIRE(camera.error_bound_px_q16() <= 8192);
  } else {
    REQUIRE(camera.direction_bits() == view.direction_bits);
  }
  std::int32_t seen = 0;
  for (const auto& [px, py] : random.pixels(view.width_px, view.height_px, 12)) {
    const Ray ray = camera.ray(px, py);
    REQUIRE(check_ray(ray, level) == Status::kOk);
    for (int axis = 0; axis < 3; ++axis) {
      seen = std::max(seen, std::abs(ray.direction[axis]));
    }
  }
  return seen;
}

}  // namespace

TEST_CASE("wide arithmetic: random operands -> quotients, roots and products of the compiler") {
  Random random(1);
  for (int count = 0; count < kCameras; ++count) {
    const auto wide = [&random] {
      const std::uint64_t low = static_cast<std::uint32_t>(random.whole(INT32_MIN, INT32_MAX));
      const std::uint64_t high = static_cast<std::uint32_t>(random.whole(INT32_MIN, INT32_MAX));
      return ((high << 32) | low) >> random.whole(0, 63);
    };
    const std::uint64_t a = wide();
    const std::uint64_t b = std::min(wide() + 1, std::uint64_t{1} << 63);
    CHECK(divide(a, b) == a / b);
    CHECK(bit_width(a) == static_cast<int>(a == 0 ? 0 : 64 - __builtin_clzll(a)));
    const std::uint64_t half = a >> 1;
    const Real root = std::sqrt(Real(half));
    CHECK(std::abs(Real(square_root_rounded(half)) - root) <= 0.5000001L);
    const std::uint32_t factor = static_cast<std::uint32_t>(b);
    const int shift = random.whole(42, 80);
    CHECK(std::abs(Real(multiply_shifted(half, factor, shift)) -
                   std::ldexp(Real(half) * Real(factor), -shift)) <=
          0.5011L + Real(half) * Real(factor) * std::ldexp(1.0L, -shift - 62));
  }
  CHECK(divide(0, 1) == 0);
  CHECK(divide(UINT64_MAX, 1) == UINT64_MAX);
  CHECK(divide(UINT64_MAX, std::uint64_t{1} << 63) == 1);
  CHECK(square_root_rounded(0) == 0);
  CHECK(square_root_rounded(2) == 1);
  CHECK(square_root_rounded(3) == 2);
  CHECK(square_root_rounded(UINT64_MAX - UINT32_MAX) == UINT32_MAX);
}

TEST_CASE("cotangent: every 1/256 degree from 1 to 120 -> relative error below 2^-28") {
  Real worst = 0;
  for (std::int32_t raw = kMinFov.raw; raw <= kMaxFov.raw; raw += 256) {
    const Real exact = 1 / std::tan(Real(raw) / 65536 / 360 * std::acos(Real(-1)));
    const Real mine = Real(half_angle_cotangent_q39(Q16::from_raw(raw))) / 549755813888.0L;
    worst = std::max(worst, std::abs(mine / exact - 1));
  }
  MESSAGE("worst relative error: 2^", static_cast<double>(std::log2(worst)));
  CHECK(worst < std::ldexp(1.0L, -28));
}

TEST_CASE(
    "camera: random perspective views -> rays that use all bits, accepted; kTooFine and parallel ups as they "
    "are") {
  Random random(20240);
  int made_count = 0;
  for (int count = 0; count < kCameras; ++count) {
    CAPTURE(count);
    const int level = random.whole(kMinLevel, kMaxLevel);
    PerspectiveView view = random_perspective(random, level);
    view.direction_bits = random.whole(0, 3) == 0 ? random.whole(kMinDirectionBits, kMaxDirectionBits) : 0;
    Camera camera;
    const Status status = camera.set(view, level);
    if (status == Status::kTooFine) {
      if (view.direction_bits == 0) {
        // 20 bits as given are coarser than 1/8 pixel indeed, as far as the bound says.
        view.direction_bits = kMaxDirectionBits;
        if (camera.set(view, level) == Status::kOk) {
          CHECK(camera.error_bound_px_q16() > 8192);
        }
      }
    } else if (status == Status::kBadArgument) {  // up happens to be parallel
      const Real cosine = dot(unit(real(view.up)), unit(real(view.forward)));
      CHECK(cosine * cosine > 0.999999L);
    } else {
      REQUIRE(status == Status::kOk);
      ++made_count;
      REQUIRE(check_rays(random, view, camera, level) == (1 << camera.direction_bits()) - 1);
      // Set-up alone: how far unrounded directions are from the ideal ones' lines, and along forward from depth_per_t.
      const Axes axes(view);
      const Real angle = Real(view.fov_degrees.raw) / 65536 / 360 * std::acos(Real(-1));
      const Real focal = Real(view.height_px) / 2 / std::tan(angle);
      const Camera::Affine& affine = camera.affine();
      for (const auto& [px, py] : random.pixels(view.width_px, view.height_px, 2)) {
        Real3 exact{};
        Real3 ideal{};
        for (int axis = 0; axis < 3; ++axis) {
          const auto at = static_cast<std::size_t>(axis);
          exact[at] =
              Real(affine.base[axis] + px * affine.step_x[axis] + py * affine.step_y[axis]) / 4294967296.0L;
          ideal[at] = focal * axes.forward[at] +
                      (Real(px) + 0.5L - Real(view.width_px) / 2) * axes.right[at] +
                      (Real(view.height_px) / 2 - 0.5L - Real(py)) * axes.up[at];
        }
        const Real3 across = cross(unit(ideal), exact);
        REQUIRE(std::sqrt(dot(across, across)) < 0.0245L);
        REQUIRE(std::abs(dot(exact, axes.forward) * 256 - camera.depth_per_t_q8()) <= 4);
      }
    }
  }
  CHECK(made_count > kCameras / 2);
}

TEST_CASE("camera: random orthographic views -> accepted; out of range and too fine where they are") {
  Random random(77);
  int made_count = 0;
  int too_fine = 0;
  int out_of_range = 0;
  for (int count = 0; count < kCameras; ++count) {
    CAPTURE(count);
    const int level = random.whole(kMinLevel, kMaxLevel);
    OrthographicView view = random_orthographic(random, level);
    view.direction_bits = random.whole(0, 3) == 0 ? random.whole(kMinDirectionBits, kMaxDirectionBits) : 0;
    Camera camera;
    const Status status = camera.set(view, level);
    if (status == Status::kOutOfRange) {
      ++out_of_range;
      const Axes axes(view);
      const Real pitch = Real(view.span.raw) / 16384 / view.width_px;
      Real most = 0;  // how far a corner's origin lies outside
      for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        const Real reach =
            (std::abs(axes.right[at]) * (view.width_px - 1) + std::abs(axes.up[at]) * (view.height_px - 1)) *
            pitch / 2;
        const Real eye = Real(view.eye[axis].raw) / 256;
        const Real world = Real(1 << level);
        most = std::max({most, eye + reach - 5 * world, -4 * world - (eye - reach)});
      }
      CHECK(most > -0.01L);
    } else if (status == Status::kTooFine) {
      ++too_fine;
      CHECK(view.span < least_orthographic_span(view.width_px, level));
    } else if (status != Status::kBadArgument) {
      REQUIRE(status == Status::kOk);
      ++made_count;
      (void)check_rays(random, view, camera, level);
    }
  }
  CHECK(made_count > kCameras / 4);
  CHECK(too_fine > 0);
  CHECK(out_of_range > 0);
}

TEST_CASE("camera: pictures finer and finer -> kOk up to 1/8 pixel, kTooFine from there") {
  // Perspective: 1 degree over more and more rows.
  PerspectiveView view = simple_perspective();
  view.forward = {3, 2, -1};
  view.fov_degrees = Q16::saturate(1);
  view.width_px = 1;
  int last = 0;
  Camera camera;
  for (int height = 1; height <= kMaxPicturePx; ++height) {
    view.height_px = height;
    const Status status = camera.set(view, 8);
    if (status == Status::kOk) {
      CHECK(last == height - 1);
      CHECK(camera.error_bound_px_q16() <= 8192);
      last = height;
    } else {
      CHECK(status == Status::kTooFine);
    }
  }
  MESSAGE("1 degree: up to ", last, " rows");
  CHECK(last > 2000);
  CHECK(last < 6000);
  view.height_px = last + 1;
  view.direction_bits = 20;  // as given: coarse, but said so
  CHECK(camera.set(view, 8) == Status::kOk);
  CHECK(camera.error_bound_px_q16() > 8192);
  // A picture so wide and low that 8 bits leave nothing of the forward component.
  view.fov_degrees = kMaxFov;
  view.height_px = 1;
  view.width_px = 2000;
  view.direction_bits = 8;
  CHECK(camera.set(view, 8) == Status::kTooFine);

  // Orthographic: the stated least span is enough from everywhere; half of it is not from afar; 6/256 voxel a
  // pixel never is.
  Random random(9);
  for (int count = 0; count < 500; ++count) {
    const int level = random.whole(6, 12);
    OrthographicView parallel = simple_orthographic();
    const std::int32_t far = 5 << level;
    parallel.eye = {Q8::saturate(far - (1 << (level - 3))), Q8::saturate(far - (1 << (level - 3))),
                    Q8::saturate(far - (1 << (level - 3)))};
    parallel.forward = {-1000 - random.whole(0, 50), -1000 - random.whole(0, 50),
                        -1000 - random.whole(0, 50)};
    parallel.width_px = random.log_whole(1, 300);
    parallel.height_px = 1;
    parallel.span = least_orthographic_span(parallel.width_px, level);
    CHECK(camera.set(parallel, level) == Status::kOk);
    CHECK(camera.error_bound_px_q16() <= 8192);
    parallel.span = Q14::from_raw(parallel.width_px * 6 * 64);
    CHECK(camera.set(parallel, level) == Status::kTooFine);
    parallel.direction_bits = 12;
    CHECK(camera.set(parallel, level) == Status::kTooFine);
    parallel.span = Q14::from_raw(parallel.width_px * 8 * 64);
    CHECK(camera.set(parallel, level) == Status::kOk);
    CHECK(camera.direction_bits() == 12);
  }
}

TEST_CASE("camera: automatic bits -> the fewest that bound the error by 1/16 pixel") {
  Random random(11);
  for (int count = 0; count < 500; ++count) {
    const int level = random.whole(1, 12);
    PerspectiveView view = random_perspective(random, level);
    Camera camera;
    if (camera.set(view, level) != Status::kOk) {
      continue;
    }
    const int bits = camera.direction_bits();
    const std::uint32_t bound = camera.error_bound_px_q16();
    CHECK((bound <= 4098 || bits == kMaxDirectionBits));
    if (bits > kMinDirectionBits) {
      view.direction_bits = bits - 1;
      if (camera.set(view, level) == Status::kOk) {
        CHECK(camera.error_bound_px_q16() > 4096);
      }
    }
  }
  // In small pictures one unit more or less of what is bounded changes the number of bits.
  PerspectiveView view = simple_perspective();
  view.forward = {-3, -2, -1};
  view.width_px = 16;
  for (view.height_px = 8; view.height_px <= 40; view.height_px += 8) {
    for (view.fov_degrees = kMinFov; view.fov_degrees <= kMaxFov;
         view.fov_degrees = Q16::from_raw(view.fov_degrees.raw + 1001)) {
      CAPTURE(view.fov_degrees.raw);
      CHECK(made(view, 10).error_bound_px_q16() <= 4096);
    }
  }
  view.fov_degrees = Q16::saturate(60);
  view.width_px = 800;
  view.height_px = 600;
  const Camera large = made(view, 10);
  view.width_px = 128;
  view.height_px = 64;
  const Camera small = made(view, 10);
  MESSAGE("800 x 600 at 60 degrees: ", large.direction_bits(), " bits; 128 x 64: ", small.direction_bits());
}

}  // namespace thimble::tools
