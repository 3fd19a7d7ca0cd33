/// Decides whether rays meet boxes, and finds what pixels show of those that are hit: in floats where their error bounds prove
/// the answer, greys else in doubles.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_JUDGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_JUDGE_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_JUDGE_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_JUDGE_INL_H_
#endif

#include "wide/raster/frame.h"
#include "wide/raster/gray_scale.h"
#include "wide/raster/kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// Some rays, and the centres of boxes less the rays' origins: exact integers.
struct Aims {
  hn::Vec<F32> direction[3];
  hn::Vec<F32> center[3];  // in 1/512 voxel
  hn::Mask<F32> unclear;   // lanes whose direction floats do not decide
};

// Evaluates one component of the camera's affine map at the pixels (x, y), rounded to the nearest integer as the camera
// rounds it. The result is exact where the float lies farther from a half than the map's error. Raises `off` to the
// distance from the nearest integer, for rounding_is_unclear.
HWY_INLINE hn::Vec<F32> varying_of(const WideFrame& frame, int axis, hn::Vec<F32> x, hn::Vec<F32> y,
                                   hn::Vec<F32>* off) {
  const F32 d;
  const auto map = [&](const float(&of)[3][3]) {
    return hn::MulAdd(x, hn::Set(d, of[1][axis]),
                      hn::MulAdd(y, hn::Set(d, of[2][axis]), hn::Set(d, of[0][axis])));
  };
  const auto rest = map(frame.map_rest);
  const auto nearest = hn::Round(rest);
  *off = hn::Max(*off, hn::Abs(hn::Sub(rest, nearest)));
  return hn::Add(map(frame.map_whole), nearest);
}
HWY_INLINE hn::Mask<F32> rounding_is_unclear(const WideFrame& frame, hn::Vec<F32> off) {
  return hn::Gt(off, hn::Set(F32(), 0.5F - frame.map_error));
}

// Finds directions, which have at most 20 bits, and centres, which stay below 2^24: both are exact where clear.
//
// `low`: lowest corners within the cube, in voxels; `half`: half sides in 1/512 voxel; `origin`: the cube's
// corner less the eye, in 1/512 voxel.
template <bool kPerspective>
HWY_INLINE Aims aims_of(const WideFrame& frame, const float (&origin)[3], hn::Vec<F32> x, hn::Vec<F32> y,
                        const hn::Vec<F32> (&low)[3], hn::Vec<F32> half) {
  const F32 d;
  Aims aims;
  auto off = hn::Zero(d);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    const auto varying = varying_of(frame, axis, x, y, &off);
    aims.center[axis] = hn::Add(hn::MulAdd(low[axis], hn::Set(d, 512.0F), hn::Set(d, origin[axis])), half);
    if (kPerspective) {
      aims.direction[axis] = varying;
    } else {
      aims.direction[axis] = hn::Set(d, static_cast<float>(frame.direction[axis]));
      aims.center[axis] = hn::NegMulAdd(varying, hn::Set(d, 2.0F), aims.center[axis]);
    }
  }
  aims.unclear = rounding_is_unclear(frame, off);
  return aims;
}

// How far a centre lies along the ray's own direction of an axis.
HWY_INLINE hn::Vec<F32> ahead_of(hn::Vec<F32> center, hn::Vec<F32> direction) {
  const F32 d;
  return hn::Xor(center, hn::And(direction, hn::Set(d, -0.0F)));
}

// What floats decide about rays whose directions are clear, and boxes. `hit` means nothing where `unclear` is set.
struct Verdict {
  hn::Mask<F32> hit;
  hn::Mask<F32> unclear;
};

// A ray hits a box where none of three cross products exceeds its bound. So one product decides: the one that exceeds
// its bound by most or, where none does, comes closest to it.
//
// The bound is exact: half * (|d_a| + |d_b|) is an integer below 2^21 times a power of two. The product
// c_a d_b - c_b d_a, by Kahan's method with fused products, is within 2 units in its last place (C.-P.
// Jeannerod, N. Louvet, J.-M. Muller, "Further analysis of Kahan's algorithm", Math. Comp. 2013: 1.5). So the
// comparison is right where the two differ by more than 2^-21 of the bound. Without fused products the
// roundings of the two products count too.
template <bool kPerspective>
HWY_INLINE Verdict judge(const WideFrame& frame, const Aims& aims, hn::Vec<F32> half) {
  const F32 d;
  const auto zero = hn::Zero(d);
  const auto& center = aims.center;
  const auto& direction = aims.direction;
  // An orthographic camera's rays may all have a component of 0; of a perspective camera's only some have.
  hn::Vec<F32> size[3];
  bool still[3] = {false, false, false};
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = hn::Abs(direction[axis]);
    still[axis] = !kPerspective && frame.direction[axis] == 0;
  }
  auto excess = hn::Set(d, -1e30F);  // by how much the deciding product exceeds its bound
  auto magnitude = hn::Mul(half, hn::Add(hn::Add(size[0], size[1]), size[2]));
  constexpr int kPairs[3][2] = {{0, 1}, {1, 2}, {2, 0}};
#pragma GCC unroll 3
  for (int pair = 0; pair < 3; ++pair) {
    const int a = kPairs[pair][0];
    const int b = kPairs[pair][1];
    if (still[a] || still[b]) {
      continue;
    }
    const auto product = hn::Mul(center[b], direction[a]);
    const auto wanted = hn::Mul(half, hn::Add(size[a], size[b]));
#if HWY_NATIVE_FMA
    const auto error = hn::NegMulAdd(center[b], direction[a], product);
    const auto cross = hn::Abs(hn::Add(hn::MulSub(center[a], direction[b], product), error));
#else
    const auto other = hn::Mul(center[a], direction[b]);
    const auto cross = hn::Abs(hn::Sub(other, product));
    magnitude = hn::Max(magnitude, hn::Add(wanted, hn::Add(hn::Abs(other), hn::Abs(product))));
#endif
    excess = hn::Max(excess, hn::Sub(cross, wanted));
  }
  const auto margin = hn::Mul(magnitude, hn::Set(d, 1.0F / (1 << 21)));
  auto unclear = hn::Le(hn::Abs(excess), margin);
  auto hit = hn::Lt(excess, zero);
  // The box lies ahead when its farther plane lies ahead on every axis.
  const auto minus_half = hn::Neg(half);
  auto least_ahead = half;
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    if (still[axis]) {
      hit = hn::And(hit, hn::And(hn::Le(center[axis], half), hn::Gt(center[axis], minus_half)));
      continue;
    }
    least_ahead = hn::Min(least_ahead, ahead_of(center[axis], direction[axis]));
  }
  hit = hn::And(hit, hn::Gt(least_ahead, minus_half));
  if (kPerspective) {
    unclear = hn::Or(unclear, hn::Eq(hn::Min(size[0], hn::Min(size[1], size[2])), zero));
  }
  return {hit, unclear};
}

// Finds floor(dividend / speed) for integer speeds 1 .. 2^20: exactly where it is below 2^22, else within 2^-22 of
// itself. The quotient of floats is within 2^-23 of itself, so off by one at most; the remainder says which way.
HWY_INLINE hn::Vec<F32> ratios_of(const GrayScale& scale, hn::Vec<F32> speed) {
  const F32 d;
  const auto one = hn::Set(d, 1.0F);
  const auto dividend = hn::Set(d, scale.float_dividend);
  const auto quotient = hn::Floor(hn::Div(dividend, speed));
#if HWY_NATIVE_FMA
  const auto rest = hn::NegMulAdd(quotient, speed, dividend);
  const auto is_above = hn::Lt(rest, hn::Zero(d));
  const auto is_below = hn::Ge(rest, speed);
#else
  const I32 di;
  const auto int_speed = hn::ConvertTo(di, speed);
  const auto is_small = hn::Lt(quotient, hn::Set(d, 16777216.0F));
  const auto int_quotient = hn::ConvertTo(di, hn::IfThenElseZero(is_small, quotient));
  const auto rest = hn::Sub(hn::Set(di, scale.int_dividend), hn::Mul(int_quotient, int_speed));
  const auto is_above = hn::And(is_small, hn::RebindMask(d, hn::Lt(rest, hn::Zero(di))));
  const auto is_below =
      hn::And(is_small, hn::RebindMask(d, hn::Gt(rest, hn::Sub(int_speed, hn::Set(di, 1)))));
#endif
  return hn::Add(hn::Sub(quotient, hn::IfThenElseZero(is_above, one)), hn::IfThenElseZero(is_below, one));
}

// Finds greys from numerator * ratio = `product`, in units of 1/512 voxel. Adds to `unclear` the lanes whose
// grey floats do not decide (GrayScale). Greys do not jump at the near and far planes themselves; between these they
// change where the fall passes a whole number.
HWY_INLINE hn::Vec<U32> grays_in_floats(const GrayScale& scale, hn::Vec<F32> product,
                                        hn::Mask<F32>* unclear) {
  const F32 d;
  const auto depth = hn::Mul(product, hn::Set(d, 0.5F * scale.float_scale));
  const auto fall = hn::Mul(hn::Sub(depth, hn::Set(d, scale.float_near)), hn::Set(d, scale.float_per_depth));
  const auto most = hn::Set(d, static_cast<float>(kMostFall) + 0.5F);
  const auto clamped = hn::Max(hn::Set(d, 0.5F), hn::Min(fall, most));
  const auto off = hn::Abs(hn::Sub(clamped, hn::Round(clamped)));
  *unclear = hn::Or(*unclear, hn::Lt(off, hn::Set(d, scale.margin)));
  return small_number(hn::Sub(hn::Set(d, 255.0F), hn::Floor(clamped)));
}

// The plane through which each ray enters its box: of the nearer planes the one that it passes last, at numerator /
// speed.
struct EntryPlane {
  hn::Vec<F32> numerator;
  hn::Vec<F32> speed;

  HWY_INLINE EntryPlane() : numerator(hn::Zero(F32())), speed(hn::Set(F32(), 1.0F)) {}

  // Takes the plane of `axis` in the lanes whose rays pass it later than the planes taken before; returns these
  // lanes. No ray enters through a plane at or behind the origin (`distance` 0 or less). Compares products of a
  // distance (below 2^25) and a direction; adds to `unclear` the lanes in which two differ by less than four times
  // their rounding.
  HWY_INLINE hn::Mask<F32> take_later(int axis, hn::Vec<F32> distance, hn::Vec<F32> size,
                                      hn::Mask<F32>* unclear) {
    const F32 d;
    auto later = hn::Gt(distance, numerator);
    if (axis != 0) {
      const auto ours = hn::Mul(distance, speed);
      const auto theirs = hn::Mul(numerator, size);
      later = hn::Gt(ours, theirs);  // theirs are 0 or more
      const auto margin = hn::Mul(theirs, hn::Set(d, 1.0F / (1 << 21)));
      *unclear = hn::Or(*unclear, hn::Lt(hn::Abs(hn::Sub(ours, theirs)), margin));
    }
    numerator = hn::IfThenElse(later, distance, numerator);
    speed = hn::IfThenElse(later, size, speed);
    return later;
  }
};

// Finds the greys of single voxels that are hit. Adds to `unclear` the lanes that floats do not decide.
template <bool kPerspective>
HWY_INLINE hn::Vec<U32> grays_of(const WideFrame& frame, const GrayScale& scale, const Aims& aims,
                                 hn::Mask<F32>* unclear) {
  const F32 d;
  EntryPlane plane;  // in 1/512 voxel
  auto ratio = hn::Zero(d);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    if (!kPerspective && frame.direction[axis] == 0) {
      continue;
    }
    const auto size = hn::Abs(aims.direction[axis]);
    const auto distance = hn::Sub(ahead_of(aims.center[axis], aims.direction[axis]), hn::Set(d, 256.0F));
    const auto later = plane.take_later(axis, distance, size, unclear);
    if (!kPerspective) {
      ratio = hn::IfThenElse(later, hn::Set(d, scale.axis_ratio[axis]), ratio);
    }
  }
  if (kPerspective) {
    ratio = ratios_of(scale, plane.speed);
  }
  return grays_in_floats(scale, hn::Mul(plane.numerator, ratio), unclear);
}

// Finds the faces, plus 1, through which rays enter single voxels. Adds to `unclear` the lanes that floats do not
// decide. A ray that starts inside has the face opposed to its largest component, on a tie that of the lowest axis.
template <bool kPerspective>
HWY_INLINE hn::Vec<U32> faces_of(const WideFrame& frame, const Aims& aims, hn::Mask<F32>* unclear) {
  const F32 d;
  const U32 du;
  EntryPlane plane;
  auto code = hn::Zero(du);
  auto inside_code = hn::Zero(du);
  auto largest = hn::Set(d, -1.0F);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    if (!kPerspective && frame.direction[axis] == 0) {
      continue;
    }
    const auto size = hn::Abs(aims.direction[axis]);
    const auto distance = hn::Sub(ahead_of(aims.center[axis], aims.direction[axis]), hn::Set(d, 256.0F));
    const auto first = hn::Set(du, static_cast<uint32_t>(1 + 2 * axis));
    const auto is_upper = hn::RebindMask(du, hn::Lt(aims.direction[axis], hn::Zero(d)));
    const auto ours = hn::Add(first, hn::IfThenElseZero(is_upper, hn::Set(du, 1U)));
    const auto later = plane.take_later(axis, distance, size, unclear);
    code = hn::IfThenElse(hn::RebindMask(du, later), ours, code);
    const auto is_larger = hn::Gt(size, largest);
    inside_code = hn::IfThenElse(hn::RebindMask(du, is_larger), ours, inside_code);
    largest = hn::Max(largest, size);
  }
  return hn::IfThenElse(hn::Eq(code, hn::Zero(du)), inside_code, code);
}

// What a pixel keeps of the voxel that it shows.
enum class Keep : uint8_t { kNumbers, kGrays, kFaces };

template <bool kPerspective, Keep kKeep>
HWY_INLINE hn::Vec<U32> codes_of(const WideFrame& frame, const GrayScale& scale, const Aims& aims,
                                 hn::Mask<F32>* unclear) {
  return kKeep == Keep::kFaces ? faces_of<kPerspective>(frame, aims, unclear)
                               : grays_of<kPerspective>(frame, scale, aims, unclear);
}

// Finds the greys of t = numerator / (256 * speed) with the core's three roundings (src/picture/shading.cpp). Floor
// makes a ratio of integers below 2^32 exact: a ratio that is no integer lies farther from the next integer than a
// double's last bit. The product has up to 55 bits and is computed in two parts. The last quotient has a half added to
// its dividend, so it is no integer, and differs from the nearest one by more than the inverse divisor's error.
HWY_INLINE hn::Vec<HalfI32> grays_in_doubles(const GrayScale& scale, hn::Vec<F64> numerator,
                                             hn::Vec<F64> speed) {
  const F64 d;
  const HalfI32 d32;
  const auto zero = hn::Zero(d);
  const auto dividend = hn::Set(d, scale.dividend);
  const auto near_plane = hn::Set(d, scale.near_q8);
  const auto most_fall = hn::Set(d, static_cast<double>(kMostFall));
  const auto ratio = hn::Floor(hn::Div(dividend, speed));
  const auto high = hn::Floor(hn::Mul(ratio, hn::Set(d, 1.0 / 65536)));
  const auto low = hn::NegMulAdd(high, hn::Set(d, 65536), ratio);
  // numerator * ratio = a * 2^16 + b, divided by 2^(shift + 8) and rounded down.
  const auto a = hn::Mul(numerator, high);
  const auto b = hn::Mul(numerator, low);
  const auto b_high = hn::Floor(hn::Mul(b, hn::Set(d, 1.0 / 65536)));
  const auto whole = hn::Add(a, b_high);  // in units of 2^16, below 2^40
  hn::Vec<F64> depth;
  if (scale.shift + 8 >= 16) {
    depth = hn::Floor(hn::Mul(whole, hn::Set(d, scale.scale * 65536)));
  } else {
    const auto b_low = hn::NegMulAdd(b_high, hn::Set(d, 65536), b);
    depth = hn::Floor(
        hn::MulAdd(whole, hn::Set(d, scale.scale * 65536), hn::Mul(b_low, hn::Set(d, scale.scale))));
  }
  depth = hn::IfThenElse(hn::Gt(hn::Min(numerator, dividend), zero), hn::Min(depth, hn::Set(d, 2147483647.0)),
                         zero);
  const auto part = hn::Floor(hn::Mul(hn::Sub(depth, near_plane), hn::Set(d, scale.cut)));
  auto fall = hn::Floor(hn::Mul(hn::MulAdd(part, most_fall, hn::Set(d, 0.5)), hn::Set(d, scale.inverse)));
  fall = hn::IfThenElse(hn::Lt(depth, hn::Set(d, scale.far_q8)), fall, most_fall);
  fall = hn::IfThenElseZero(hn::Gt(depth, near_plane), fall);
  return hn::DemoteTo(d32, hn::Sub(hn::Set(d, 255.0), fall));
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
