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

// Finds greys in doubles alone.
template <bool kPerspective>
HWY_NOINLINE void find_grays_exactly(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale,
                                     uint8_t* gray) {
  Corners corners;
  find_corners(pixels, &corners);
  for (size_t at = 0; at < pixels.count; at += hn::Lanes(F64())) {
    const Entries found = entries_of<kPerspective>(frame, pixels, corners, at);
    store_bytes(grays_in_doubles(scale, found.numerator, found.speed), gray + at);
  }
}

// Finds the greys of the pixels with these numbers again, exactly.
template <bool kPerspective>
void find_unclear_grays(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale,
                        const uint32_t* numbers, uint32_t count, uint8_t* gray) {
  Pixels few;
  few.count = count;
  few.any_levels = pixels.any_levels;
  for (uint32_t i = 0; i < count + hn::Lanes(F32()); ++i) {  // the vector behind them means nothing
    const uint32_t from = numbers[i < count ? i : 0];
    few.x[i] = pixels.x[from];
    few.y[i] = pixels.y[from];
    few.key[i] = pixels.key[from];
    few.cube[i] = pixels.cube[from];
    few.level[i] = pixels.any_levels ? pixels.level[from] : 0;
    few.voxels[i] = pixels.any_levels ? pixels.voxels[from] : 0;
  }
  uint8_t found[kMostPixels + 64];
  find_grays_exactly<kPerspective>(frame, few, scale, found);
  for (uint32_t i = 0; i < count; ++i) {
    gray[numbers[i]] = found[i];
  }
}

// Finds in floats where the rays of a vector of pixels enter their boxes. Distances are integers below 2^24. Adds to
// `unclear` the lanes that floats do not decide.
template <bool kPerspective>
HWY_INLINE EntryPlane entry_planes(const WideFrame& frame, const Pixels& pixels, const Corners& corners,
                                   size_t at, hn::Mask<F32>* unclear) {
  const F32 d;
  const I32 di;
  const U32 du;
  const auto zero = hn::Zero(d);
  const auto x = hn::ConvertTo(d, hn::LoadU(di, pixels.x + at));
  const auto y = hn::ConvertTo(d, hn::LoadU(di, pixels.y + at));
  auto side = hn::Set(d, 1.0F);
  if (pixels.any_levels) {
    const auto level = hn::BitCast(du, hn::LoadU(di, pixels.level + at));
    side = hn::ConvertTo(d, hn::BitCast(di, hn::Shl(hn::Set(du, 1U), level)));
    *unclear = hn::Or(*unclear, hn::Gt(side, hn::Set(d, 1.0F)));
  }
  const auto size = hn::Mul(side, hn::Set(d, 256.0F));
  const auto last = hn::Sub(hn::Set(d, 4096.0F), side);  // corners are mirrored in a world of 4096 voxels
  EntryPlane plane;
  auto off = zero;
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    auto direction = varying_of(frame, axis, x, y, &off);
    auto origin = hn::Set(d, static_cast<float>(frame.eye[axis]));
    if (!kPerspective) {
      origin = hn::Add(origin, direction);
      direction = hn::Set(d, static_cast<float>(frame.direction[axis]));
    }
    const auto downward = hn::Lt(direction, zero);
    const auto mirrored = hn::ConvertTo(d, hn::LoadU(di, corners.at[axis] + at));
    const auto corner = hn::IfThenElse(downward, hn::Sub(last, mirrored), mirrored);
    const auto low = hn::MulSub(corner, hn::Set(d, 256.0F), origin);
    const auto speed = hn::Abs(direction);
    const auto distance = hn::IfThenElse(downward, hn::Neg(hn::Add(low, size)), low);
    // A ray that does not move along an axis passes none of its planes.
    plane.take_later(axis, hn::IfThenElseZero(hn::Gt(speed, zero), distance), speed, unclear);
  }
  *unclear = hn::Or(*unclear, rounding_is_unclear(frame, off));
  return plane;
}

// Finds greys in floats where these decide, and the other greys exactly.
template <bool kPerspective>
void find_grays_of(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  const F32 d;
  const I32 di;
  const F64 d64;
  const size_t lanes = hn::Lanes(d);
  const hn::Rebind<float, F64> half_d;
  Corners corners;
  find_corners(pixels, &corners);
  uint32_t unclear_at[kMostPixels];
  uint32_t unclear_count = 0;
  for (size_t at = 0; at < pixels.count; at += lanes) {
    auto unclear = hn::Lt(hn::Zero(d), hn::Zero(d));
    const EntryPlane plane = entry_planes<kPerspective>(frame, pixels, corners, at, &unclear);
    if (scale.floats_tell) {
      const hn::Rebind<uint8_t, I32> bytes;
      const auto product = hn::Mul(plane.numerator, ratios_of(scale, plane.speed));
      const auto found = grays_in_floats(scale, product, 1.0F, &unclear);
      hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(di, found)), bytes, gray + at);
    } else {
      HWY_ALIGN float numerators[64];
      HWY_ALIGN float speeds[64];
      hn::Store(plane.numerator, d, numerators);
      hn::Store(plane.speed, d, speeds);
      for (size_t part = 0; part < lanes; part += hn::Lanes(d64)) {
        store_bytes(grays_in_doubles(scale, hn::PromoteTo(d64, hn::LoadU(half_d, numerators + part)),
                                     hn::PromoteTo(d64, hn::LoadU(half_d, speeds + part))),
                    gray + at + part);
      }
    }
    for (uint32_t bits = bits_of(d, unclear); bits != 0; bits &= bits - 1) {
      const uint32_t i = static_cast<uint32_t>(at) + static_cast<uint32_t>(__builtin_ctz(bits));
      if (i < pixels.count) {
        unclear_at[unclear_count++] = i;
      }
    }
  }
  if (unclear_count != 0) {
    find_unclear_grays<kPerspective>(frame, pixels, scale, unclear_at, unclear_count, gray);
  }
}

void find_grays(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  uint32_t blocks = 0;  // pixels that show blocks, which floats never decide
  for (uint32_t i = 0; pixels.any_levels && i < pixels.count; ++i) {
    blocks += pixels.level[i] > 0 ? 1 : 0;
  }
  if (blocks > pixels.count / 4) {
    frame.perspective ? find_grays_exactly<true>(frame, pixels, scale, gray)
                      : find_grays_exactly<false>(frame, pixels, scale, gray);
    return;
  }
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
