#include "instruments/operation_errors.h"

#include "instruments/operation_sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <type_traits>

#include "thimble/base/vec.h"
#include "thimble/picture/camera.h"
#include "thimble/picture/cutoff.h"
#include "thimble/picture/pixel.h"
#include "thimble/picture/render.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {
namespace {

using namespace sweep;

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
using Pinhole = Seen<PerspectiveView>;
using Parallel = Seen<OrthographicView>;
// Random cameras with automatic bits; those that cannot be are drawn again.
template <class View>
Seen<View> any_camera(Draw& draw) {
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

Found perspective_rays(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Pinhole made = any_camera<PerspectiveView>(draw);
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
      found.see(std::hypot(off_x, off_y) * 65536);
    }
  }
  return found;
}

Found parallel_rays(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Parallel made = any_camera<OrthographicView>(draw);
    const Axes axes(made.view.forward, made.view.up);
    const Real pixel = static_cast<Real>(made.view.span.raw) / Q14::kOne / made.view.width_px;
    const Exact3 eye{made.view.eye.x.raw / 256.0L, made.view.eye.y.raw / 256.0L,
                     made.view.eye.z.raw / 256.0L};
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
      const Exact3 origin{ray.origin.x.raw / 256.0L, ray.origin.y.raw / 256.0L, ray.origin.z.raw / 256.0L};
      const Exact3 direction = real(ray.direction);
      for (const Real depth : {0.0L, furthest}) {
        const Exact3 start = along(origin, eye, -1);
        const Real t = (depth - dot(start, axes.forward)) / dot(direction, axes.forward);
        const Exact3 point = along(start, direction, t);
        found.see(std::hypot(dot(point, axes.right) - across, dot(point, axes.up) - above) / pixel * 65536);
      }
    }
  }
  return found;
}

// The length, along forward, of the camera's own unrounded direction in the middle of the picture.
Found perspective_depth_per_t(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Pinhole made = any_camera<PerspectiveView>(draw);
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
    found.see(made.camera.depth_per_t_q8() - 256 * dot(middle, axes.forward));
  }
  return found;
}

Found parallel_depth_per_t(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Parallel made = any_camera<OrthographicView>(draw);
    const Axes axes(made.view.forward, made.view.up);
    found.see(made.camera.depth_per_t_q8() - 256 * dot(real(made.camera.direction()), axes.forward));
  }
  return found;
}

// --- Shading.

// In units of the bound, which has two parts.
Found planar_depths(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Pinhole made = any_camera<PerspectiveView>(draw);
    for (int i = 0; i < kPixelsACamera; ++i) {
      Hit hit;
      hit.kind = HitKind::kHit;
      hit.axis = 0;
      hit.t_numerator = draw.any_size(23);
      // A component of the direction; not so small that the depth would be clamped.
      hit.t_denominator = 256 * draw.from32(1, (std::int64_t{1} << draw.from(1, 20)) - 1);
      const Real exact =
          static_cast<Real>(hit.t_numerator) * made.camera.depth_per_t_q8() / hit.t_denominator;
      if (exact < INT32_MAX) {
        const Real bound = exact / (1 << kPlanarDepthErrorShift) + kPlanarDepthErrorQ8;
        found.see((planar_depth_q8(hit, made.camera) - exact) / bound);
      }
    }
  }
  return found;
}

Found depth_shades(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Pinhole made = any_camera<PerspectiveView>(draw);
    for (int i = 0; i < kPixelsACamera; ++i) {
      Hit hit;
      hit.kind = HitKind::kHit;
      hit.axis = 0;
      hit.t_numerator = draw.any_size(23);
      hit.t_denominator = 256 * draw.any_size(20);
      Shading shading;
      shading.near_q8 = draw.from32(0, 1) == 0 ? 0 : draw.any_size(28);
      shading.far_q8 = shading.near_q8 + draw.any_size(29);
      const std::int32_t depth = planar_depth_q8(hit, made.camera);
      const Real part = (static_cast<Real>(depth) - shading.near_q8) /
                        (static_cast<Real>(shading.far_q8) - shading.near_q8);
      const Real exact = 255 - (255 - kFarBrightness) * std::clamp(part, 0.0L, 1.0L);
      found.see((shade(hit, {}, made.camera, shading).r - exact) * 256);
    }
  }
  return found;
}

Found face_lights(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Vec3i toward = any_vector(draw, 14);
    std::uint16_t light[6];
    light_from(toward, light);
    const Exact3 direction = unit(real(toward));
    for (std::size_t face = 0; face < 6; ++face) {
      const Real cosine = (face % 2 == 0 ? -1 : 1) * direction[face / 2];
      found.see(light[face] - (141 + 115 * cosine));
    }
  }
  return found;
}

Found lit_channels(Draw& /*draw*/, std::uint64_t /*cases*/) {
  Found found;
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
      found.see(shade(hit, ray, camera, shading).r - albedo * light / 256.0L);
    }
  }
  return found;
}

// --- Pixels and numbers.

Found grays(Draw& /*draw*/, std::uint64_t /*cases*/) {
  Found found;
  constexpr int kStep = 5;  // 52 values a channel, both ends among them
  for (int r = 0; r < 256; r += kStep) {
    for (int g = 0; g < 256; g += kStep) {
      for (int b = 0; b < 256; b += kStep) {
        const Rgb8 color{static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g),
                         static_cast<std::uint8_t>(b)};
        found.see(gray_of(color) - (0.299L * r + 0.587L * g + 0.114L * b));
      }
    }
  }
  return found;
}

Found rgb565(Draw& /*draw*/, std::uint64_t /*cases*/) {
  Found found;
  for (int value = 0; value < 256; ++value) {
    std::uint8_t row[2] = {};
    store_pixel(row, 0, 0, PixelFormat::kRgb565, {static_cast<std::uint8_t>(value), 0, 0});
    found.see((row[1] >> 3 << 3) - value);
  }
  return found;
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
Found fixed_numbers(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    see_fixed<8>(draw, &found);
    see_fixed<14>(draw, &found);
    see_fixed<16>(draw, &found);
  }
  return found;
}

// --- What is left out, and what is averaged.

Found cutoff_reaches(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
    const Pinhole made = any_camera<PerspectiveView>(draw);
    const Q16 pixels = Q16::from_raw(draw.any_size(25));
    Cutoff cutoff;
    if (cutoff.set(made.camera, pixels) != Status::kOk) {
      continue;
    }
    const Camera::Vec3Q32& step = made.camera.affine().step_x;
    const Real width =
        length({static_cast<Real>(step.x), static_cast<Real>(step.y), static_cast<Real>(step.z)}) /
        4294967296.0L;
    for (int i = 0; i < kPixelsACamera; ++i) {
      const std::int32_t largest = draw.any_size(20);
      const Real exact = 256.0L * largest / (width * pixels.raw / Q16::kOne);
      if (exact < (1 << 24)) {  // beyond any distance that there is
        found.see(cutoff.reach_q8(largest) - exact);
      }
    }
  }
  return found;
}

// Of a tree of one node: all sums of colours that 1 .. 8 voxels can have.
Found node_colors(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
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
      found.see(255);
      return found;
    }
    const Rgb8 mean = colors.color(0);
    found.see(mean.r - sum[0] / static_cast<Real>(count));
    found.see(mean.g - sum[1] / static_cast<Real>(count));
    found.see(mean.b - sum[2] / static_cast<Real>(count));
  }
  return found;
}

Found sample_means(Draw& draw, std::uint64_t cases) {
  Found found;
  while (found.cases < cases) {
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
      found.see(65536);
      return found;
    }
    found.see((row[0] - sum / (across * across)) * 256);
  }
  return found;
}

const Operation kOperations[] = {
    {"camera: perspective ray", "kRayErrorPxQ16", "1/65536 pixel", kRayErrorPxQ16, perspective_rays},
    {"camera: orthographic ray", "kRayErrorPxQ16", "1/65536 pixel", kRayErrorPxQ16, parallel_rays},
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
};

}  // namespace

std::vector<OperationError> sweep_operations(std::uint64_t cases, std::uint64_t seed,
                                             const std::function<void(double)>& progress) {
  std::vector<Operation> operations(std::begin(kOperations), std::end(kOperations));
  const std::vector<Operation> optics = sweep::optics_operations();
  operations.insert(operations.end(), optics.begin(), optics.end());
  std::vector<OperationError> errors;
  for (const Operation& operation : operations) {
    Draw draw(seed);
    const Found found = operation.sweep(draw, cases);
    errors.push_back({operation.name, operation.bound_name, operation.unit, static_cast<double>(found.error),
                      operation.bound, found.cases});
    if (progress) {
      progress(static_cast<double>(errors.size()) / static_cast<double>(operations.size()));
    }
  }
  return errors;
}

}  // namespace thimble::tools
