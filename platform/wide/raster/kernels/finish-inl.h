/// Finds exactly, in doubles, where rays enter the boxes that they hit, and the greys and faces of covered pixels.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_FINISH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_FINISH_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_FINISH_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_FINISH_INL_H_
#endif

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/judge-inl.h"
#include "wide/raster/kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// The exact rays of some pixels: integers, held in doubles.
struct Rays {
  hn::Vec<F64> origin[3];
  hn::Vec<F64> direction[3];
};

// Finds round(base + x * step_x + y * step_y) / 2^32, with halves away from zero. Each step is exact: high
// parts stay below 2^52, low parts below 2^36.
inline hn::Vec<F64> rounded(const WideFrame& frame, int axis, hn::Vec<F64> x, hn::Vec<F64> y) {
  const F64 d;
  const auto low =
      hn::MulAdd(x, hn::Set(d, frame.step_x_low[axis]),
                 hn::MulAdd(y, hn::Set(d, frame.step_y_low[axis]), hn::Set(d, frame.base_low[axis])));
  const auto high =
      hn::MulAdd(x, hn::Set(d, frame.step_x_high[axis]),
                 hn::MulAdd(y, hn::Set(d, frame.step_y_high[axis]), hn::Set(d, frame.base_high[axis])));
  const auto carry = hn::Floor(hn::Mul(low, hn::Set(d, 1.0 / (1 << 20))));
  const auto rest = hn::NegMulAdd(carry, hn::Set(d, 1 << 20), low);
  const auto whole = hn::Add(high, carry);
  // A negative number exactly half way between two integers goes down.
  const auto zero = hn::Zero(d);
  const auto half_way = hn::And(hn::Lt(whole, zero), hn::Eq(rest, zero));
  const auto moved = hn::Sub(hn::Add(whole, hn::Set(d, 2048)), hn::IfThenElseZero(half_way, hn::Set(d, 1)));
  return hn::Floor(hn::Mul(moved, hn::Set(d, 1.0 / 4096)));
}

template <bool kPerspective>
inline Rays rays_of(const WideFrame& frame, hn::Vec<F64> x, hn::Vec<F64> y) {
  const F64 d;
  Rays rays;
  for (int axis = 0; axis < 3; ++axis) {
    const auto varying = rounded(frame, axis, x, y);
    if (kPerspective) {
      rays.origin[axis] = hn::Set(d, static_cast<double>(frame.eye[axis]));
      rays.direction[axis] = varying;
    } else {
      rays.origin[axis] = hn::Add(hn::Set(d, static_cast<double>(frame.eye[axis])), varying);
      rays.direction[axis] = hn::Set(d, static_cast<double>(frame.direction[axis]));
    }
  }
  return rays;
}

// The mirrored corners that the keys of pixels stand for.
struct Corners {
  alignas(64) int32_t at[3][kMostPixels + 64];
};

void find_corners(const Pixels& pixels, Corners* corners) {
  const U32 d;
  static_assert(kEntryBits == 28 && kKeyBits == 36);
  for (size_t at = 0; at < pixels.count; at += hn::Lanes(d)) {
    const auto key = hn::LoadU(d, pixels.key + at);
    const auto cube = hn::LoadU(d, pixels.cube + at);
    const hn::Vec<U32> keys[3] = {key, hn::ShiftRight<1>(key), hn::ShiftRight<2>(key)};
    const hn::Vec<U32> cubes[3] = {cube, hn::ShiftRight<1>(cube), hn::ShiftRight<2>(cube)};
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const auto low = hn::And(cubes[axis], hn::Set(d, 1U));
      const auto high = hn::And(hn::ShiftRight<2>(cubes[axis]), hn::Set(d, 2U));
      const auto corner = hn::Or(gathered10(keys[axis]), hn::ShiftLeft<10>(hn::Or(low, high)));
      hn::StoreU(hn::BitCast(I32(), corner), I32(), corners->at[axis] + at);
    }
  }
}

// The planes through which rays enter the boxes that they hit: of the three axes' nearer planes the one that the ray
// passes last, on a tie that of the lowest axis. Times are compared as fractions, num_a |d_b| > num_b |d_a|, in
// integers below 2^44.
struct Entries {
  hn::Vec<F64> axis;       // -1: the ray starts inside
  hn::Vec<F64> numerator;  // t = numerator / (256 * speed)
  hn::Vec<F64> speed;      // |direction[axis]|
  hn::Vec<F64> direction[3];
};

template <bool kPerspective>
HWY_INLINE Entries entries_of(const WideFrame& frame, const Pixels& pixels, const Corners& corners,
                              size_t at) {
  const F64 d;
  const HalfI32 d32;
  const auto zero = hn::Zero(d);
  Entries found;
  const Rays rays = rays_of<kPerspective>(frame, hn::PromoteTo(d, hn::LoadU(d32, pixels.x + at)),
                                          hn::PromoteTo(d, hn::LoadU(d32, pixels.y + at)));
  auto side = hn::Set(d, 1);
  if (pixels.any_levels) {
    side = hn::PromoteTo(d, hn::Shl(hn::Set(d32, 1), hn::LoadU(d32, pixels.level + at)));
  }
  const auto size = hn::Mul(side, hn::Set(d, 256));
  // Corners are mirrored in a world of 4096 voxels.
  const auto last = hn::Sub(hn::Set(d, 4096), side);
  found.axis = hn::Set(d, -1);
  found.numerator = zero;
  found.speed = hn::Set(d, 1);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    const auto downward = hn::Lt(rays.direction[axis], zero);
    const auto mirrored = hn::PromoteTo(d, hn::LoadU(d32, corners.at[axis] + at));
    const auto corner = hn::IfThenElse(downward, hn::Sub(last, mirrored), mirrored);
    const auto low = hn::Sub(hn::Mul(corner, hn::Set(d, 256)), rays.origin[axis]);
    const auto speed = hn::Abs(rays.direction[axis]);
    const auto distance = hn::IfThenElse(downward, hn::Neg(hn::Add(low, size)), low);
    // No ray enters through a plane at or behind its origin.
    const auto later = hn::And(hn::And(hn::Gt(distance, zero), hn::Gt(speed, zero)),
                               hn::Gt(hn::Mul(distance, found.speed), hn::Mul(found.numerator, speed)));
    found.axis = hn::IfThenElse(later, hn::Set(d, axis), found.axis);
    found.numerator = hn::IfThenElse(later, distance, found.numerator);
    found.speed = hn::IfThenElse(later, speed, found.speed);
    found.direction[axis] = rays.direction[axis];
  }
  if (!pixels.any_levels) {
    return found;
  }
  // The core names the face of the voxel by which a ray enters, also in a solid block. Where the ray passes from one
  // voxel to the next along a lower axis just as it enters the block, it enters the voxel by that axis' face, too, and
  // the lowest axis counts.
  const auto is_voxel = hn::Gt(hn::PromoteTo(d, hn::LoadU(d32, pixels.voxels + at)), zero);
  const auto block_axis = found.axis;
  const auto block_numerator = found.numerator;
  const auto block_speed = found.speed;
  for (int axis = 1; axis >= 0; --axis) {
    const auto speed = hn::Abs(rays.direction[axis]);
    const auto product = hn::Mul(block_numerator, speed);
    const auto way = hn::Round(hn::Div(product, block_speed));
    const auto place = hn::Add(rays.origin[axis], hn::CopySign(way, rays.direction[axis]));
    const auto voxel = hn::Mul(hn::Floor(hn::Mul(place, hn::Set(d, 1.0 / 256))), hn::Set(d, 256));
    auto passes = hn::And(is_voxel, hn::And(hn::Gt(block_axis, hn::Set(d, axis)), hn::Gt(speed, zero)));
    passes = hn::And(passes, hn::And(hn::Eq(hn::Mul(way, block_speed), product), hn::Eq(voxel, place)));
    found.axis = hn::IfThenElse(passes, hn::Set(d, axis), found.axis);
    found.numerator = hn::IfThenElse(passes, way, found.numerator);
    found.speed = hn::IfThenElse(passes, speed, found.speed);
  }
  return found;
}

HWY_INLINE void store_bytes(hn::Vec<HalfI32> values, uint8_t* to) {
  const HalfI32 d;
  HWY_ALIGN int32_t stored[64];
  hn::Store(values, d, stored);
  for (size_t i = 0; i < hn::Lanes(d); ++i) {
    to[i] = static_cast<uint8_t>(stored[i]);
  }
}

template <bool kPerspective>
void find_grays_of(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  Corners corners;
  find_corners(pixels, &corners);
  for (size_t at = 0; at < pixels.count; at += hn::Lanes(F64())) {
    const Entries found = entries_of<kPerspective>(frame, pixels, corners, at);
    store_bytes(grays_in_doubles(scale, found.numerator, found.speed), gray + at);
  }
}

void find_grays(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  frame.perspective ? find_grays_of<true>(frame, pixels, scale, gray)
                    : find_grays_of<false>(frame, pixels, scale, gray);
}

template <bool kPerspective>
void find_faces_of(const WideFrame& frame, const Pixels& pixels, uint8_t* face) {
  const F64 d;
  const HalfI32 d32;
  const size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  Corners corners;
  find_corners(pixels, &corners);
  for (size_t at = 0; at < pixels.count; at += lanes) {
    const Entries found = entries_of<kPerspective>(frame, pixels, corners, at);
    // A ray that starts inside has the face opposed to its largest component, on a tie that of the lowest axis.
    auto largest = hn::Abs(found.direction[0]);
    auto inside_axis = zero;
    for (int axis = 1; axis < 3; ++axis) {
      const auto size = hn::Abs(found.direction[axis]);
      inside_axis = hn::IfThenElse(hn::Gt(size, largest), hn::Set(d, axis), inside_axis);
      largest = hn::Max(size, largest);
    }
    const auto axis = hn::IfThenElse(hn::Lt(found.axis, zero), inside_axis, found.axis);
    auto component = found.direction[0];
    component = hn::IfThenElse(hn::Eq(axis, hn::Set(d, 1)), found.direction[1], component);
    component = hn::IfThenElse(hn::Eq(axis, hn::Set(d, 2)), found.direction[2], component);
    const auto upper = hn::IfThenElseZero(hn::Le(component, zero), hn::Set(d, 1));
    store_bytes(hn::DemoteTo(d32, hn::Add(hn::Add(axis, axis), upper)), face + at);
  }
}

void find_faces(const WideFrame& frame, const Pixels& pixels, uint8_t* face) {
  frame.perspective ? find_faces_of<true>(frame, pixels, face) : find_faces_of<false>(frame, pixels, face);
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
