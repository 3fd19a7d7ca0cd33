// How a view becomes an affine function of the pixel, and how far its rays are from the ideal ones.
//
// Let F, R, U be the unit vectors forward, right and up, f the focal length in pixels and (x, y) a pixel's
// centre, in pixels from the middle of the picture. The ideal direction is d = f F + x R + y U. The camera's
// is D = s d + e, where s scales the largest component on the picture to M = 2^bits - 1, and e is what
// rounding and set-up did to it. D meets the plane at planar depth f in f D / (F.D), where F.D = s f + F.e,
// so its distance from d there is
//     |f e - d (F.e)| / (s f + F.e)  <=  |d| |e| / (s f - |e|)
// because e -> e - d (F.e) / f projects along d onto the picture, with norm |d| / f. |d| is largest in the
// corners. That is the bound in use, with |e| <= 57/64: rounding is at most sqrt(3)/2 < 0.8661, which leaves
// 0.0245 for set-up.
//
// What set-up does, in units of D at 20 bits (fewer bits: less). A unit vector's component is within 2^-30,
// its vector within 1.8 * 2^-30, and s f, s |x|, s |y| are below sqrt(3) * 2^20 each (some component of the
// corner is at least its length / sqrt(3)): with up, a product of two, at most 4 * 1.8 * 1.8 * 2^-10 = 0.013.
// The cotangent's relative error 2^-28: 0.007. The sizes' common block exponent, 2^-31 of the largest: below
// 0.002. Rounding to 32.32 and 16,384 steps of that: 2^-18. Sum below 0.0225; test_camera.cpp measures 0.002.
// The scale s itself may be off by 2^-29, which moves no ray.
//
// Orthographic: origins are rounded to 1/256 voxel per component, again within 57/64 in all; steps are within
// 5.8 * 2^-30 of themselves, over half the picture's diagonal (11,585 pixels at most) 5/65536 pixel. The
// direction D = s F + e is the same for all pixels, so e is known; at planar depth z it moves a ray by at
// most z |e| / (F.D). z is largest in the corner of the world that lies furthest ahead.
#include "thimble/picture/camera.h"

#include "../base/ranges.h"
#include "../base/wide_arithmetic.h"
#include "cotangent.h"

namespace thimble {

namespace {

// 57/64, the bound on |e| above, in Q8.
constexpr uint64_t kRoundingQ8 = 228;
// Bounds of the error on the picture, in 1/65536 pixel: what automatic bits aim at, and what they must keep.
constexpr uint64_t kAimPxQ16 = 4096;
constexpr uint64_t kMustPxQ16 = 8192;

using Wide = Vec3<int64_t>;

/// Forward, right and up of the picture: orthonormal, in 1/2^30.
struct ViewFrame {
  Vec3i forward;
  Vec3i right;
  Vec3i up;
};

bool has_view_components(const Vec3i& vector) {
  for (int axis = 0; axis < 3; ++axis) {
    if (vector[axis] < -kMaxViewComponent || vector[axis] > kMaxViewComponent) {
      return false;
    }
  }
  return true;
}

/// a x b, exactly: below 2^62 for view components.
Wide cross(const Vec3i& a, const Vec3i& b) {
  THIMBLE_NOTE(Range::kCross, Exact(a.y) * Exact(b.z) - Exact(a.z) * Exact(b.y));
  THIMBLE_NOTE(Range::kCross, Exact(a.z) * Exact(b.x) - Exact(a.x) * Exact(b.z));
  THIMBLE_NOTE(Range::kCross, Exact(a.x) * Exact(b.y) - Exact(a.y) * Exact(b.x));
  return {wide_product(a.y, b.z) - wide_product(a.z, b.y), wide_product(a.z, b.x) - wide_product(a.x, b.z),
          wide_product(a.x, b.y) - wide_product(a.y, b.x)};
}

/// The largest |component|.
uint64_t largest(const Wide& vector) {
  uint64_t result = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const uint64_t size = magnitude(vector[axis]);
    result = size > result ? size : result;
  }
  return result;
}

/// `vector` (not zero) at length 1, in 1/2^30, every component within 2^-30.
Vec3i unit_q30(const Wide& vector) {
  // To 31 bits first: squares then sum up below 2^64.
  const int surplus = bit_width(largest(vector)) - 31;
  Vec3<uint64_t> scaled;
  uint64_t squares = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const uint64_t size = magnitude(vector[axis]);
    scaled[axis] = surplus > 0 ? shift_rounded(size, surplus) : size << -surplus;
    squares += scaled[axis] * scaled[axis];
  }
  THIMBLE_NOTE(Range::kSquares, Exact(scaled.x) * Exact(scaled.x) + Exact(scaled.y) * Exact(scaled.y) +
                                    Exact(scaled.z) * Exact(scaled.z));
  const uint32_t length = square_root_rounded(squares);
  Vec3i unit;
  for (int axis = 0; axis < 3; ++axis) {
    unit[axis] = static_cast<int32_t>(with_sign_of(vector[axis], divide_rounded(scaled[axis] << 30, length)));
  }
  return unit;
}

/// Checks the vectors of a view and makes its frame.
Status make_frame(const Vec3i& forward, const Vec3i& given_up, ViewFrame& frame) {
  if (!has_view_components(forward) || !has_view_components(given_up)) {
    return Status::kOutOfRange;
  }
  const Vec3i up = given_up == Vec3i{} ? default_up(forward) : given_up;
  const Wide right = cross(forward, up);
  if (right == Wide{}) {  // also when forward is zero
    return Status::kBadArgument;
  }
  frame.forward = unit_q30({forward.x, forward.y, forward.z});
  frame.right = unit_q30(right);
  const Wide above = cross(frame.right, frame.forward);
  for (int axis = 0; axis < 3; ++axis) {
    frame.up[axis] =
        static_cast<int32_t>(with_sign_of(above[axis], shift_rounded(magnitude(above[axis]), 30)));
  }
  return Status::kOk;
}

/// Checks what both views have in common.
Status check_picture(int32_t width_px, int32_t height_px, int direction_bits, int level) {
  if (width_px < 1 || height_px < 1) {
    return Status::kBadArgument;
  }
  const bool bits_fit =
      direction_bits == 0 || (direction_bits >= kMinDirectionBits && direction_bits <= kMaxDirectionBits);
  if (width_px > kMaxPicturePx || height_px > kMaxPicturePx || !bits_fit || level < kMinLevel ||
      level > kMaxLevel) {
    return Status::kOutOfRange;
  }
  return Status::kOk;
}

bool is_origin(int64_t low_q8, int64_t high_q8, int level) {
  const int32_t world_q8 = Q8::kOne << level;
  return low_q8 >= kMinOriginWorlds * world_q8 && high_q8 <= kMaxOriginWorlds * world_q8;
}

bool is_origin(const Vec3Q8& point, int level) {
  return is_origin(point.x.raw, point.x.raw, level) && is_origin(point.y.raw, point.y.raw, level) &&
         is_origin(point.z.raw, point.z.raw, level);
}

constexpr int32_t largest_direction(int bits) {
  return (int32_t{1} << bits) - 1;
}

/// The affine function that is `middle` in the middle of the picture and grows by `half_right` with every
/// half pixel to the right, by `half_up` with every half pixel upwards. Halves, so that the middle between
/// two pixels is exact and the function symmetric.
void set_affine(Camera::Affine& affine, int axis, int64_t middle, int64_t half_right, int64_t half_up,
                int32_t width_px, int32_t height_px) {
  affine.base[axis] = middle - (width_px - 1) * half_right + (height_px - 1) * half_up;
  affine.step_x[axis] = 2 * half_right;
  affine.step_y[axis] = -2 * half_up;
  // Its extremes are the corners' values.
  THIMBLE_NOTE(Range::kAffine, Exact(middle) + Exact(width_px - 1) * Exact(half_right) +
                                   Exact(height_px - 1) * Exact(half_up));
  THIMBLE_NOTE(Range::kAffine, Exact(middle) + Exact(width_px - 1) * Exact(half_right) -
                                   Exact(height_px - 1) * Exact(half_up));
  THIMBLE_NOTE(Range::kAffine, Exact(middle) - Exact(width_px - 1) * Exact(half_right) +
                                   Exact(height_px - 1) * Exact(half_up));
  THIMBLE_NOTE(Range::kAffine, Exact(middle) - Exact(width_px - 1) * Exact(half_right) -
                                   Exact(height_px - 1) * Exact(half_up));
}

}  // namespace

Vec3i look_at(const Vec3Q8& eye, const Vec3Q8& target) {
  Wide difference;
  for (int axis = 0; axis < 3; ++axis) {
    difference[axis] = static_cast<int64_t>(target[axis].raw) - eye[axis].raw;
  }
  const uint64_t size = largest(difference);
  const int shift = size > (uint64_t{kMaxViewComponent} << 1) ? 2 : size > kMaxViewComponent ? 1 : 0;
  Vec3i forward;
  for (int axis = 0; axis < 3; ++axis) {
    forward[axis] =
        static_cast<int32_t>(with_sign_of(difference[axis], magnitude(difference[axis]) >> shift));
  }
  return forward;
}

Status Camera::set(const PerspectiveView& view, int level) {
  Status status = check_picture(view.width_px, view.height_px, view.direction_bits, level);
  if (status != Status::kOk) {
    return status;
  }
  if (view.fov_degrees < kMinFov || view.fov_degrees > kMaxFov || !is_origin(view.eye, level)) {
    return Status::kOutOfRange;
  }
  ViewFrame frame;
  status = make_frame(view.forward, view.up, frame);
  if (status != Status::kOk) {
    return status;
  }

  // Twice the focal length in pixels, and the picture's sizes, with one binary point that gives the largest
  // of them 31 bits: `fraction` bits after it, 9 .. 30.
  const uint64_t focal_q39 =
      half_angle_cotangent_q39(view.fov_degrees) * static_cast<uint32_t>(view.height_px);  // below 2^60
  THIMBLE_NOTE(Range::kFocal, Exact(half_angle_cotangent_q39(view.fov_degrees)) * Exact(view.height_px));
  const int32_t side_px = view.width_px > view.height_px ? view.width_px : view.height_px;
  const uint64_t side_q39 = static_cast<uint64_t>(side_px) << 39;
  const int fraction = 70 - bit_width(focal_q39 > side_q39 ? focal_q39 : side_q39);
  const uint64_t focal = shift_rounded(focal_q39, 39 - fraction);
  const uint64_t right = static_cast<uint64_t>(view.width_px - 1) << fraction;
  const uint64_t above = static_cast<uint64_t>(view.height_px - 1) << fraction;

  // The largest component on the picture. Its corners take every combination of signs, so it is a sum of
  // magnitudes: 2^59 .. 3 * 2^61.
  uint64_t extent = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const uint64_t sum = magnitude(frame.forward[axis]) * focal + magnitude(frame.right[axis]) * right +
                         magnitude(frame.up[axis]) * above;
    THIMBLE_NOTE(Range::kExtent, Exact(magnitude(frame.forward[axis])) * Exact(focal) +
                                     Exact(magnitude(frame.right[axis])) * Exact(right) +
                                     Exact(magnitude(frame.up[axis])) * Exact(above));
    extent = sum > extent ? sum : extent;
  }
  const int spare = 63 - bit_width(extent);
  const uint64_t extent_high = ((extent << spare) >> 32) + 1;  // rounded up, 2^30 .. 2^31

  // s f for M = 1, rounded down, and a corner's |d|, in half pixels with `fraction`.
  const uint64_t depth_q31 = divide((focal << 30), (extent >> 31) + 1);
  THIMBLE_NOTE(Range::kSquares,
               Exact(focal) * Exact(focal) + Exact(right) * Exact(right) + Exact(above) * Exact(above));
  const uint64_t corner = square_root_rounded(focal * focal + right * right + above * above);
  const auto depth_q8 = [depth_q31](int bits) {
    return (depth_q31 * static_cast<uint32_t>(largest_direction(bits))) >> 23;
  };

  // The bound |d| |e| / (s f - |e|) is within 1/n pixel when s f >= |e| + n |d| |e|.
  int bits = view.direction_bits;
  if (bits == 0) {
    const uint64_t span_q8 = (kRoundingQ8 * corner >> (fraction + 1)) + 1;
    for (bits = kMinDirectionBits; bits < kMaxDirectionBits; ++bits) {
      if (depth_q8(bits) >= kRoundingQ8 + (65536 / kAimPxQ16) * span_q8) {
        break;
      }
    }
    if (depth_q8(bits) < kRoundingQ8 + (65536 / kMustPxQ16) * span_q8) {
      return Status::kTooFine;
    }
  }
  if (depth_q8(bits) <= kRoundingQ8) {
    return Status::kTooFine;  // s d is shorter than what rounding may take away
  }
  const uint64_t error_px_q16 =
      divide(kRoundingQ8 * corner << 15, (depth_q8(bits) - kRoundingQ8) << fraction) + 1;

  // M / extent, as a 32-bit factor; then every term of the affine function is one product.
  const uint64_t top = static_cast<uint64_t>(largest_direction(bits)) << (62 - bits);
  const uint32_t factor = static_cast<uint32_t>(divide(top, extent_high));
  const int shift = 62 - bits - spare;
  for (int axis = 0; axis < 3; ++axis) {
    const auto term = [factor, shift](int32_t component, uint64_t size) {
      THIMBLE_NOTE(Range::kTerm, Exact(magnitude(component)) * Exact(size));
      return with_sign_of(component, multiply_shifted(magnitude(component) * size, factor, shift));
    };
    const uint64_t half_pixel = uint64_t{1} << fraction;
    set_affine(affine_, axis, term(frame.forward[axis], focal), term(frame.right[axis], half_pixel),
               term(frame.up[axis], half_pixel), view.width_px, view.height_px);
  }
  eye_ = view.eye;
  direction_ = Vec3i{};
  width_px_ = view.width_px;
  height_px_ = view.height_px;
  depth_per_t_q8_ = static_cast<int32_t>(depth_q8(bits));
  error_bound_px_q16_ = error_px_q16 < UINT32_MAX ? static_cast<uint32_t>(error_px_q16) : UINT32_MAX;
  level_ = static_cast<uint8_t>(level);
  direction_bits_ = static_cast<uint8_t>(bits);
  is_perspective_ = true;
  return Status::kOk;
}

namespace {

constexpr uint64_t kOneQ32 = uint64_t{1} << 32;

/// A constant direction of some number of bits, and how good it is.
struct ParallelDirection {
  Vec3i direction;
  uint64_t depth_q30;  ///< D . F
  uint64_t error_q16;  ///< |D - s F|, rounded up; 0 when exact
};

ParallelDirection make_direction(const Vec3i& forward, const Vec3<uint64_t>& ratio_q32, const Vec3i& unit,
                                 int bits) {
  ParallelDirection result{};
  uint64_t squares = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const uint64_t exact_q32 = ratio_q32[axis] * static_cast<uint32_t>(largest_direction(bits));
    const int64_t component = with_sign_of(forward[axis], shift_rounded(exact_q32, 32));
    result.direction[axis] = static_cast<int32_t>(component);
    result.depth_q30 += magnitude(component) * magnitude(unit[axis]);  // their signs agree
    if (ratio_q32[axis] != 0 && ratio_q32[axis] != kOneQ32) {
      // The ratio is off by up to 2^-33, this by up to 2^-13, which is 8 units; cutting adds another.
      const uint64_t rest_q32 = exact_q32 & UINT32_MAX;
      const uint64_t error_q32 = rest_q32 <= kOneQ32 / 2 ? rest_q32 : kOneQ32 - rest_q32;
      const uint64_t error_q16 = (error_q32 >> 16) + 9;
      squares += error_q16 * error_q16;
    }
  }
  result.error_q16 = squares == 0 ? 0 : square_root_rounded(squares) + uint64_t{1};
  return result;
}

/// How far ahead of the eye the furthest corner of the world lies, in 1/256 voxel, rounded up; 0 when behind.
uint64_t world_depth_q8(const Vec3Q8& eye, const Vec3i& unit_forward, int level) {
  int64_t depth_q38 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t corner_q8 = unit_forward[axis] > 0 ? Q8::kOne << level : 0;
    depth_q38 += wide_product(unit_forward[axis], corner_q8 - eye[axis].raw);
  }
  return depth_q38 <= 0 ? 0 : static_cast<uint64_t>(depth_q38 >> 30) + 1;
}

}  // namespace

Status Camera::set(const OrthographicView& view, int level) {
  Status status = check_picture(view.width_px, view.height_px, view.direction_bits, level);
  if (status != Status::kOk) {
    return status;
  }
  if (view.span.raw <= 0) {
    return Status::kBadArgument;
  }
  if (!is_origin(view.eye, level)) {
    return Status::kOutOfRange;
  }
  ViewFrame frame;
  status = make_frame(view.forward, view.up, frame);
  if (status != Status::kOk) {
    return status;
  }

  // The origins: half a pixel is span / (2 width), here in 1/2^32 of 1/256 voxel.
  const uint64_t width = static_cast<uint32_t>(view.width_px);
  const uint64_t span = static_cast<uint32_t>(view.span.raw);
  Affine affine;
  for (int axis = 0; axis < 3; ++axis) {
    // |product| <= 2^61 in 1/2^44 voxel.
    const auto half_step = [width, span](int32_t component) {
      return with_sign_of(component, divide_rounded(magnitude(component) * span, width << 5));
    };
    const int64_t right = half_step(frame.right[axis]);
    const int64_t above = half_step(frame.up[axis]);
    // Half the picture's extent must stay below 9 of the largest worlds, 2^23.2; then every sum is below
    // 2^58.
    const uint64_t right_extent = (magnitude(right) >> 16) * static_cast<uint32_t>(view.width_px - 1);
    const uint64_t above_extent = (magnitude(above) >> 16) * static_cast<uint32_t>(view.height_px - 1);
    if (right_extent + above_extent >= uint64_t{1} << (24 + 16)) {
      return Status::kOutOfRange;
    }
    set_affine(affine, axis, 0, right, above, view.width_px, view.height_px);
    // The corner with the largest offset; the one opposite has its negative.
    const int64_t extent =
        rounded(static_cast<int64_t>(magnitude(right) * static_cast<uint32_t>(view.width_px - 1) +
                                     magnitude(above) * static_cast<uint32_t>(view.height_px - 1)));
    if (!is_origin(view.eye[axis].raw - extent, view.eye[axis].raw + extent, level)) {
      return Status::kOutOfRange;
    }
  }
  // What rounding them moves a ray by; 5 more than rounded up for the steps' own errors.
  const uint64_t origin_px_q16 = divide(kRoundingQ8 * width << 14, span) + 6;
  if (origin_px_q16 > kMustPxQ16) {
    return Status::kTooFine;
  }

  // The direction: the forward vector's own ratios, so that none is lost that is 0 or 1.
  const uint64_t longest = largest({view.forward.x, view.forward.y, view.forward.z});
  Vec3<uint64_t> ratio_q32;
  for (int axis = 0; axis < 3; ++axis) {
    ratio_q32[axis] = divide_rounded(magnitude(view.forward[axis]) << 32, longest);
  }
  // At planar depth z (1/256 voxel, below 2^24) it moves a ray by z e / (D.F) voxels, or, with pixels of
  // span / (width 2^14) voxels, by factor * error_q16 / (depth * span) of 1/65536 pixel. The factor is below
  // 2^44, e below 2^16, the depth below 2^21, the span below 2^31.
  const uint64_t factor = world_depth_q8(view.eye, frame.forward, level) * width << 6;
  const auto shear_px_q16 = [factor, span](const ParallelDirection& candidate) {
    THIMBLE_NOTE(Range::kShear, Exact(factor) * Exact(candidate.error_q16));
    return divide(factor * candidate.error_q16, (candidate.depth_q30 >> 30) * span) + 1;
  };
  const uint64_t must_px_q16 = kMustPxQ16 - origin_px_q16;
  const uint64_t aims[] = {must_px_q16 < kAimPxQ16 ? must_px_q16 : kAimPxQ16, must_px_q16};
  const bool automatic = view.direction_bits == 0;
  int bits = automatic ? kMinDirectionBits : view.direction_bits;
  ParallelDirection parallel = make_direction(view.forward, ratio_q32, frame.forward, bits);
  uint64_t shear = shear_px_q16(parallel);
  for (int aim = 0; automatic && shear > aims[aim];) {
    if (bits < kMaxDirectionBits) {
      ++bits;
    } else if (aim == 0) {
      aim = 1;
      bits = kMinDirectionBits;
    } else {
      return Status::kTooFine;
    }
    parallel = make_direction(view.forward, ratio_q32, frame.forward, bits);
    shear = shear_px_q16(parallel);
  }

  affine_ = affine;
  eye_ = view.eye;
  direction_ = parallel.direction;
  width_px_ = view.width_px;
  height_px_ = view.height_px;
  depth_per_t_q8_ = static_cast<int32_t>(shift_rounded(parallel.depth_q30, 22));
  const uint64_t error_px_q16 = origin_px_q16 + shear;
  error_bound_px_q16_ = error_px_q16 < UINT32_MAX ? static_cast<uint32_t>(error_px_q16) : UINT32_MAX;
  level_ = static_cast<uint8_t>(level);
  direction_bits_ = static_cast<uint8_t>(bits);
  is_perspective_ = false;
  return Status::kOk;
}

}  // namespace thimble
