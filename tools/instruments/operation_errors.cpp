#include "instruments/hard_cases.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <type_traits>

#include "readers/real3.h"
#include "thimble/base/vec.h"
#include "thimble/light/host/optics.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {
namespace {

// ---- What sweeps of fixed-point operations share: exact arithmetic (long double stands in for it), random
// integers, and an operation's entry.

using Real = long double;
using Exact3 = std::array<Real, 3>;  // with the products of readers/real3.h

constexpr Real kPi = 3.14159265358979323846264338327950288L;

/// What a sweep has found.
struct Found {
  Real error = 0;
  std::uint64_t cases = 0;
  bool is_all = false;  ///< there are no others

  void see(Real error_seen) {
    error = std::max(error, std::abs(error_seen));
    ++cases;
  }
};

Exact3 real(const Vec3i& v) {
  return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}
Exact3 real(const Vec3Q8& v) {
  return {v.x.raw / 256.0L, v.y.raw / 256.0L, v.z.raw / 256.0L};
}
Exact3 unit(const Exact3& a) {
  const Real length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}
/// a + b * factor
Exact3 along(const Exact3& a, const Exact3& b, Real factor) {
  return {a[0] + b[0] * factor, a[1] + b[1] * factor, a[2] + b[2] * factor};
}
Real length(const Exact3& a) {
  return std::sqrt(dot(a, a));
}

/// Components of up to `bits` bits, some of them 0, not all.
Vec3i any_vector(Draw& draw, int bits) {
  Vec3i vector;
  while (vector == Vec3i{}) {
    for (int axis = 0; axis < 3; ++axis) {
      vector[axis] = draw.from(0, 7) == 0 ? 0 : static_cast<std::int32_t>(draw.sign()) * draw.any_size(bits);
    }
  }
  return vector;
}

struct Operation {
  const char* name;
  const char* bound_name;
  const char* unit;
  double bound;
  void (*sweep)(Draw& draw, Found* found);  ///< looks at some cases more
};

// ---- The operations of optics.h against exact arithmetic.

Real angle_urad(const Exact3& a, const Exact3& b) {
  return 1e6L * std::atan2(length(cross(a, b)), dot(a, b));
}

// How far a direction of `change` is from the one that it was made of.
template <Vec3i (*change)(const Vec3i&)>
void turned_by(Draw& draw, Found* found) {
  const Vec3i direction = any_vector(draw, 20);
  found->see(angle_urad(real(direction), real(change(direction))));
}

void unit_lengths(Draw& draw, Found* found) {
  found->see(length(real(unit_q14(any_vector(draw, 20)))) - kUnitQ14);
}

void reflections(Draw& draw, Found* found) {
  const Vec3i direction = unit_q14(any_vector(draw, 20));
  const Vec3i normal = unit_q14(any_vector(draw, 20));
  const Exact3 d = real(direction);
  const Exact3 n = real(normal);
  const Exact3 exact = along(d, n, -2 * dot(d, n) / dot(n, n));
  found->see(angle_urad(exact, real(reflect(direction, normal))));
}

Vec3i rounded(const Exact3& v) {
  return {static_cast<std::int32_t>(std::lround(v[0])), static_cast<std::int32_t>(std::lround(v[1])),
          static_cast<std::int32_t>(std::lround(v[2]))};
}

// A direction near the critical angle, if there is one, or near grazing.
Vec3i near_critical(Draw& draw, const Vec3i& normal, std::uint32_t eta) {
  const Exact3 n = unit(real(normal));
  for (;;) {
    const Exact3 other = real(any_vector(draw, 14));
    const Exact3 side = along(other, n, -dot(other, n));
    if (length(side) < 100) {
      continue;
    }
    const Real critical = std::min(Real{1}, 4096 / static_cast<Real>(eta));
    const Real sine = std::min(Real{1}, critical + static_cast<Real>(draw.from(-9, 9)) / 10000);
    const Exact3 across = unit(side);
    const Real cosine = std::sqrt(1 - sine * sine);
    return rounded(along(scaled(across, sine * kUnitQ14), n, cosine * kUnitQ14));
  }
}

// Snell's law for the very integers given; only where light goes through.
Exact3 snell(const Vec3i& direction, const Vec3i& normal, std::uint32_t eta) {
  const Exact3 d = real(direction);
  const Exact3 n = unit(real(normal));
  const Real ratio = static_cast<Real>(eta) / 4096;
  const Real before = dot(d, n);
  const Exact3 sideways = along(d, n, -before);
  const Real square = dot(d, d) - ratio * ratio * dot(sideways, sideways);
  const Real after = std::sqrt(std::max(square, Real{0}));
  return along(scaled(sideways, ratio), n, before < 0 ? -after : after);
}

template <bool bent>
void refractions(Draw& draw, Found* found) {
  const int axis = draw.from32(0, 2);
  Vec3i normal;
  normal[axis] = kUnitQ14;
  if (bent) {
    normal = unit_q14(any_vector(draw, 20));
  }
  const auto eta = static_cast<std::uint32_t>(draw.from(kMinEtaQ12, kMaxEtaQ12));
  const Vec3i direction =
      draw.from(0, 3) == 0 ? near_critical(draw, normal, eta) : unit_q14(any_vector(draw, 20));
  Vec3i out;
  const bool through = bent ? refract(direction, normal, eta, &out) : refract(direction, axis, eta, &out);
  // What lies so near the critical angle that the two disagree is for the tests of the inequality.
  if (through && eta != kOneQ12) {
    found->see(angle_urad(snell(direction, normal, eta), real(out)));
  }
}

void normal_shares(Draw& draw, Found* found) {
  const auto a = static_cast<std::uint32_t>(draw.from(1, 65535));
  const auto b = static_cast<std::uint32_t>(draw.from(1, 65535));
  const Real ratio = (static_cast<Real>(a) - static_cast<Real>(b)) / static_cast<Real>(a + b);
  found->see(static_cast<Real>(r0_q16(a, b)) - 65536 * ratio * ratio);
}

void fresnel_shares(Draw& draw, Found* found) {
  const std::int32_t cosine = draw.from32(0, kUnitQ14);
  const auto normal = static_cast<std::uint32_t>(draw.from(1, 65536));
  const Real share = static_cast<Real>(normal) / 65536;
  const Real exact = share + (1 - share) * std::pow(1 - static_cast<Real>(cosine) / kUnitQ14, Real{5});
  found->see(static_cast<Real>(fresnel_q16(cosine, normal)) - 65536 * exact);
}

void transmittances(Draw& draw, Found* found) {
  const auto halvings = static_cast<std::uint32_t>(draw.from(0, 18 << 16));
  found->see(static_cast<Real>(transmittance_q16(halvings)) -
             65536 * std::exp2(-static_cast<Real>(halvings) / 65536));
}

void distances(Draw& draw, Found* found) {
  const Vec3i direction = any_vector(draw, 20);
  const int axis = draw.from32(0, 2);
  const std::int32_t numerator = draw.from32(0, std::int64_t{1} << draw.from(0, 24));
  if (direction[axis] == 0) {
    return;
  }
  const std::int32_t denominator = 256 * std::abs(direction[axis]);
  const Real exact = length(real(direction)) * numerator * 256 / denominator;
  // Beyond what an answer can say it is clamped; the half unit of rounding is allowed besides.
  if (exact < INT32_MAX) {
    const Real off = std::abs(static_cast<Real>(distance_q8(direction, numerator, denominator)) - exact);
    found->see(std::max(Real{0}, off - 0.501L) / std::max(exact, Real{1}) * 1e6L);
  }
}

// --- Cameras.

struct Axes {
  Exact3 forward;
  Exact3 right;
  Exact3 up;
  Axes(const Vec3i& forward_view, const Vec3i& up_view) {
    forward = unit(real(forward_view));
    right = unit(cross(forward, real(up_view)));
    up = cross(right, forward);
  }
};

template <class View>
struct Seen {
  View view;
  Camera camera;
  int level = 0;
};
// Random cameras with automatic bits, or with any; those that cannot be are drawn again.
template <class View>
Seen<View> any_camera(Draw& draw, bool gives_bits = false) {
  constexpr bool kIsPinhole = std::is_same_v<View, PerspectiveView>;
  for (;;) {
    Seen<View> made;
    made.level = draw.from32(kMinLevel, kMaxLevel);
    const std::int64_t world = std::int64_t{Q8::kOne} << made.level;
    for (int axis = 0; axis < 3; ++axis) {
      made.view.eye[axis] = Q8::from_raw(draw.from32(-4 * world, 5 * world));
    }
    made.view.forward = any_vector(draw, 30);
    made.view.up = default_up(made.view.forward);
    made.view.direction_bits = gives_bits ? draw.from32(kMinDirectionBits, kMaxDirectionBits) : 0;
    if constexpr (kIsPinhole) {
      made.view.fov_degrees = Q16::from_raw(draw.from32(kMinFov.raw, kMaxFov.raw));
    }
    made.view.width_px = draw.any_size(11);
    made.view.height_px = draw.any_size(11);
    if constexpr (!kIsPinhole) {
      made.view.span = Q14::from_raw(draw.any_size(31));
    }
    if (made.camera.set(made.view, made.level) == Status::kOk) {
      return made;
    }
  }
}
// The picture's corners, then pixels anywhere.
struct Pixel {
  std::int32_t x;
  std::int32_t y;
};
template <class View>
Pixel pixel_of(Draw& draw, const View& view, int number) {
  if (number < 4) {
    return {(number % 2) * (view.width_px - 1), (number / 2) * (view.height_px - 1)};
  }
  const std::int32_t x = draw.from32(0, view.width_px - 1);
  return {x, draw.from32(0, view.height_px - 1)};
}

constexpr int kPixelsACamera = 16;

// In 1/65536 pixel; of the bound that a camera states itself, where its bits are given.
double ray_unit(const Camera& camera, bool gives_bits) {
  return gives_bits ? camera.error_bound_px_q16() : 1;
}

template <bool kGivesBits>
void perspective_rays(Draw& draw, Found* found) {
  const auto made = any_camera<PerspectiveView>(draw, kGivesBits);
  const Axes axes(made.view.forward, made.view.up);
  const Real focal = made.view.height_px / 2.0L /
                     std::tan(static_cast<Real>(made.view.fov_degrees.raw) / Q16::kOne * kPi / 360);
  for (int i = 0; i < kPixelsACamera; ++i) {
    const auto [x, y] = pixel_of(draw, made.view, i);
    const Real across = x - (made.view.width_px - 1) / 2.0L;
    const Real above = (made.view.height_px - 1) / 2.0L - y;
    const Exact3 direction = real(made.camera.ray(x, y).direction);
    const Real depth = dot(direction, axes.forward);
    const Real off_x = focal * dot(direction, axes.right) / depth - across;
    const Real off_y = focal * dot(direction, axes.up) / depth - above;
    found->see(std::hypot(off_x, off_y) * 65536 / static_cast<Real>(ray_unit(made.camera, kGivesBits)));
  }
}

template <bool kGivesBits>
void parallel_rays(Draw& draw, Found* found) {
  const auto made = any_camera<OrthographicView>(draw, kGivesBits);
  const Axes axes(made.view.forward, made.view.up);
  const Real pixel = static_cast<Real>(made.view.span.raw) / Q14::kOne / made.view.width_px;
  const Exact3 eye = real(made.view.eye);
  Real furthest = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Exact3 point{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] = ((corner >> axis) & 1U) != 0 ? static_cast<Real>(std::int64_t{1} << made.level) : 0;
    }
    furthest = std::max(furthest, dot(along(point, eye, -1), axes.forward));
  }
  for (int i = 0; i < kPixelsACamera; ++i) {
    const auto [x, y] = pixel_of(draw, made.view, i);
    const Real across = (x - (made.view.width_px - 1) / 2.0L) * pixel;
    const Real above = ((made.view.height_px - 1) / 2.0L - y) * pixel;
    const Ray ray = made.camera.ray(x, y);
    const Exact3 origin = real(ray.origin);
    const Exact3 direction = real(ray.direction);
    for (const Real depth : {0.0L, furthest}) {
      const Exact3 start = along(origin, eye, -1);
      const Real t = (depth - dot(start, axes.forward)) / dot(direction, axes.forward);
      const Exact3 point = along(start, direction, t);
      found->see(std::hypot(dot(point, axes.right) - across, dot(point, axes.up) - above) / pixel * 65536 /
                 static_cast<Real>(ray_unit(made.camera, kGivesBits)));
    }
  }
}

// The length, along forward, of the camera's own unrounded direction in the middle of the picture.
void perspective_depth_per_t(Draw& draw, Found* found) {
  const auto made = any_camera<PerspectiveView>(draw);
  const Axes axes(made.view.forward, made.view.up);
  const Camera::Affine& affine = made.camera.affine();
  Exact3 middle{};
  for (int axis = 0; axis < 3; ++axis) {
    middle[static_cast<std::size_t>(axis)] =
        (static_cast<Real>(affine.base[axis]) +
         static_cast<Real>(affine.step_x[axis]) * (made.view.width_px - 1) / 2 +
         static_cast<Real>(affine.step_y[axis]) * (made.view.height_px - 1) / 2) /
        4294967296.0L;
  }
  found->see(made.camera.depth_per_t_q8() - 256 * dot(middle, axes.forward));
}

void parallel_depth_per_t(Draw& draw, Found* found) {
  const auto made = any_camera<OrthographicView>(draw);
  const Axes axes(made.view.forward, made.view.up);
  found->see(made.camera.depth_per_t_q8() - 256 * dot(real(made.camera.direction()), axes.forward));
}

// --- Shading.

// At any distance, by a component of the direction that is not so small that the depth would be clamped.
Hit any_hit(Draw& draw) {
  Hit hit;
  hit.kind = HitKind::kHit;
  hit.axis = 0;
  hit.t_numerator = draw.any_size(23);
  hit.t_denominator = 256 * draw.any_size(20);
  return hit;
}

// In units of the bound, which has two parts.
void planar_depths(Draw& draw, Found* found) {
  const auto made = any_camera<PerspectiveView>(draw);
  for (int i = 0; i < kPixelsACamera; ++i) {
    const Hit hit = any_hit(draw);
    const Real exact = static_cast<Real>(hit.t_numerator) * made.camera.depth_per_t_q8() / hit.t_denominator;
    if (exact < INT32_MAX) {
      const Real bound = exact / (1 << kPlanarDepthErrorShift) + kPlanarDepthErrorQ8;
      found->see((planar_depth_q8(hit, made.camera) - exact) / bound);
    }
  }
}

void depth_shades(Draw& draw, Found* found) {
  const auto made = any_camera<PerspectiveView>(draw);
  for (int i = 0; i < kPixelsACamera; ++i) {
    const Hit hit = any_hit(draw);
    Shading shading;
    shading.near_q8 = draw.from32(0, 1) == 0 ? 0 : draw.any_size(28);
    shading.far_q8 = shading.near_q8 + draw.any_size(29);
    const std::int32_t depth = planar_depth_q8(hit, made.camera);
    const Real part =
        (static_cast<Real>(depth) - shading.near_q8) / (static_cast<Real>(shading.far_q8) - shading.near_q8);
    const Real exact = 255 - (255 - kFarBrightness) * std::clamp(part, 0.0L, 1.0L);
    found->see((shade(hit, {}, made.camera, shading).r - exact) * 256);
  }
}

void face_lights(Draw& draw, Found* found) {
  const Vec3i toward = any_vector(draw, 14);
  std::uint16_t light[6];
  light_from(toward, light);
  const Exact3 direction = unit(real(toward));
  for (std::size_t face = 0; face < 6; ++face) {
    const Real cosine = (face % 2 == 0 ? -1 : 1) * direction[face / 2];
    found->see(light[face] - (141 + 115 * cosine));
  }
}

void lit_channels(Draw& /*draw*/, Found* found) {
  const Camera camera;
  for (int albedo = 0; albedo < 256; ++albedo) {
    for (int light = 0; light <= 256; ++light) {
      const Rgb8 color{static_cast<std::uint8_t>(albedo), 0, 0};
      Shading shading;
      shading.mode = ShadeMode::kColor;
      shading.palette = Span<const Rgb8>(&color, 1);
      shading.face_light[1] = static_cast<std::uint16_t>(light);
      Hit hit;
      hit.kind = HitKind::kHit;
      hit.axis = 0;
      Ray ray;
      ray.direction = {-1, 0, 0};
      found->see(shade(hit, ray, camera, shading).r - albedo * light / 256.0L);
    }
  }
  found->is_all = true;
}

// --- Pixels and numbers.

void grays(Draw& /*draw*/, Found* found) {
  constexpr int kStep = 5;  // 52 values a channel, both ends among them
  for (int r = 0; r < 256; r += kStep) {
    for (int g = 0; g < 256; g += kStep) {
      for (int b = 0; b < 256; b += kStep) {
        const Rgb8 color{static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                         static_cast<std::uint8_t>(b)};
        found->see(gray_of(color) - (0.299L * r + 0.587L * g + 0.114L * b));
      }
    }
  }
  found->is_all = true;
}

void rgb565(Draw& /*draw*/, Found* found) {
  for (int value = 0; value < 256; ++value) {
    std::uint8_t row[2] = {};
    store_pixel(row, 0, 0, PixelFormat::kRgb565, {static_cast<std::uint8_t>(value), 0, 0});
    found->see((row[1] >> 3 << 3) - value);
  }
  found->is_all = true;
}

template <int kBits>
void see_fixed(Draw& draw, Found* found) {
  using Number = Fixed<kBits>;
  const std::int32_t whole = draw.from32(-Number::kMaxWhole - 1, Number::kMaxWhole);
  found->see(static_cast<Real>(Number::saturate(whole).raw) / Number::kOne - whole);
  const Number any = Number::from_raw(draw.from32(INT32_MIN, INT32_MAX));
  const Real value = static_cast<Real>(any.raw) / Number::kOne;
  found->see(any.floor() - std::floor(value));
  found->see(static_cast<Real>(any.fraction()) / Number::kOne - (value - std::floor(value)));
}
void fixed_numbers(Draw& draw, Found* found) {
  see_fixed<8>(draw, found);
  see_fixed<14>(draw, found);
  see_fixed<16>(draw, found);
}

// --- What is left out, and what is averaged.

void cutoff_reaches(Draw& draw, Found* found) {
  const auto made = any_camera<PerspectiveView>(draw);
  const Q16 pixels = Q16::from_raw(draw.any_size(25));
  Cutoff cutoff;
  if (cutoff.set(made.camera, pixels) != Status::kOk) {
    return;
  }
  const Camera::Vec3Q32& step = made.camera.affine().step_x;
  const Real width =
      length({static_cast<Real>(step.x), static_cast<Real>(step.y), static_cast<Real>(step.z)}) /
      4294967296.0L;
  for (int i = 0; i < kPixelsACamera; ++i) {
    const std::int32_t largest = draw.any_size(20);
    const Real exact = 256.0L * largest / (width * pixels.raw / Q16::kOne);
    if (exact < (1 << 24)) {  // beyond any distance that there is
      found->see(cutoff.reach_q8(largest) - exact);
    }
  }
}

// Of a tree of one node: all sums of colours that 1 .. 8 voxels can have.
void node_colors(Draw& draw, Found* found) {
  std::array<std::uint64_t, 8> keys{};
  std::array<Rgb8, 8> palette{};
  const auto count = static_cast<std::size_t>(draw.from(2, 8));
  std::array<Real, 3> sum{};
  for (std::size_t i = 0; i < count; ++i) {
    keys[i] = std::uint64_t{i} << 8 | i;
    palette[i] = {draw.byte(), draw.byte(), draw.byte()};
    sum = {sum[0] + palette[i].r, sum[1] + palette[i].g, sum[2] + palette[i].b};
  }
  std::array<std::uint8_t, 256> bytes{};
  std::array<std::uint8_t, 16> table{};
  CompactTree tree;
  NodeColors colors;
  if (CompactTree::make(Span<const std::uint64_t>(keys.data(), count), 1, {bytes.data(), bytes.size()},
                        &tree) != Status::kOk ||
      NodeColors::make(tree, {palette.data(), count}, {}, {table.data(), table.size()}, &colors) !=
          Status::kOk) {
    found->see(255);
    return;
  }
  const Rgb8 mean = colors.color(0);
  found->see(mean.r - sum[0] / static_cast<Real>(count));
  found->see(mean.g - sum[1] / static_cast<Real>(count));
  found->see(mean.b - sum[2] / static_cast<Real>(count));
}

void sample_means(Draw& draw, Found* found) {
  const int across = draw.from32(1, kMaxSamplesAcross);
  std::array<std::uint8_t, samples_bytes(1, kMaxSamplesAcross)> fine{};
  const std::size_t size = samples_bytes(1, across);
  Real sum = 0;
  for (std::size_t i = 0; i < size; ++i) {
    fine[i] = draw.byte();
    sum += i % 3 == 0 ? fine[i] : 0;
  }
  std::array<std::uint8_t, 3> row{};
  if (average_samples({fine.data(), size}, across, 1, 0, PixelFormat::kRgb888, {row.data(), row.size()}) !=
      Status::kOk) {
    found->see(65536);
    return;
  }
  found->see((row[0] - sum / (across * across)) * 256);
}

const Operation kOperations[] = {
    {"camera: perspective ray", "kRayErrorPxQ16", "1/65536 pixel", kRayErrorPxQ16, perspective_rays<false>},
    {"camera: orthographic ray", "kRayErrorPxQ16", "1/65536 pixel", kRayErrorPxQ16, parallel_rays<false>},
    {"camera: perspective, by bits", "error_bound_px_q16", "of its bound", 1, perspective_rays<true>},
    {"camera: orthographic, by bits", "error_bound_px_q16", "of its bound", 1, parallel_rays<true>},
    {"depth per t, perspective", "kDepthPerTErrorQ8", "1/256 direction unit", kDepthPerTErrorQ8,
     perspective_depth_per_t},
    {"depth per t, orthographic", "kDepthPerTErrorParallelQ8", "1/256 direction unit",
     kDepthPerTErrorParallelQ8, parallel_depth_per_t},
    {"planar_depth_q8", "kPlanarDepthError{Shift,Q8}", "of its bound", 1, planar_depths},
    {"shade: depth", "kDepthShadeErrorQ8", "1/256 of 1/255", kDepthShadeErrorQ8, depth_shades},
    {"light_from: face light", "kFaceLightError", "1/256", kFaceLightError, face_lights},
    {"shade: lit channel", "kLitChannelError", "1/255", kLitChannelError, lit_channels},
    {"gray_of", "kGrayError", "1/255", kGrayError, grays},
    {"store_pixel: kRgb565, 5 bits", "kRgb565Error", "1/255", kRgb565Error, rgb565},
    {"Fixed: whole numbers", "exact", "1", 0, fixed_numbers},
    {"Cutoff: reach", "kReachErrorQ8", "1/256 node side", kReachErrorQ8, cutoff_reaches},
    {"NodeColors: mean", "kNodeColorError", "1/255", kNodeColorError, node_colors},
    {"average_samples: mean", "kSampleMeanErrorQ8", "1/256 of 1/255", kSampleMeanErrorQ8, sample_means},
    // Those of thimble/light/host/optics.h.
    {"shorten", "kShortenErrorUrad", "10^-6 rad", kShortenErrorUrad, turned_by<shorten>},
    {"unit_q14: direction", "kUnitErrorUrad", "10^-6 rad", kUnitErrorUrad, turned_by<unit_q14>},
    {"unit_q14: length", "kUnitLengthError", "1/16384", kUnitLengthError, unit_lengths},
    {"reflect: bent normal", "kReflectErrorUrad", "10^-6 rad", kReflectErrorUrad, reflections},
    {"refract: at a face", "kRefractErrorUrad", "10^-6 rad", kRefractErrorUrad, refractions<false>},
    {"refract: bent normal", "kRefractErrorUrad", "10^-6 rad", kRefractErrorUrad, refractions<true>},
    {"r0_q16", "kNormalErrorQ16", "1/65536", kNormalErrorQ16, normal_shares},
    {"fresnel_q16", "kSchlickErrorQ16", "1/65536", kSchlickErrorQ16, fresnel_shares},
    {"transmittance_q16", "kTransmittanceErrorQ16", "1/65536", kTransmittanceErrorQ16, transmittances},
    {"distance_q8", "kDistanceErrorPpm", "1/1000000", kDistanceErrorPpm, distances},
};

}  // namespace

std::vector<OperationError> sweep_operations(std::uint64_t cases, std::uint64_t seed,
                                             const Progress& progress) {
  std::vector<OperationError> errors;
  for (const Operation& operation : kOperations) {
    Draw draw(seed);
    Found found;
    while (found.cases < cases && !found.is_all) {
      operation.sweep(draw, &found);
    }
    errors.push_back({operation.name, operation.bound_name, operation.unit, static_cast<double>(found.error),
                      operation.bound, found.cases});
    tell(progress, static_cast<double>(errors.size()) / static_cast<double>(std::size(kOperations)));
  }
  return errors;
}

}  // namespace thimble::tools
