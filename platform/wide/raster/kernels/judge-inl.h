/// Decides whether rays meet boxes, in floats where their error bound proves the answer.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_JUDGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_JUDGE_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_JUDGE_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_JUDGE_INL_H_
#endif

#include "wide/raster/frame.h"
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

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
