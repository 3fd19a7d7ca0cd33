// What floats decide and what integers decide: see README.md beside this file.
#include "wide/kernels.h"

#include "wide/exact.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F32 = hn::ScalableTag<float>;
using I32 = hn::RebindToSigned<F32>;
using U32 = hn::RebindToUnsigned<F32>;
using F64 = hn::ScalableTag<double>;
using U64 = hn::RebindToUnsigned<F64>;
using HalfI32 = hn::Rebind<int32_t, F64>;  // as many lanes as F64
using HalfU32 = hn::Rebind<uint32_t, F64>;

// A bit a lane.
template <class D>
inline uint32_t bits_of(D d, hn::Mask<D> mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return uint32_t{bytes[0]} | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[3]} << 24;
}

// The lanes in `mask`, moved to the front. For AVX2, Highway 1.0 has a table for this in the function, which
// gcc 12 copies onto the stack at each call: that was three quarters of a frame.
#if HWY_TARGET == HWY_AVX2
// The numbers of the lanes in a mask, four bits each.
struct LaneTable {
  uint32_t of[256];
  constexpr LaneTable() : of{} {
    for (uint32_t mask = 0; mask < 256; ++mask) {
      uint32_t shift = 0;
      for (uint32_t lane = 0; lane < 8; ++lane) {
        of[mask] |= (mask >> lane & 1U) * lane << shift;
        shift += 4 * (mask >> lane & 1U);
      }
    }
  }
};
constexpr LaneTable kLanesIn;

HWY_INLINE hn::Vec<U32> squeeze(hn::Vec<U32> v, hn::Mask<U32> mask) {
  const U32 d;
  const int bits = _mm256_movemask_ps(_mm256_castsi256_ps(hn::VecFromMask(d, mask).raw));
  const auto packed = hn::Set(d, kLanesIn.of[bits]);
  const auto shifts = hn::ShiftLeft<2>(hn::Iota(d, 0));
  return hn::Vec<U32>{_mm256_permutevar8x32_epi32(v.raw, hn::Shr(packed, shifts).raw)};
}
#else
HWY_INLINE hn::Vec<U32> squeeze(hn::Vec<U32> v, hn::Mask<U32> mask) {
  return hn::Compress(v, mask);
}
#endif

constexpr uint32_t kWithin = 1023;  // a coordinate within a cube of entries

// The first `count` numbers from there, and zeros. Reads no others: they may be another thread's.
HWY_INLINE hn::Vec<U32> load_some(const uint32_t* from, int32_t count) {
  const U32 d;
  const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
  if (count >= lanes) {
    return hn::LoadU(d, from);
  }
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_AVX2
  return hn::MaskedLoad(hn::FirstN(d, static_cast<size_t>(count)), d, from);
#else
  HWY_ALIGN uint32_t some[64] = {};
  for (int32_t i = 0; i < count; ++i) {
    some[i] = from[i];
  }
  return hn::Load(d, some);
#endif
}

// The exact rays of some pixels: numbers that are integers, held in doubles.
struct Rays {
  hn::Vec<F64> origin[3];
  hn::Vec<F64> direction[3];
};

// round(base + x * step_x + y * step_y) / 2^32 with halves away from zero, in exact steps: high parts are
// below 2^52, low parts below 2^36.
inline hn::Vec<F64> rounded(const Frame& frame, int axis, hn::Vec<F64> x, hn::Vec<F64> y) {
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
inline Rays rays_of(const Frame& frame, hn::Vec<F64> x, hn::Vec<F64> y) {
  const F64 d;
  Rays rays;
  for (int axis = 0; axis < 3; ++axis) {
    const auto varying = rounded(frame, axis, x, y);
    if (kPerspective) {
      rays.origin[axis] = hn::Set(d, static_cast<double>(frame.camera.eye()[axis].raw));
      rays.direction[axis] = varying;
    } else {
      rays.origin[axis] = hn::Add(hn::Set(d, static_cast<double>(frame.camera.eye()[axis].raw)), varying);
      rays.direction[axis] = hn::Set(d, static_cast<double>(frame.camera.direction()[axis]));
    }
  }
  return rays;
}

// Bits 0..9 to every third bit.
inline hn::Vec<U32> spread10(hn::Vec<U32> v) {
  const U32 d;
  v = hn::And(hn::Or(v, hn::ShiftLeft<16>(v)), hn::Set(d, 0x030000FFU));
  v = hn::And(hn::Or(v, hn::ShiftLeft<8>(v)), hn::Set(d, 0x0300F00FU));
  v = hn::And(hn::Or(v, hn::ShiftLeft<4>(v)), hn::Set(d, 0x030C30C3U));
  return hn::And(hn::Or(v, hn::ShiftLeft<2>(v)), hn::Set(d, 0x09249249U));
}

// The side of boxes in voxels as a power of two, and their x without the bits that tell it.
template <class D>
inline void unpack_side(D d, hn::Vec<D> entry, bool unit, hn::Vec<D>* level, hn::Vec<D>* x) {
  *x = hn::And(entry, hn::Set(d, 1023U));
  *level = hn::Zero(d);
  if (!unit) {
    const auto code = hn::ShiftRight<30>(entry);
    const auto is_large = hn::Eq(code, hn::Set(d, 3U));
    const auto more = hn::IfThenElseZero(is_large, hn::And(entry, hn::Set(d, 7U)));
    *x = hn::Sub(*x, more);
    *level = hn::Add(code, more);
  }
}

// The value that Depths keeps, less the entry's number.
inline uint64_t value_of(const Batch& batch, uint32_t key, uint32_t down, uint32_t number) {
  return batch.cube_value[down] | uint64_t{key} << kEntryBits | number;
}

// Takes what was met into the picture.
template <bool kGray, bool kMarks>
HWY_INLINE void keep_of(const Depths& depths, Batch* batch) {
  // In locals, since bytes that are written might be theirs.
  const size_t met = batch->met;
  uint32_t* const all_covered = depths.covered;
  uint64_t* const all_nearest = depths.nearest;
  uint16_t* const all_sums = depths.nearest_sum;
  uint8_t* const all_grays = depths.gray;
  // Behind the last there is room to read.
  constexpr size_t kAhead = 32;
  static_assert(kAhead <= Pairs::kRoom - Pairs::kSize);
  for (size_t i = met; i < met + kAhead; ++i) {
    batch->pixel[i] = 0;
  }
  for (size_t i = 0; i < met; ++i) {
    const uint32_t pixel = batch->pixel[i];
    const uint32_t ahead = batch->pixel[i + kAhead];
    const uint32_t bit = uint32_t{1} << (pixel & 31U);
    // No branch: what is there when there is nothing is made the greatest number.
    if (kGray) {
      __builtin_prefetch(all_sums + ahead, 1);
      __builtin_prefetch(all_grays + ahead, 1);
      const uint32_t gray = all_grays[pixel];
      const uint32_t sum = batch->key[i];
      const uint32_t before = all_sums[pixel] | (gray - 1) >> 16;
      const uint32_t is_less = 0 - ((sum - before) >> 31);
      all_grays[pixel] = static_cast<uint8_t>(gray ^ ((batch->number[i] ^ gray) & is_less));
      all_sums[pixel] = static_cast<uint16_t>(before ^ ((sum ^ before) & is_less));
    } else {
      __builtin_prefetch(all_nearest + ahead, 1);
      const uint64_t value = value_of(*batch, batch->key[i], batch->down[i], batch->number[i]);
      const uint64_t nothing = uint64_t{all_covered[pixel >> 5] >> (pixel & 31U) & 1U} - 1;
      const uint64_t before = all_nearest[pixel] | nothing;
      all_nearest[pixel] = value < before ? value : before;
    }
    if (kMarks) {
      all_covered[pixel >> 5] |= bit;
    }
  }
  batch->counts.hits += met;
  batch->met = 0;
}

HWY_NOINLINE void keep(const Depths& depths, Batch* batch) {
  if (batch->met == 0) {
    return;
  }
  if (depths.gray_scale == nullptr) {
    keep_of<false, true>(depths, batch);
  } else if (depths.marks) {
    keep_of<true, true>(depths, batch);
  } else {
    keep_of<true, false>(depths, batch);
  }
}

// Some rays, and the middles of boxes as seen from their origins; all integers, and exact.
struct Aims {
  hn::Vec<F32> direction[3];
  hn::Vec<F32> center[3];  // in 1/512 voxel
  hn::Mask<F32> unclear;   // where floats do not tell what the ray is
};

// Rounded directions: off a half by more than the error of the float map, the float's nearest integer is the
// direction. Centres (below 2^24) and directions (at most 20 bits) are then exact.
//
// `low` are lowest corners within the cube, in voxels; `half` half sides in 1/512 voxel; `origin` the cube's
// corner less the eye, in 1/512 voxel.
template <bool kPerspective>
HWY_INLINE Aims aims_of(const Frame& frame, const float (&origin)[3], hn::Vec<F32> x, hn::Vec<F32> y,
                        const hn::Vec<F32> (&low)[3], hn::Vec<F32> half) {
  const F32 d;
  Aims aims;
  auto off = hn::Zero(d);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    const auto map = [&](const float(&of)[3][3]) {
      return hn::MulAdd(x, hn::Set(d, of[1][axis]),
                        hn::MulAdd(y, hn::Set(d, of[2][axis]), hn::Set(d, of[0][axis])));
    };
    const auto rest = map(frame.map_rest);
    const auto nearest = hn::Round(rest);
    off = hn::Max(off, hn::Abs(hn::Sub(rest, nearest)));
    const auto varying = hn::Add(map(frame.map_whole), nearest);
    aims.center[axis] = hn::Add(hn::MulAdd(low[axis], hn::Set(d, 512.0F), hn::Set(d, origin[axis])), half);
    if (kPerspective) {
      aims.direction[axis] = varying;
    } else {
      aims.direction[axis] = hn::Set(d, static_cast<float>(frame.camera.direction()[axis]));
      aims.center[axis] = hn::NegMulAdd(varying, hn::Set(d, 2.0F), aims.center[axis]);
    }
  }
  aims.unclear = hn::Gt(off, hn::Set(d, 0.5F - frame.map_error));
  return aims;
}

// How far a middle lies along the ray.
HWY_INLINE hn::Vec<F32> ahead_of(hn::Vec<F32> center, hn::Vec<F32> direction) {
  const F32 d;
  return hn::Xor(center, hn::And(direction, hn::Set(d, -0.0F)));
}

// What floats say of some rays and boxes, if they tell what the rays are: `met` only where `unclear` is not
// set.
struct Verdict {
  hn::Mask<F32> met;
  hn::Mask<F32> unclear;
};

// A box is met where none of three cross products is too great; so it is the one that comes closest to its
// bound, or exceeds it by most, that decides.
//
// What is compared with is exact: half * (|d_a| + |d_b|) is an integer below 2^21 times a power of two.
// c_a d_b - c_b d_a, by Kahan's method with fused products, is within 2 units in the last place of itself
// (C.-P. Jeannerod, N. Louvet, J.-M. Muller, "Further analysis of Kahan's algorithm", Math. Comp. 2013: 1.5),
// so 2^-21 of the bound settles what differs from it by more; without fused products the two roundings of the
// products count too.
template <bool kPerspective>
HWY_INLINE Verdict judge(const Frame& frame, const Aims& aims, hn::Vec<F32> half) {
  const F32 d;
  const auto zero = hn::Zero(d);
  const auto& center = aims.center;
  const auto& direction = aims.direction;
  // An orthographic camera's rays may all stand still along an axis; a perspective camera's do so here and
  // there.
  hn::Vec<F32> size[3];
  bool still[3] = {false, false, false};
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = hn::Abs(direction[axis]);
    still[axis] = !kPerspective && frame.camera.direction()[axis] == 0;
  }
  auto excess = hn::Set(d, -1e30F);  // of the worst product over its bound
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
  auto met = hn::Lt(excess, zero);
  // The upper plane, as the ray goes, lies ahead.
  const auto minus_half = hn::Neg(half);
  auto least_ahead = half;
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    if (still[axis]) {
      met = hn::And(met, hn::And(hn::Le(center[axis], half), hn::Gt(center[axis], minus_half)));
      continue;
    }
    least_ahead = hn::Min(least_ahead, ahead_of(center[axis], direction[axis]));
  }
  met = hn::And(met, hn::Gt(least_ahead, minus_half));
  if (kPerspective) {
    unclear = hn::Or(unclear, hn::Eq(hn::Min(size[0], hn::Min(size[1], size[2])), zero));
  }
  return {met, unclear};
}

// Whole numbers 0 .. 65535. (ConvertTo minds numbers that no integer holds.)
HWY_INLINE hn::Vec<U32> small_number(hn::Vec<F32> value) {
  const F32 d;
  const U32 du;
  return hn::And(hn::BitCast(du, hn::Add(value, hn::Set(d, 8388608.0F))), hn::Set(du, 0xFFFFU));
}

// floor(dividend / speed) for integers 1 .. 2^20: exactly below 2^22, and within 2^-22 of itself above. The
// quotient of floats is within 2^-23 of itself, so off by one at most; the remainder says which way.
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

// Greys of numerator * ratio = `product`, in units of `unit` / 256 voxel. Where floats do not tell
// (GrayScale), `unclear` is added to. There is no step at either plane: between them the fall changes at
// whole numbers.
HWY_INLINE hn::Vec<U32> grays_in_floats(const GrayScale& scale, hn::Vec<F32> product, float unit,
                                        hn::Mask<F32>* unclear) {
  const F32 d;
  const auto depth = hn::Mul(product, hn::Set(d, unit * scale.float_scale));
  const auto fall = hn::Mul(hn::Sub(depth, hn::Set(d, scale.float_near)), hn::Set(d, scale.float_per_depth));
  const auto most = hn::Set(d, static_cast<float>(255 - kFarBrightness) + 0.5F);
  const auto clamped = hn::Max(hn::Set(d, 0.5F), hn::Min(fall, most));
  const auto off = hn::Abs(hn::Sub(clamped, hn::Round(clamped)));
  *unclear = hn::Or(*unclear, hn::Lt(off, hn::Set(d, scale.margin)));
  return small_number(hn::Sub(hn::Set(d, 255.0F), hn::Floor(clamped)));
}

// The greys of voxels that are met, from what was found on the way; `unclear` is added to where floats do not
// tell: GrayScale. Products of a distance (below 2^25) and a direction are compared where they differ by more
// than four times what their roundings can make.
template <bool kPerspective>
HWY_INLINE hn::Vec<U32> grays_of(const Frame& frame, const GrayScale& scale, const Aims& aims,
                                 hn::Mask<F32>* unclear) {
  const F32 d;
  // The latest of the nearer planes. What lies at or behind the origin is not entered through.
  auto numerator = hn::Zero(d);  // in 1/512 voxel
  auto speed = hn::Set(d, 1.0F);
  auto ratio = hn::Zero(d);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    if (!kPerspective && frame.camera.direction()[axis] == 0) {
      continue;
    }
    const auto size = hn::Abs(aims.direction[axis]);
    const auto distance = hn::Sub(ahead_of(aims.center[axis], aims.direction[axis]), hn::Set(d, 256.0F));
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
    if (!kPerspective) {
      ratio = hn::IfThenElse(later, hn::Set(d, scale.axis_ratio[axis]), ratio);
    }
  }
  if (kPerspective) {
    ratio = ratios_of(scale, speed);
  }
  return grays_in_floats(scale, hn::Mul(numerator, ratio), 0.5F, unclear);
}

// Puts pairs of the lanes in `mask` behind the last. With kGray without numbers, which greys do not need.
template <bool kGray = false>
HWY_INLINE void append(hn::Mask<F32> mask, hn::Vec<U32> entry, hn::Vec<U32> number, hn::Vec<U32> place,
                       Pairs* pairs) {
  const U32 d;
  const auto chosen = hn::RebindMask(d, mask);
  hn::StoreU(squeeze(entry, chosen), d, pairs->entry + pairs->count);
  if (!kGray) {
    hn::StoreU(squeeze(number, chosen), d, pairs->number + pairs->count);
  }
  hn::StoreU(squeeze(place, chosen), d, pairs->place + pairs->count);
  pairs->count += hn::CountTrue(d, chosen);
}

inline void origin_of(const Frame& frame, const Batch& batch, float (&origin)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    origin[axis] =
        static_cast<float>(int64_t{512} * batch.corner[axis] - int64_t{2} * frame.camera.eye()[axis].raw);
  }
}

// The exact test of what floats could not tell.
void test_unclear(const Frame& frame, const Depths& depths, bool* kept, Batch* batch) {
  Pairs& pairs = batch->unclear;
  batch->counts.exact += pairs.count;
  for (size_t i = 0; i < pairs.count; ++i) {
    const int32_t x = static_cast<int32_t>(pairs.place[i] & 0xFFFFU);
    const int32_t y = static_cast<int32_t>(pairs.place[i] >> 16);
    uint32_t key = 0;
    uint32_t down = 0;
    if (!meets_exactly(frame.camera.ray(x, y), pairs.entry[i], batch->corner, &key, &down)) {
      continue;
    }
    if (batch->met >= Pairs::kSize) {
      keep(depths, batch);
      *kept = true;
    }
    batch->key[batch->met] = key;
    batch->down[batch->met] = down;
    batch->number[batch->met] = pairs.number[i];
    if (depths.gray_scale != nullptr) {
      batch->key[batch->met] = mirrored_sum(pairs.entry[i], down);
      batch->number[batch->met] =
          gray_exactly(frame.camera, *depths.shading, frame.camera.ray(x, y), pairs.entry[i], batch->corner);
    }
    batch->pixel[batch->met] =
        static_cast<uint32_t>(32 * depths.word(x, y) + (static_cast<uint32_t>(x) & 31U));
    ++batch->met;
  }
  pairs.count = 0;
}

// Depths::word of some pixels.
HWY_INLINE hn::Vec<U32> word_of(const Depths& depths, hn::Vec<U32> x, hn::Vec<U32> y) {
  const U32 d;
  const auto row = hn::Sub(y, hn::Set(d, static_cast<uint32_t>(depths.first_row)));
  return hn::Add(hn::Mul(hn::ShiftRight<5>(x), hn::Set(d, static_cast<uint32_t>(depths.rows))), row);
}

// Pairs, unpacked.
template <bool kUnit>
struct Unpacked {
  hn::Vec<U32> entry, x, y, level;
  hn::Vec<U32> low[3];
  hn::Vec<F32> half;

  Unpacked(const Pairs& pairs, size_t at) {
    const F32 d;
    const I32 di;
    const U32 du;
    const auto place = hn::Load(du, pairs.place + at);
    x = hn::And(place, hn::Set(du, 0xFFFFU));
    y = hn::ShiftRight<16>(place);
    entry = hn::Load(du, pairs.entry + at);
    unpack_side(du, entry, kUnit, &level, &low[0]);
    half = kUnit ? hn::Set(d, 256.0F) : hn::ConvertTo(d, hn::BitCast(di, hn::Shl(hn::Set(du, 256U), level)));
    low[1] = hn::And(hn::ShiftRight<10>(entry), hn::Set(du, kWithin));
    low[2] = hn::And(hn::ShiftRight<20>(entry), hn::Set(du, kWithin));
  }

  template <bool kPerspective>
  HWY_INLINE Aims aims(const Frame& frame, const float (&origin)[3]) const {
    const auto real = [](hn::Vec<U32> v) { return hn::ConvertTo(F32(), hn::BitCast(I32(), v)); };
    const hn::Vec<F32> corner[3] = {real(low[0]), real(low[1]), real(low[2])};
    return aims_of<kPerspective>(frame, origin, real(x), real(y), corner, half);
  }
};

// Puts what was met into a row, with keys mirrored by the signs of the directions. `number`: of the entries,
// or greys.
template <bool kUnit, bool kGray>
HWY_INLINE void take(hn::Mask<F32> met, const Unpacked<kUnit>& pairs, const Aims& aims, hn::Vec<U32> number,
                     const Depths& depths, bool* kept, Batch* batch) {
  const F32 d;
  const I32 di;
  const U32 du;
  const auto within = hn::Set(du, kWithin);
  if (batch->met + hn::Lanes(d) > Pairs::kSize) {
    keep(depths, batch);
    *kept = true;
  }
  auto key = hn::Zero(du);
  [[maybe_unused]] auto down = hn::Zero(du);
#pragma GCC unroll 3
  for (int axis = 2; axis >= 0; --axis) {
    const auto is_down = hn::RebindMask(du, hn::Lt(aims.direction[axis], hn::Zero(d)));
    auto mirrored = hn::Xor(pairs.low[axis], hn::IfThenElseZero(is_down, within));
    if (kGray) {
      key = hn::Add(key, mirrored);
      continue;
    }
    if (!kUnit) {
      const auto side_mask = hn::Neg(hn::BitCast(di, hn::Shl(hn::Set(du, 1U), pairs.level)));
      mirrored = hn::And(mirrored, hn::BitCast(du, side_mask));
    }
    key = hn::Or(hn::ShiftLeft<1>(key), spread10(mirrored));
    down = hn::Or(hn::ShiftLeft<1>(down), hn::IfThenElseZero(is_down, hn::Set(du, 1U)));
  }
  const auto pixel =
      hn::Or(hn::ShiftLeft<5>(word_of(depths, pairs.x, pairs.y)), hn::And(pairs.x, hn::Set(du, 31U)));
  const auto chosen = hn::RebindMask(du, met);
  hn::StoreU(squeeze(key, chosen), du, batch->key + batch->met);
  if (!kGray) {
    hn::StoreU(squeeze(down, chosen), du, batch->down + batch->met);
  }
  hn::StoreU(squeeze(number, chosen), du, batch->number + batch->met);
  hn::StoreU(squeeze(pixel, chosen), du, batch->pixel + batch->met);
  batch->met += hn::CountTrue(du, chosen);
}

// The lanes of each vector of pairs that floats could not tell. They are put aside when all are tested: a
// branch for each vector would be guessed wrong now and then, just where much waits for it.
class Unclear {
 public:
  HWY_INLINE void set(size_t vector, hn::Mask<F32> lanes) { lanes_[vector] = bits_of(F32(), lanes); }
  void put_aside(const Frame& frame, const Depths& depths, bool* kept, Batch* batch) const {
    const size_t lanes = hn::Lanes(F32());
    const Pairs& pairs = batch->waiting;
    Pairs& unclear = batch->unclear;
    for (size_t at = 0; at < pairs.count; at += lanes) {
      for (uint32_t bits = lanes_[at / lanes]; bits != 0; bits &= bits - 1) {
        const size_t pair = at + static_cast<size_t>(__builtin_ctz(bits));
        unclear.entry[unclear.count] = pairs.entry[pair];
        unclear.number[unclear.count] = pairs.number[pair];
        unclear.place[unclear.count] = pairs.place[pair];
        if (++unclear.count == Pairs::kSize) {
          test_unclear(frame, depths, kept, batch);
        }
      }
    }
  }

 private:
  uint32_t lanes_[Pairs::kSize];
};

// Leaves of the pairs that wait, with greys, those that are met; and those whose rays are not clear, which
// whoever comes to them next sees again.
template <bool kPerspective>
HWY_NOINLINE void leave_met(const Frame& frame, const float (&origin)[3], const Depths& depths, bool* kept,
                            Batch* batch) {
  Pairs* const pairs = &batch->waiting;
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  size_t count = 0;
  for (size_t at = 0; at < pairs->count; at += lanes) {
    const auto live = hn::FirstN(d, pairs->count - at < lanes ? pairs->count - at : lanes);
    const Unpacked<true> unpacked(*pairs, at);
    const Aims aims = unpacked.template aims<kPerspective>(frame, origin);
    const Verdict verdict = judge<kPerspective>(frame, aims, unpacked.half);
    const auto place = hn::Load(du, pairs->place + at);
    const auto may_be_met = hn::Or(hn::AndNot(verdict.unclear, verdict.met), aims.unclear);
    const auto chosen = hn::RebindMask(du, hn::And(live, may_be_met));
    const auto unclear = hn::AndNot(aims.unclear, hn::And(live, verdict.unclear));
    if (HWY_UNLIKELY(!hn::AllFalse(d, unclear))) {
      append<true>(unclear, unpacked.entry, unpacked.entry, place, &batch->unclear);
      if (batch->unclear.count + lanes > Pairs::kSize) {
        test_unclear(frame, depths, kept, batch);
      }
    }
    hn::StoreU(squeeze(unpacked.entry, chosen), du, pairs->entry + count);
    hn::StoreU(squeeze(place, chosen), du, pairs->place + count);
    count += hn::CountTrue(du, chosen);
  }
  pairs->count = count;
}

// Tests what waits in floats where they can tell, and puts aside the rest. `kept`: set when something went
// into the picture.
//
// Greys are found of those that were met alone, where these are fewer: the pairs that were met are first
// moved to the front. A parallel camera meets nearly all of them, and its greys take no division.
template <bool kPerspective, bool kUnit, bool kGray>
HWY_NOINLINE void test_waiting_of(const Frame& frame, const Depths& depths, bool* kept, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  Pairs& pairs = batch->waiting;
  batch->counts.candidates += pairs.count;
  float origin[3];
  origin_of(frame, *batch, origin);
  constexpr bool kTwice = kGray && kPerspective;
  if (kTwice) {
    leave_met<kPerspective>(frame, origin, depths, kept, batch);
  }
  Unclear all_unclear;
  for (size_t at = 0; at < pairs.count; at += lanes) {
    const auto live = hn::FirstN(d, pairs.count - at < lanes ? pairs.count - at : lanes);
    const Unpacked<kUnit> unpacked(pairs, at);
    const Aims aims = unpacked.template aims<kPerspective>(frame, origin);
    auto unclear = aims.unclear;
    auto met = live;
    if (!kTwice) {
      const Verdict verdict = judge<kPerspective>(frame, aims, unpacked.half);
      unclear = hn::Or(unclear, verdict.unclear);
      met = hn::And(met, verdict.met);
    }
    hn::Vec<U32> number;
    if (kGray) {
      auto no_gray = hn::Lt(hn::Zero(d), hn::Zero(d));
      number = grays_of<kPerspective>(frame, *depths.gray_scale, aims, &no_gray);
      unclear = hn::Or(unclear, hn::And(no_gray, met));
    } else {
      number = hn::Load(du, pairs.number + at);
    }
    all_unclear.set(at / lanes, hn::And(unclear, live));
    take<kUnit, kGray>(hn::AndNot(unclear, met), unpacked, aims, number, depths, kept, batch);
  }
  all_unclear.put_aside(frame, depths, kept, batch);
  pairs.count = 0;
}

template <bool kPerspective, bool kUnit>
HWY_INLINE void test_waiting(const Frame& frame, const Depths& depths, bool* kept, Batch* batch) {
  if (depths.gray_scale != nullptr) {  // all boxes are single voxels
    test_waiting_of<kPerspective, true, true>(frame, depths, kept, batch);
    return;
  }
  test_waiting_of<kPerspective, kUnit, false>(frame, depths, kept, batch);
}

// Of the pixels (x .. x + 31, y), a bit each: whether they are not covered. Of those right of the picture,
// and of lanes outside `mask`, anything.
HWY_INLINE hn::Vec<U32> open_at(const Depths& depths, hn::Mask<F32> mask, hn::Vec<U32> x, hn::Vec<U32> y) {
  const U32 d;
  const auto word = hn::IfThenElseZero(hn::RebindMask(d, mask), word_of(depths, x, y));
  const auto column = hn::And(x, hn::Set(d, 31U));
#if HWY_TARGET == HWY_SCALAR
  const auto covered = hn::Set(d, depths.covered[hn::GetLane(word)]);
  const auto beside = hn::Set(d, depths.covered[hn::GetLane(word) + static_cast<uint32_t>(depths.rows)]);
#else
  const auto covered = hn::GatherIndex(d, depths.covered, hn::BitCast(I32(), word));
  const auto beside = hn::GatherIndex(d, depths.covered + depths.rows, hn::BitCast(I32(), word));
#endif
  // Shifted by 32 in two steps where the column is 0.
  const auto from_beside = hn::Shl(hn::Add(beside, beside), hn::Xor(column, hn::Set(d, 31U)));
  return hn::Not(hn::Or(hn::Shr(covered, column), from_beside));
}

// How far boxes of `side` voxels reach from their middles' places on the picture: frame.h.
template <class D>
struct Extent {
  hn::Vec<D> x;
  hn::Vec<D> y;
};

template <bool kPerspective, class D>
HWY_INLINE Extent<D> extent(D d, const Frame& frame, hn::Vec<D> side, hn::Vec<D> column, hn::Vec<D> row,
                            hn::Vec<D> per_depth) {
  const auto one = hn::Set(d, 1.0F);
  auto half_x = hn::MulAdd(hn::Set(d, frame.reach_x), side, hn::Set(d, frame.rounding_x));
  auto half_y = hn::MulAdd(hn::Set(d, frame.reach_y), side, hn::Set(d, frame.rounding_y));
  half_x = hn::MulAdd(half_x, per_depth, hn::Set(d, frame.slack_x));
  half_y = hn::MulAdd(half_y, per_depth, hn::Set(d, frame.slack_y));
  if (kPerspective) {
    const auto nearness = hn::Mul(hn::Mul(hn::Set(d, frame.half_w), side), per_depth);
    const auto k = hn::MulAdd(hn::Mul(hn::Set(d, 0.5F), side), per_depth,
                              hn::Mul(hn::Set(d, frame.per_direction), hn::Add(one, nearness)));
    const auto r = hn::Mul(k, hn::Set(d, frame.norm_w));
    const auto factor = hn::Mul(k, hn::MulAdd(r, hn::Set(d, 1.152F), hn::Set(d, 1.001F)));
    const auto reach = [&](const float(&of)[4], auto place) {
      auto sum = hn::Abs(hn::NegMulAdd(place, hn::Set(d, frame.w[0]), hn::Set(d, of[0])));
      sum = hn::Add(sum, hn::Abs(hn::NegMulAdd(place, hn::Set(d, frame.w[1]), hn::Set(d, of[1]))));
      return hn::Add(sum, hn::Abs(hn::NegMulAdd(place, hn::Set(d, frame.w[2]), hn::Set(d, of[2]))));
    };
    const auto is_far = hn::Le(r, hn::Set(d, 0.125F));
    const auto near_x = hn::MulAdd(hn::Set(d, frame.rounding_x), per_depth, hn::Set(d, frame.spread_x));
    const auto near_y = hn::MulAdd(hn::Set(d, frame.rounding_y), per_depth, hn::Set(d, frame.spread_y));
    half_x = hn::IfThenElse(is_far, hn::MulAdd(reach(frame.u, column), factor, near_x), half_x);
    half_y = hn::IfThenElse(is_far, hn::MulAdd(reach(frame.v, row), factor, near_y), half_y);
  }
  return {half_x, half_y};
}

// Makes candidates of some boxes: pairs with each of their pixels, but for covered ones, until something goes
// into the picture (`kept`).
template <bool kPerspective, bool kUnit>
HWY_INLINE void pair_vector(const Frame& frame, const Depths& depths, hn::Mask<F32> live, hn::Vec<U32> entry,
                            hn::Vec<U32> number, hn::Vec<U32> place, hn::Vec<U32> wide_x, hn::Vec<U32> wide_y,
                            bool* kept, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  Pairs& waiting = batch->waiting;
  const auto x = hn::And(place, hn::Set(du, 0xFFFFU));
  const auto y = hn::ShiftRight<16>(place);
  auto in_row = live;
  for (uint32_t down = 0; !hn::AllFalse(d, in_row); ++down) {
    auto in_column = in_row;
    auto open = hn::Set(du, UINT32_MAX);
    const bool rejects = batch->all_behind && !*kept;
    if (rejects) {
      open = open_at(depths, in_row, x, hn::Add(y, hn::Set(du, down)));
    }
    for (uint32_t across = 0; !hn::AllFalse(d, in_column); ++across) {
      auto chosen = in_column;
      if (rejects) {
        chosen = hn::And(chosen, hn::RebindMask(d, hn::TestBit(open, hn::Set(du, 1U << across))));
      }
      append(chosen, entry, number, hn::Add(place, hn::Set(du, down << 16 | across)), &waiting);
      if (waiting.count + lanes > Pairs::kSize) {
        test_waiting<kPerspective, kUnit>(frame, depths, kept, batch);
      }
      in_column = hn::And(in_column, hn::RebindMask(d, hn::Gt(wide_x, hn::Set(du, across))));
    }
    in_row = hn::And(in_row, hn::RebindMask(d, hn::Gt(wide_y, hn::Set(du, down))));
  }
}

// The coordinates of a picked pixel.
constexpr uint32_t kPlacePixels = ((1U << kPlaceBits) - 1) * 0x10001U;

// Makes candidates of those that were picked.
template <bool kPerspective, bool kGray>
HWY_NOINLINE void pair_picked_of(const Frame& frame, const Depths& depths, bool* kept, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  Picked& picked = batch->picked;
  Pairs& waiting = batch->waiting;
  const auto pixels = hn::Set(du, kPlacePixels);
  for (size_t at = 0; at < picked.count; at += lanes) {
    if (waiting.count + 4 * lanes > Pairs::kSize) {
      test_waiting<kPerspective, true>(frame, depths, kept, batch);
    }
    const auto live = hn::FirstN(d, picked.count - at < lanes ? picked.count - at : lanes);
    const auto entry = hn::Load(du, picked.entry + at);
    const auto number = kGray ? hn::Zero(du) : hn::Load(du, picked.number + at);
    const auto packed = hn::Load(du, picked.place + at);
    const auto first = hn::And(packed, pixels);
    for (uint32_t pixel = 0; pixel < 4; ++pixel) {
      const uint32_t below = pixel >> 1;
      const uint32_t beside = pixel & 1U;
      const auto is_meant =
          hn::TestBit(packed, hn::Set(du, uint32_t{1} << (kPlaceBits + 16 * below + beside)));
      append<kGray>(hn::And(live, hn::RebindMask(d, is_meant)), entry, number,
                    hn::And(hn::Add(first, hn::Set(du, below << 16 | beside)), pixels), &waiting);
    }
  }
  picked.count = 0;
}

template <bool kPerspective>
void pair_picked(const Frame& frame, const Depths& depths, bool* kept, Batch* batch) {
  depths.gray_scale != nullptr ? pair_picked_of<kPerspective, true>(frame, depths, kept, batch)
                               : pair_picked_of<kPerspective, false>(frame, depths, kept, batch);
}

// Makes candidates of the boxes that wait.
template <bool kPerspective, bool kUnit>
HWY_NOINLINE void pair_boxes(const Frame& frame, const Depths& depths, bool* kept, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  if (batch->picked.count != 0) {
    pair_picked<kPerspective>(frame, depths, kept, batch);
  }
  Boxes& boxes = batch->boxes;
  for (size_t at = 0; at < boxes.count; at += lanes) {
    const auto live = hn::FirstN(d, boxes.count - at < lanes ? boxes.count - at : lanes);
    const auto wide = hn::Load(du, boxes.wide + at);
    pair_vector<kPerspective, kUnit>(frame, depths, live, hn::Load(du, boxes.entry + at),
                                     hn::Load(du, boxes.number + at), hn::Load(du, boxes.place + at),
                                     hn::And(wide, hn::Set(du, 0xFFFFU)), hn::ShiftRight<16>(wide), kept,
                                     batch);
  }
  boxes.count = 0;
  batch->all_behind = true;
}

// A box that covers many pixels: along the rows of its rectangle, a vector of pixels at a time, straight into
// the picture. `reject`: covered pixels need no look.
template <bool kPerspective, bool kGray>
HWY_NOINLINE void draw_large_in(const Frame& frame, uint32_t entry, uint32_t number, const Rectangle& where,
                                bool reject, const Depths& depths, Batch* batch) {
  const F32 d;
  const U64 d64;
  const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
  const uint32_t all_lanes = lanes == 32 ? UINT32_MAX : (uint32_t{1} << lanes) - 1;
  const int32_t lanes64 = static_cast<int32_t>(hn::Lanes(d64));
  const int32_t level = level_of(entry);
  const uint32_t corner[3] = {x_of(entry), entry >> 10 & kWithin, entry >> 20 & kWithin};
  const hn::Vec<F32> low[3] = {hn::Set(d, static_cast<float>(corner[0])),
                               hn::Set(d, static_cast<float>(corner[1])),
                               hn::Set(d, static_cast<float>(corner[2]))};
  const auto half = hn::Set(d, static_cast<float>(256 << level));
  float origin[3];
  origin_of(frame, *batch, origin);
  uint32_t known_down = 8;
  uint64_t value = 0;
  const auto value_for = [&](uint32_t down) {
    if (kGray) {
      return uint64_t{mirrored_sum(entry, down)};
    }
    return value_of(*batch, mirrored_key(corner, level, down), down, number);
  };
  // What is kept of one pixel when its value is less.
  const auto put = [&](uint32_t* word, uint32_t bit, size_t at, uint64_t one, uint8_t gray) {
    if (kGray) {
      if (depths.gray[at] == 0 || one < depths.nearest_sum[at]) {
        depths.nearest_sum[at] = static_cast<uint16_t>(one);
        depths.gray[at] = gray;
      }
    } else if ((*word & bit) == 0 || one < depths.nearest[at]) {
      depths.nearest[at] = one;
    }
    if (depths.marks) {
      *word |= bit;
    }
  };
  for (int32_t y = where.y0; y < where.y1; ++y) {
    for (int32_t x = where.x0 & -lanes; x < where.x1; x += lanes) {
      uint32_t wanted = all_lanes;
      wanted &= x < where.x0 ? UINT32_MAX << (where.x0 - x) : UINT32_MAX;
      wanted &= where.x1 - x < lanes ? (uint32_t{1} << (where.x1 - x)) - 1 : UINT32_MAX;
      const uint32_t shift = static_cast<uint32_t>(x) & 31U;
      uint32_t* const word = depths.covered + depths.word(x, y);
      const size_t first = 32 * depths.word(x, y) + shift;
      if (reject) {
        wanted &= ~(*word >> shift);
      }
      if (wanted == 0) {
        continue;
      }
      batch->counts.candidates += static_cast<unsigned>(__builtin_popcount(wanted));
      const Aims aims = aims_of<kPerspective>(frame, origin, hn::Iota(d, static_cast<float>(x)),
                                              hn::Set(d, static_cast<float>(y)), low, half);
      const Verdict verdict = judge<kPerspective>(frame, aims, half);
      uint32_t met = bits_of(d, verdict.met) & wanted;
      uint32_t unclear = bits_of(d, hn::Or(verdict.unclear, aims.unclear)) & wanted;
      HWY_ALIGN uint8_t grays[64];
      if (kGray) {
        auto no_gray = hn::Lt(half, hn::Zero(d));
        const hn::Rebind<uint8_t, I32> bytes;
        const auto found = grays_of<kPerspective>(frame, *depths.gray_scale, aims, &no_gray);
        hn::Store(hn::DemoteTo(bytes, hn::BitCast(I32(), found)), bytes, grays);
        unclear |= bits_of(d, no_gray) & met;
      }
      met &= ~unclear;
      for (uint32_t left = unclear; left != 0; left &= left - 1) {
        const int32_t lane = __builtin_ctz(left);
        uint32_t key = 0;
        uint32_t down = 0;
        ++batch->counts.exact;
        const Ray ray = frame.camera.ray(x + lane, y);
        if (meets_exactly(ray, entry, batch->corner, &key, &down)) {
          const uint8_t gray =
              kGray ? gray_exactly(frame.camera, *depths.shading, ray, entry, batch->corner) : uint8_t{0};
          put(word, uint32_t{1} << (shift + static_cast<uint32_t>(lane)), first + static_cast<uint32_t>(lane),
              kGray ? mirrored_sum(entry, down) : value_of(*batch, key, down, number), gray);
          ++batch->counts.hits;
        }
      }
      if (met == 0) {
        continue;
      }
      batch->counts.hits += static_cast<unsigned>(__builtin_popcount(met));
      // Mostly all rays run the same way.
      uint32_t down_all = 0;
      uint32_t axis_bits[3];
      bool same = true;
      const auto down_of = [&axis_bits](uint32_t lane) {
        return (axis_bits[0] >> lane & 1U) | (axis_bits[1] >> lane & 1U) << 1 |
               (axis_bits[2] >> lane & 1U) << 2;
      };
      for (unsigned axis = 0; axis < 3; ++axis) {
        axis_bits[axis] = bits_of(d, hn::Lt(aims.direction[axis], hn::Zero(d))) & met;
        same = same && (axis_bits[axis] == 0 || axis_bits[axis] == met);
        down_all |= axis_bits[axis] != 0 ? 1U << axis : 0U;
      }
      if (kGray) {
        HWY_ALIGN uint32_t sums[64];
        if (same && down_all != known_down) {
          known_down = down_all;
          value = value_for(down_all);
        }
        for (uint32_t left = same ? 0 : met; left != 0; left &= left - 1) {
          const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(left));
          sums[lane] = static_cast<uint32_t>(value_for(down_of(lane)));
        }
        const U32 du;
        const hn::Rebind<uint8_t, U32> bytes;
        const hn::Rebind<uint16_t, U32> shorts;
        const auto sum = same ? hn::Set(du, static_cast<uint32_t>(value)) : hn::Load(du, sums);
        const auto is_new = hn::Eq(hn::PromoteTo(du, hn::LoadU(bytes, depths.gray + first)), hn::Zero(du));
        const auto before = hn::PromoteTo(du, hn::LoadU(shorts, depths.nearest_sum + first));
        const auto is_less = hn::Or(is_new, hn::Lt(sum, before));
        const uint32_t taken = met & bits_of(du, is_less);
        const uint8_t mask_bits[8] = {static_cast<uint8_t>(taken), static_cast<uint8_t>(taken >> 8),
                                      static_cast<uint8_t>(taken >> 16), static_cast<uint8_t>(taken >> 24)};
        hn::BlendedStore(hn::DemoteTo(shorts, hn::BitCast(I32(), sum)), hn::LoadMaskBits(shorts, mask_bits),
                         shorts, depths.nearest_sum + first);
        hn::BlendedStore(hn::Load(bytes, grays), hn::LoadMaskBits(bytes, mask_bits), bytes,
                         depths.gray + first);
        if (depths.marks) {
          *word |= met << shift;
        }
        continue;
      }
      const uint32_t before = *word >> shift & met;
      if (same && before == 0) {
        if (down_all != known_down) {
          known_down = down_all;
          value = value_for(down_all);
        }
        *word |= met << shift;
        const auto values = hn::Set(d64, value);
        for (int32_t part = 0; part < lanes; part += lanes64) {
          const uint8_t mask_bits[8] = {static_cast<uint8_t>(met >> part & ((1U << lanes64) - 1))};
          hn::BlendedStore(values, hn::LoadMaskBits(d64, mask_bits), d64,
                           depths.nearest + first + static_cast<size_t>(part));
        }
        continue;
      }
      for (; met != 0; met &= met - 1) {
        const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(met));
        put(word, uint32_t{1} << (shift + lane), first + lane, value_for(down_of(lane)), 0);
      }
    }
  }
}

template <bool kPerspective>
void draw_large(const Frame& frame, uint32_t entry, uint32_t number, const Rectangle& where, bool reject,
                const Depths& depths, Batch* batch) {
  depths.gray_scale != nullptr
      ? draw_large_in<kPerspective, true>(frame, entry, number, where, reject, depths, batch)
      : draw_large_in<kPerspective, false>(frame, entry, number, where, reject, depths, batch);
}

// Whether a box in the eye's plane may be seen through the tile: not when it lies wholly outside one of the
// tile's four sides. In doubles, by its corners: few boxes come here.
bool crosses_tile(const Frame& frame, const double (&center)[3], double side) {
  const double slack_x = static_cast<double>(frame.slack_x) + 1;
  const double slack_y = static_cast<double>(frame.slack_y) + 1;
  const double edge[4] = {frame.tile.x0 - slack_x, frame.tile.x1 + slack_x, frame.tile.y0 - slack_y,
                          frame.tile.y1 + slack_y};
  for (int s = 0; s < 4; ++s) {
    const float(&row)[4] = s < 2 ? frame.u : frame.v;
    const double sign = (s & 1) != 0 ? -1 : 1;
    const auto plane = [&](int i) {
      return sign * (static_cast<double>(row[i]) - edge[s] * static_cast<double>(frame.w[i]));
    };
    double distance = plane(3);
    double reach = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double normal = plane(axis);
      distance += normal * center[axis];
      reach += (normal < 0 ? -normal : normal) * side * 0.5;
    }
    const double rounding = static_cast<double>(s < 2 ? frame.rounding_x : frame.rounding_y);
    if (distance + reach + 2 * rounding < 0) {
      return false;
    }
  }
  return true;
}

// Rectangles of at most so many pixels a side become candidates; sorted runs gain by going into the picture
// at once.
constexpr float kMostQueued = 8;
constexpr float kMostQueuedSorted = 3;
// So many boxes are paired with their pixels before the next run is looked up.
constexpr size_t kMostBoxesWaiting = 128;

template <bool kPerspective, bool kUnit>
void enter_cube(const Frame& frame, const Run& run, const Depths& depths, Batch* batch) {
  if (batch->corner[0] == run.corner[0] && batch->corner[1] == run.corner[1] &&
      batch->corner[2] == run.corner[2]) {
    return;
  }
  bool kept = false;
  pair_boxes<kPerspective, kUnit>(frame, depths, &kept, batch);
  test_waiting<kPerspective, kUnit>(frame, depths, &kept, batch);
  test_unclear(frame, depths, &kept, batch);
  keep(depths, batch);
  // The corner of the cube and the middle of a voxel go into the constants.
  const float* const rows[3] = {frame.u, frame.v, frame.w};
  for (int i = 0; i < 3; ++i) {
    double sum = static_cast<double>(rows[i][3]);
    for (int axis = 0; axis < 3; ++axis) {
      sum += static_cast<double>(rows[i][axis]) * (run.corner[axis] + (kUnit ? 0.5 : 0.0));
    }
    batch->constant[i] = static_cast<float>(sum);
  }
  for (unsigned axis = 0; axis < 3; ++axis) {
    batch->corner[axis] = run.corner[axis];
  }
  for (unsigned down = 0; down < 8; ++down) {
    uint64_t key = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const uint32_t cube = run.corner[axis] >> 10 ^ ((down >> axis & 1U) != 0 ? 3U : 0U);
      key |= uint64_t{cube & 1U} << (30 + axis) | uint64_t{cube >> 1 & 1U} << (33 + axis);
    }
    batch->cube_value[down] = key << kEntryBits;
  }
}

// How far boxes reach from their middles' places: the tile's bound (frame.h) for the part of it in which the
// run may be seen.
struct Reach {
  float x, y;
  float slack_x, slack_y;

  Reach(const Frame& frame, const Rectangle& where)
      : x(frame.reach_x), y(frame.reach_y), slack_x(frame.slack_x), slack_y(frame.slack_y) {
    if (!frame.perspective || frame.norm_w > 1e20F) {
      return;
    }
    const auto sum = [&](const float(&row)[4], int32_t at) {
      const float place = static_cast<float>(at);
      float total = 0;
      for (int axis = 0; axis < 3; ++axis) {
        total += __builtin_fabsf(row[axis] - place * frame.w[axis]);
      }
      return total * 1.001F;
    };
    const auto greater = [](float a, float b) { return a > b ? a : b; };
    const float across = greater(sum(frame.u, where.x0), sum(frame.u, where.x1));
    const float down = greater(sum(frame.v, where.y0), sum(frame.v, where.y1));
    const float farther = 1 + frame.per_direction * frame.norm_w;
    x = 0.5F * across * farther;
    y = 0.5F * down * farther;
    slack_x = across * frame.per_direction + frame.spread_x;
    slack_y = down * frame.per_direction + frame.spread_y;
  }
};

// Some boxes of a run on the picture: the pixels low_x .. low_x + wide_x, low_y .. low_y + wide_y.
struct Projected {
  hn::Vec<U32> entry;
  hn::Vec<F32> low_x, low_y;
  hn::Vec<F32> wide_x, wide_y;
  hn::Mask<F32> seen;
  hn::Mask<F32> crossing;  // middle behind the eye's plane, but not all of it
};

template <bool kPerspective, bool kUnit>
HWY_INLINE Projected project(const Frame& frame, const Run& run, const Rectangle& clip, const Reach& reach,
                             const Batch& batch, uint32_t at) {
  const F32 d;
  const I32 di;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  const auto within = hn::Set(du, kWithin);
  const auto first_x = hn::Set(d, static_cast<float>(clip.x0));
  const auto last_x = hn::Set(d, static_cast<float>(clip.x1 - 1));
  const auto first_y = hn::Set(d, static_cast<float>(clip.y0));
  const auto last_y = hn::Set(d, static_cast<float>(clip.y1 - 1));
  const auto zero = hn::Zero(d);
  const auto one = hn::Set(d, 1.0F);
  Projected boxes;
  const size_t left = run.count - at < lanes ? run.count - at : lanes;
  const auto live = hn::FirstN(d, left);
  boxes.entry = hn::LoadU(du, run.entries + at);
  const auto entry = boxes.entry;
  hn::Vec<U32> level;
  hn::Vec<U32> entry_x;
  unpack_side(du, entry, kUnit, &level, &entry_x);
  auto x = hn::ConvertTo(d, hn::BitCast(di, entry_x));
  auto y = hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<10>(entry), within)));
  auto z = hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<20>(entry), within)));
  auto side = one;
  if (!kUnit) {
    side = hn::ConvertTo(d, hn::BitCast(di, hn::Shl(hn::Set(du, 1U), level)));
    const auto middle = hn::Mul(side, hn::Set(d, 0.5F));
    x = hn::Add(x, middle);
    y = hn::Add(y, middle);
    z = hn::Add(z, middle);
  }
  const auto apply = [&](const float(&row)[4], float last) {
    return hn::MulAdd(hn::Set(d, row[0]), x,
                      hn::MulAdd(hn::Set(d, row[1]), y, hn::MulAdd(hn::Set(d, row[2]), z, hn::Set(d, last))));
  };
  auto column = apply(frame.u, batch.constant[0]);
  auto row = apply(frame.v, batch.constant[1]);
  boxes.seen = live;
  boxes.crossing = hn::Lt(one, zero);
  auto per_depth = one;
  if (kPerspective) {
    const auto depth = apply(frame.w, batch.constant[2]);
    const auto behind = hn::Le(depth, zero);
    const auto reach_w = hn::MulAdd(hn::Set(d, frame.half_w), side, hn::Set(d, frame.rounding_w));
    boxes.crossing = hn::And(live, hn::And(behind, hn::Gt(hn::Add(depth, reach_w), zero)));
    boxes.seen = hn::AndNot(behind, boxes.seen);
    per_depth = hn::Div(one, depth);
    column = hn::Mul(column, per_depth);
    row = hn::Mul(row, per_depth);
  }
  const auto half_x = hn::MulAdd(hn::MulAdd(hn::Set(d, reach.x), side, hn::Set(d, frame.rounding_x)),
                                 per_depth, hn::Set(d, reach.slack_x));
  const auto half_y = hn::MulAdd(hn::MulAdd(hn::Set(d, reach.y), side, hn::Set(d, frame.rounding_y)),
                                 per_depth, hn::Set(d, reach.slack_y));
  boxes.low_x = hn::Max(hn::Ceil(hn::Sub(column, half_x)), first_x);
  boxes.low_y = hn::Max(hn::Ceil(hn::Sub(row, half_y)), first_y);
  boxes.wide_x = hn::Sub(hn::Min(hn::Floor(hn::Add(column, half_x)), last_x), boxes.low_x);
  boxes.wide_y = hn::Sub(hn::Min(hn::Floor(hn::Add(row, half_y)), last_y), boxes.low_y);
  boxes.seen = hn::And(boxes.seen, hn::Ge(hn::Min(boxes.wide_x, boxes.wide_y), zero));
  return boxes;
}

// Which pixels of a run's rectangle are not covered, where that has at most 32 rows of 32 pixels: looked up
// in registers (AVX-512) or in a table of its own, instead of all over the picture. The wide case reads the
// picture.
class OpenPixels {
 public:
  // `reach`: 0, 2, 4 or 8, see near().
  OpenPixels(const Depths& depths, const Rectangle& where, uint32_t reach = 0) : depths_(depths) {
    small_ = where.x1 - where.x0 <= 32 && where.y1 - where.y0 <= 32;
    if (!small_) {
      return;
    }
    x0_ = static_cast<uint32_t>(where.x0);
    y0_ = static_cast<uint32_t>(where.y0);
    const size_t first = depths.word(where.x0, where.y0);
    const uint32_t* const left = depths.covered + first;
    // The same word twice where there is no second one.
    const bool is_cut = (x0_ & 31U) + static_cast<uint32_t>(where.x1 - where.x0) > 32;
    const uint32_t* const right = is_cut ? left + depths.rows : left;
    const int32_t rows = where.y1 - where.y0;
    const uint32_t inside = UINT32_MAX >> (32 - (where.x1 - where.x0));
    uint32_t columns = 0;
    uint32_t open_rows = 0;
    for (int32_t row = 0; row < rows; ++row) {
      const uint64_t bits = uint64_t{right[row]} << 32 | left[row];
      rows_[row] = ~static_cast<uint32_t>(bits >> (x0_ & 31U)) & inside;
      columns |= rows_[row];
      open_rows |= (rows_[row] != 0 ? 1U : 0U) << row;
    }
    // Every pixel with those right of and below it, by doubling; from the last row upwards.
    for (uint32_t width = 1; width < reach; width *= 2) {
      const uint32_t* from = width == 1 ? rows_ : near_;
      for (int32_t row = 0; row < rows; ++row) {
        const int32_t below = row + static_cast<int32_t>(width);
        const uint32_t both = from[row] | (below < rows ? from[below] : 0);
        near_[row] = both | both >> width;
      }
    }
    if (columns != 0) {
      bounds_ = {where.x0 + __builtin_ctz(columns), where.y0 + __builtin_ctz(open_rows),
                 where.x0 + 32 - __builtin_clz(columns), where.y0 + 32 - __builtin_clz(open_rows)};
    }
  }

  // What is known was read before the run was begun.
  bool is_small() const { return small_; }
  // Holds all pixels of the small rectangle that are not covered; empty when there is none.
  const Rectangle& bounds() const { return bounds_; }

  // open_at(), but as it was when this was made, where that is known.
  HWY_INLINE hn::Vec<U32> at(hn::Mask<F32> mask, hn::Vec<U32> x, hn::Vec<U32> y) const {
    if (small_) {
      return look_up(rows_, x, y);
    }
    return open_at(depths_, mask, x, y);
  }
  // Of the small rectangle's pixels: in the lowest bit, whether any of the `reach` by `reach` pixels from
  // there is not covered.
  HWY_INLINE hn::Vec<U32> near(hn::Vec<U32> x, hn::Vec<U32> y) const { return look_up(near_, x, y); }

 private:
  HWY_INLINE hn::Vec<U32> look_up(const uint32_t (&rows)[32], hn::Vec<U32> x, hn::Vec<U32> y) const {
    const U32 d;
    const auto row = hn::And(hn::Sub(y, hn::Set(d, y0_)), hn::Set(d, 31U));
    const auto column = hn::And(hn::Sub(x, hn::Set(d, x0_)), hn::Set(d, 31U));
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
    const auto index = hn::IndicesFromVec(d, hn::And(row, hn::Set(d, 15U)));
    const auto low = hn::TableLookupLanes(hn::Load(d, rows), index);
    const auto high = hn::TableLookupLanes(hn::Load(d, rows + 16), index);
    const auto bits = hn::IfThenElse(hn::Gt(row, hn::Set(d, 15U)), high, low);
#else
    const auto bits = hn::GatherIndex(d, rows, hn::BitCast(I32(), row));
#endif
    return hn::Shr(bits, column);
  }

  const Depths& depths_;
  bool small_ = false;
  Rectangle bounds_{0, 0, 0, 0};
  uint32_t x0_ = 0;
  uint32_t y0_ = 0;
  alignas(64) uint32_t rows_[32];
  alignas(64) uint32_t near_[32];
};

// Whether there is one among the first `wide` + 1 of them.
HWY_INLINE hn::Mask<F32> any_open(hn::Vec<U32> open, hn::Vec<F32> wide) {
  const F32 d;
  const I32 di;
  const U32 du;
  // 2^(wide + 1) - 1
  const auto count = hn::BitCast(du, hn::ConvertTo(di, hn::Add(wide, hn::Set(d, 1.0F))));
  const auto bits = hn::Sub(hn::Shl(hn::Set(du, 1U), hn::Min(count, hn::Set(du, 25U))), hn::Set(du, 1U));
  return hn::RebindMask(d, hn::Ne(hn::And(open, bits), hn::Zero(du)));
}

// Draws the boxes of a vector that are large, or in the eye's plane: those in `mask`.
template <bool kPerspective>
HWY_NOINLINE void draw_large_of(const Frame& frame, const Run& run, uint32_t at, const Projected& boxes,
                                hn::Mask<F32> mask, bool reject_all, bool* kept, const Depths& depths,
                                Batch* batch) {
  const F32 d;
  const I32 di;
  HWY_ALIGN int32_t x0[64], x1[64], y0[64], y1[64];
  hn::Store(hn::ConvertTo(di, boxes.low_x), di, x0);
  hn::Store(hn::ConvertTo(di, hn::Add(boxes.low_x, boxes.wide_x)), di, x1);
  hn::Store(hn::ConvertTo(di, boxes.low_y), di, y0);
  hn::Store(hn::ConvertTo(di, hn::Add(boxes.low_y, boxes.wide_y)), di, y1);
  const uint32_t in_plane = kPerspective ? bits_of(d, boxes.crossing) : 0;
  for (uint32_t bits = bits_of(d, mask); bits != 0; bits &= bits - 1) {
    const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(bits));
    const uint32_t box = run.entries[at + lane];
    const uint32_t number = run.numbers == nullptr ? run.first + at + lane : run.numbers[at + lane];
    Rectangle where{x0[lane], y0[lane], x1[lane] + 1, y1[lane] + 1};
    if (kPerspective && (in_plane >> lane & 1U) != 0) {
      const double box_side = 1 << level_of(box);
      const double center[3] = {run.corner[0] + x_of(box) + box_side / 2,
                                run.corner[1] + (box >> 10 & kWithin) + box_side / 2,
                                run.corner[2] + (box >> 20 & kWithin) + box_side / 2};
      if (!crosses_tile(frame, center, box_side)) {
        continue;
      }
      ++batch->counts.crossing;
      where = {frame.tile.x0, frame.tile.y0, frame.tile.x1, frame.tile.y1};
    }
    draw_large<kPerspective>(frame, box, number, where, reject_all || (run.behind && !*kept), depths, batch);
    *kept = true;
  }
}

// Which pixels of a rectangle are not covered. Columns and rows are counted from kMargin before its first,
// and there are none to either side of it.
class OpenTable {
 public:
  static constexpr int32_t kMargin = 3;
  /// Pixels of a side, at most; behind the last there is one more row and column. Narrow tables have a word a
  /// row.
  static constexpr int32_t kMostPx = 60 - kMargin - 1;
  static constexpr int32_t kNarrowPx = 32 - kMargin - 1;

  OpenTable(const Depths& depths, const Rectangle& where) : depths_(depths), where_(where) {
    const int32_t columns = where.x1 - where.x0;
    const int32_t rows = where.y1 - where.y0;
    rows_ = columns > kNarrowPx || rows > kNarrowPx ? 64 : rows + kMargin + 1 > 16 ? 32 : 16;
    none_ = fill(0, words_, kMargin);
    if (rows_ == 64) {
      none_ = fill(kRightColumn - kMargin, words_ + kRight, 0) && none_;
    }
  }

  bool none() const { return none_; }
  // How many there are: 16, 32 or 64, and as many columns, or 32.
  int rows() const { return rows_; }
  // From column `x` of row `y` modulo kRows on, in the lowest bit and the next: whether they are not covered.
  // x: 0 .. 31, or 63 with 64 rows.
  template <int kRows>
  HWY_INLINE hn::Vec<U32> at(hn::Vec<U32> x, hn::Vec<U32> y) const {
    const U32 d;
    if (kRows < 64) {
      return hn::Shr(look_up<kRows>(words_, y), x);
    }
    const auto is_right = hn::Gt(x, hn::Set(d, kRightColumn + 1U));
    const auto shift = hn::Sub(x, hn::IfThenElseZero(is_right, hn::Set(d, uint32_t{kRightColumn})));
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
    const auto row = hn::IfThenElse(is_right, look_up<kRows>(words_ + kRight, y), look_up<kRows>(words_, y));
#else
    const auto right = hn::IfThenElseZero(is_right, hn::Set(d, uint32_t{kRight}));
    const auto index = hn::Add(hn::And(y, hn::Set(d, 63U)), right);
    const auto row = hn::GatherIndex(d, words_, hn::BitCast(I32(), index));
#endif
    // The last columns, beyond all pixels, are all taken to be the one before them.
    return hn::Shr(row, hn::Min(shift, hn::Set(d, 31U)));
  }

 private:
  // Wide tables have two words a row. The second, kRight words behind the first, begins with the last columns
  // of that, so that neighbours stand together. Vectors are stored from any row on.
  static constexpr int32_t kRightColumn = 28;
  static constexpr uint32_t kRight = 128;

  // Words of the pixels from column `first` of the rectangle on, `shift` bits up. Returns whether all are 0.
  bool fill(int32_t first, uint32_t* words, int shift) {
    const U32 d;
    const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
    const int32_t rows = where_.y1 - where_.y0;
    const int32_t columns = where_.x1 - where_.x0 - first;
    const int32_t x = where_.x0 + first;
    const uint32_t* const left = depths_.covered + depths_.word(columns > 0 ? x : where_.x0, where_.y0);
    const int left_shift = x & 31;
    // Of the strip beside it, where the rectangle reaches into it.
    const bool is_cut = columns > 0 && left_shift + columns > 32;
    const uint32_t* const right = is_cut ? left + depths_.rows : left;
    const int right_shift = is_cut && left_shift != 0 ? 32 - left_shift : 0;
    const auto beside = hn::Set(d, is_cut && left_shift != 0 ? UINT32_MAX : 0);
    const auto inside = hn::Set(d, columns >= 32  ? UINT32_MAX
                                   : columns <= 0 ? 0
                                                  : UINT32_MAX >> (32 - columns));
    auto any = hn::Zero(d);
    for (int32_t row = 0; row < kMargin; row += lanes) {
      hn::Store(any, d, words + row);
    }
    for (int32_t row = 0; row < rows; row += lanes) {
      const auto covered =
          hn::Or(hn::ShiftRightSame(load_some(left + row, rows - row), left_shift),
                 hn::ShiftLeftSame(hn::And(load_some(right + row, rows - row), beside), right_shift));
      const auto live = hn::FirstN(d, static_cast<size_t>(rows - row));
      const auto open = hn::IfThenElseZero(live, hn::AndNot(covered, inside));
      any = hn::Or(any, open);
      hn::StoreU(hn::ShiftLeftSame(open, shift), d, words + kMargin + row);
    }
    for (int32_t row = (rows + lanes - 1) / lanes * lanes + kMargin; row < rows_; row += lanes) {
      hn::StoreU(hn::Zero(d), d, words + row);
    }
    return hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
  }

  template <int kRows>
  HWY_INLINE hn::Vec<U32> look_up(const uint32_t* words, hn::Vec<U32> row) const {
    const U32 d;
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
    if (kRows == 16) {
      return hn::Vec<U32>{_mm512_permutexvar_epi32(row.raw, hn::Load(d, words).raw)};
    }
    // Highway 1.0 has no name for a look-up in two vectors. It heeds five bits of the row.
    const auto of_32 = [&](const uint32_t* part) {
      return hn::Vec<U32>{
          _mm512_permutex2var_epi32(hn::Load(d, part).raw, row.raw, hn::Load(d, part + 16).raw)};
    };
    if (kRows == 32) {
      return of_32(words);
    }
    return hn::IfThenElse(hn::TestBit(row, hn::Set(d, 32U)), of_32(words + 32), of_32(words));
#else
    return hn::GatherIndex(d, words, hn::BitCast(I32(), hn::And(row, hn::Set(d, kRows - 1U))));
#endif
  }

  const Depths& depths_;
  Rectangle where_;
  int rows_;
  bool none_;
  alignas(64) uint32_t words_[2 * kRight];
};

// Where the single voxels of a block are on the picture, about: with v a voxel's place in the cube, pixels
// from low = (x.v + x[3]) (s.v + s[3]) + low_x to low + wide_x, and the same for rows. Steps along y are for
// 1024 of v, as it stands in an entry. Orthographic: without s, and x[3] is part of low_x.
struct Linear {
  bool is_sound;  ///< false: there is no such map, the block is too near
  float x[4], y[4], s[4];
  double low_x, low_y;
  float wide_x, wide_y;
};

// A block of single voxels on the picture, about, and without divisions. With m the block's middle, e = c -
// m, g = (U - column(m) W) / W.m and q = W.e / W.m,
//
//     column(c) = column(m) + g.e / (1 + q) = column(m) + g.e (1 - q) + g.e q^2 / (1 + q)
//
// for |e| <= h on every axis. The last term is at most |g|_1 h q0^2 / (1 - q0) with q0 = |W|_1 h / W.m, and
// is added to the extent, which itself is that of frame.h with |U - column(c) W|_1 <= W.m |g|_1 + |column(c)
// - column(m)| |W|_1.
//
// No divisions: 1 / (1 - q) <= 1 + q + 4/3 q^2 for q <= 1/4.
template <bool kPerspective>
HWY_INLINE void find_linear(const Frame& frame, const uint32_t (&block)[3], uint32_t side, const Place& place,
                            Linear* linear) {
  const float h = 0.5F * static_cast<float>(side);
  float per_least = place.per_depth;  // 1 / the least depth in the block
  float factor = 0;
  float bend = 0;  // q0^2 / (1 - q0)
  float rounding_s = 0;
  linear->is_sound = false;
  if (kPerspective) {
    const float q = (frame.norm_w * h + frame.rounding_w) * place.per_depth;
    if (!(q <= 0.25F) || place.per_depth == 0) {  // norm_w may be too large for all
      return;
    }
    per_least *= (1 + q * (1 + 1.334F * q)) * 1.0001F;
    bend = frame.norm_w * h * place.per_depth * frame.norm_w * h * per_least;
    const float k = 0.5F * per_least + frame.per_direction * (1 + frame.half_w * per_least);
    const float r = k * frame.norm_w;
    if (r > 0.125F) {
      return;
    }
    factor = k * (r * 1.152F + 1.001F);
    linear->s[3] = 1;
    for (int axis = 0; axis < 3; ++axis) {
      linear->s[axis] = -frame.w[axis] * place.per_depth;
      linear->s[3] -= linear->s[axis] * (static_cast<float>(block[axis]) + h - 0.5F);
    }
    linear->s[1] *= 1.0F / 1024;
    rounding_s = frame.norm_w * place.per_depth * (1024.0F / (1 << 21));
  }
  const auto one_axis = [&](const float(&row)[4], float middle, float reach, float rounding, float slack,
                            float spread, float(&to)[4], double* low) {
    float sum = 0;
    float corner = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float across = kPerspective ? row[axis] - middle * frame.w[axis] : row[axis];
      sum += __builtin_fabsf(across);
      to[axis] = kPerspective ? across * place.per_depth : across;
      corner += to[axis] * (static_cast<float>(block[axis]) + h - 0.5F);
    }
    float half = reach + rounding + slack;
    const float steps = kPerspective ? sum * place.per_depth : sum;
    if (kPerspective) {
      const float all = steps * h;  // |g.e|
      const float curve = all * bend;
      half = (sum + (1.25F * all + curve) * frame.norm_w) * factor + rounding * per_least + spread + curve +
             all * rounding_s;
    }
    // Roundings of the map: four sums and products of at most 1024 times the steps.
    half += steps * (1024.0F / (1 << 21));
    to[1] *= 1.0F / 1024;
    to[3] = -corner;
    *low = static_cast<double>(middle) - static_cast<double>(half) -
           (kPerspective ? 0 : static_cast<double>(corner));
    return 2 * half;
  };
  linear->wide_x = one_axis(frame.u, place.column, frame.reach_x, frame.rounding_x, frame.slack_x,
                            frame.spread_x, linear->x, &linear->low_x);
  linear->wide_y = one_axis(frame.v, place.row, frame.reach_y, frame.rounding_y, frame.slack_y,
                            frame.spread_y, linear->y, &linear->low_y);
  linear->is_sound = true;
}

// The loop of pick_boxes: from `at` on until nothing is left or there is no more room. Returns where it
// stopped. With kOne no box covers more than one pixel, and the pairs wait for their test at once; else no
// more than two in a row or column. Greys need no numbers of entries.
template <bool kPerspective, bool kOne, bool kGray, int kRows>
HWY_NOINLINE uint32_t pick_some(const Run& run, const Linear& linear, const OpenTable& table, uint32_t at,
                                Batch* batch) {
  const F32 d;
  const I32 di;
  const U32 du;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  uint32_t* const entries = kOne ? batch->waiting.entry : batch->picked.entry;
  [[maybe_unused]] uint32_t* const numbers = kOne ? batch->waiting.number : batch->picked.number;
  uint32_t* const places = kOne ? batch->waiting.place : batch->picked.place;
  const size_t most = (kOne ? Pairs::kSize : Picked::kSize) - lanes;
  size_t count = kOne ? batch->waiting.count : batch->picked.count;
  // Places are found as fixed-point numbers: a sum with 3072 has 12 bits of fraction, and below them 10 of
  // the whole number. Four such sums are each within 2^-13 of what they should be. 1 - 2^-12 more, and the
  // whole number is rounded up.
  constexpr int kFraction = 12;
  constexpr float kError = 4.0F / (1 << (kFraction + 1));
  constexpr double kBase = 3073.0 - 1.0 / (1 << kFraction) - static_cast<double>(kError);
  // Counted as in the table.
  const auto base_of = [](double low, int32_t first) {
    return hn::Set(F32(), static_cast<float>(low - (first - OpenTable::kMargin) + kBase));
  };
  const auto base_x = base_of(linear.low_x, run.place.where.x0);
  const auto base_y = base_of(linear.low_y, run.place.where.y0);
  // A box reaches the next pixel where the fraction is so large, and the one behind that with 1 more.
  const auto least = [&](float wide) {
    return static_cast<int32_t>((1 - wide - 2 * kError) * (1 << kFraction)) - 1;
  };
  const int32_t least_x = least(linear.wide_x);
  const int32_t least_y = least(linear.wide_y);
  const auto within_x = hn::Set(du, kWithin);
  const auto within_y = hn::Set(du, kWithin << 10);
  const auto fraction = hn::Set(du, (1U << kFraction) - 1);
  // What lies beyond the table, at the edge of the tile, gets some place in it: a pair too many, perhaps.
  const auto last_column = hn::Set(du, kRows < 64 ? 31U : 63U);
  const auto place_rows = hn::Set(du, (kRows - 1U) << 16);
  // The table's first pixel: with a margin outside the picture, x and y modulo 2^14 each. Those pixels that
  // are open are in the picture.
  const uint32_t first_x = static_cast<uint32_t>(run.place.where.x0 - OpenTable::kMargin);
  const uint32_t first_y = static_cast<uint32_t>(run.place.where.y0 - OpenTable::kMargin);
  const auto first =
      hn::Set(du, kOne ? (first_y << 16) + first_x : (first_y << 16 | (first_x & 0xFFFFU)) & kPlacePixels);
  const uint32_t* ahead = batch->ahead;
  const uint32_t* const ahead_end = batch->ahead_end;
  for (; at < run.count && count <= most; at += lanes) {
    __builtin_prefetch(ahead);
    ahead += ahead < ahead_end ? lanes : 0;
    const auto entry = hn::LoadU(du, run.entries + at);
    const auto x = hn::ConvertTo(d, hn::BitCast(di, hn::And(entry, within_x)));
    const auto y = hn::ConvertTo(d, hn::BitCast(di, hn::And(entry, within_y)));
    const auto z = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<20>(entry)));
    const auto apply = [&](const float(&row)[4], auto last) {
      return hn::MulAdd(hn::Set(d, row[0]), x,
                        hn::MulAdd(hn::Set(d, row[1]), y, hn::MulAdd(hn::Set(d, row[2]), z, last)));
    };
    hn::Vec<U32> low_x;
    hn::Vec<U32> low_y;
    if (kPerspective) {
      const auto s = apply(linear.s, hn::Set(d, linear.s[3]));
      low_x = hn::BitCast(du, hn::MulAdd(apply(linear.x, hn::Set(d, linear.x[3])), s, base_x));
      low_y = hn::BitCast(du, hn::MulAdd(apply(linear.y, hn::Set(d, linear.y[3])), s, base_y));
    } else {
      low_x = hn::BitCast(du, apply(linear.x, base_x));
      low_y = hn::BitCast(du, apply(linear.y, base_y));
    }
    const auto at_x = hn::And(hn::ShiftRight<kFraction>(low_x), last_column);
    const auto at_y = hn::ShiftRight<kFraction>(low_y);
    auto open = table.template at<kRows>(at_x, at_y);
    // Narrow boxes lie between the pixels' centres, many of them.
    const auto part_x = hn::BitCast(di, hn::And(low_x, fraction));
    const auto part_y = hn::BitCast(di, hn::And(low_y, fraction));
    auto seen = hn::And(hn::Gt(part_x, hn::Set(di, least_x)), hn::Gt(part_y, hn::Set(di, least_y)));
    if (run.count - at < lanes) {
      seen = hn::And(seen, hn::FirstN(di, run.count - at));
    }
    auto place = hn::Add(hn::OrAnd(at_x, hn::ShiftLeft<16 - kFraction>(low_y), place_rows), first);
    hn::Mask<U32> is_open;
    if (kOne) {
      is_open = hn::TestBit(open, hn::Set(du, 1U));
    } else {
      // The row behind the last one is the first, of the margin.
      const auto below = table.template at<kRows>(at_x, hn::Add(at_y, hn::Set(du, 1U)));
      const auto has_more = hn::RebindMask(du, hn::Gt(part_y, hn::Set(di, least_y + (1 << kFraction))));
      const auto has_wider = hn::RebindMask(du, hn::Gt(part_x, hn::Set(di, least_x + (1 << kFraction))));
      const auto columns = hn::IfThenElse(has_wider, hn::Set(du, 3U), hn::Set(du, 1U));
      open = hn::ShiftLeft<kPlaceBits>(hn::And(open, columns));
      open =
          hn::Or(open, hn::IfThenElseZero(has_more, hn::ShiftLeft<kPlaceBits + 16>(hn::And(below, columns))));
      place = hn::OrAnd(open, place, hn::Set(du, kPlacePixels));
      is_open = hn::Ne(open, hn::Zero(du));
    }
    const auto chosen = hn::And(hn::RebindMask(du, seen), is_open);
    hn::StoreU(squeeze(entry, chosen), du, entries + count);
    if (!kGray) {
      hn::StoreU(squeeze(hn::Iota(du, run.first + at), chosen), du, numbers + count);
    }
    hn::StoreU(squeeze(place, chosen), du, places + count);
    count += hn::CountTrue(du, chosen);
  }
  (kOne ? batch->waiting.count : batch->picked.count) = count;
  batch->ahead = ahead;
  return at;
}

template <bool kPerspective, bool kOne, bool kGray>
HWY_INLINE uint32_t pick_in(const Run& run, const Linear& linear, const OpenTable& table, uint32_t at,
                            Batch* batch) {
  switch (table.rows()) {
    case 16:
      return pick_some<kPerspective, kOne, kGray, 16>(run, linear, table, at, batch);
    case 32:
      return pick_some<kPerspective, kOne, kGray, 32>(run, linear, table, at, batch);
    default:
      return pick_some<kPerspective, kOne, kGray, 64>(run, linear, table, at, batch);
  }
}

// A first look at a block of small single voxels behind all that is in the picture: pairs with those pixels
// that are not covered. False: not a block for this.
template <bool kPerspective>
bool pick_boxes(const Frame& frame, const Run& run, const Depths& depths, Batch* batch) {
  const Rectangle& where = run.place.where;
  constexpr int32_t kMost = OpenTable::kMostPx;
  if (where.x1 - where.x0 > kMost || where.y1 - where.y0 > kMost) {
    return false;
  }
  Linear linear;
  find_linear<kPerspective>(frame, run.block, run.side, run.place, &linear);
  if (!linear.is_sound) {
    return false;
  }
  const float widest = linear.wide_x > linear.wide_y ? linear.wide_x : linear.wide_y;
  if (!(widest < 2)) {
    return false;
  }
  bool kept = false;
  // So that coverage is known where it saves work.
  if (batch->boxes.count != 0 || batch->picked.count + batch->waiting.count >= kMostBoxesWaiting) {
    pair_boxes<kPerspective, true>(frame, depths, &kept, batch);
    test_waiting<kPerspective, true>(frame, depths, &kept, batch);
  }
  keep(depths, batch);
  const OpenTable table(depths, where);
  if (table.none()) {
    return true;
  }
  batch->counts.boxes += run.count;
  const bool is_one = widest < 1;
  const bool is_gray = depths.gray_scale != nullptr;
  for (uint32_t at = 0; at < run.count;) {
    if (is_one) {
      at = is_gray ? pick_in<kPerspective, true, true>(run, linear, table, at, batch)
                   : pick_in<kPerspective, true, false>(run, linear, table, at, batch);
    } else {
      at = is_gray ? pick_in<kPerspective, false, true>(run, linear, table, at, batch)
                   : pick_in<kPerspective, false, false>(run, linear, table, at, batch);
    }
    if (at < run.count) {
      pair_boxes<kPerspective, true>(frame, depths, &kept, batch);
      test_waiting<kPerspective, true>(frame, depths, &kept, batch);
    }
  }
  return true;
}

// Single voxels of a block that is wholly before the eye, on the picture. Per axis of it, with a = (row of
// the projection).v + `from`: pixels from a / depth + low to (a + across) / depth + high, counted from the
// block's first.
struct Scatter {
  float from_x, from_y;
  float across_x, across_y;
  float low_x, low_y, high_x, high_y;
  int32_t last_x, last_y;  // of the block's pixels
  float across, besides;

  // Places are fixed-point numbers, as in pick_some: a sum with 3072, and that constant, are each within
  // 2^-13. Constants of more than 4096 are less exact, as columns of so many are: that is in Reach.
  static constexpr int kFraction = 12;
  static constexpr double kBase = 3072;
  static constexpr int32_t kFirst = 0x45400000 >> kFraction;  // of the float 3072
  static constexpr double kError = 2.0 / (1 << (kFraction + 1));
  static constexpr int32_t kMostPx = 1000;  // of the block, so that all sums are below 4096

  Scatter(const Frame& frame, const Run& run, const Batch& batch) {
    const Rectangle& where = run.place.where;
    const Reach reach(frame, where);
    const double half_x = static_cast<double>(reach.x) + static_cast<double>(frame.rounding_x);
    const double half_y = static_cast<double>(reach.y) + static_cast<double>(frame.rounding_y);
    from_x = static_cast<float>(static_cast<double>(batch.constant[0]) - half_x);
    from_y = static_cast<float>(static_cast<double>(batch.constant[1]) - half_y);
    across_x = static_cast<float>(2 * half_x);
    across_y = static_cast<float>(2 * half_y);
    // Rounded up and down to whole numbers by cutting.
    const auto low = [](float slack, int32_t first) {
      return static_cast<float>(kBase + 1 - 1.0 / (1 << kFraction) - kError - static_cast<double>(slack) -
                                first);
    };
    const auto high = [](float slack, int32_t first) {
      return static_cast<float>(kBase + kError + static_cast<double>(slack) - first);
    };
    low_x = low(reach.slack_x, where.x0);
    low_y = low(reach.slack_y, where.y0);
    high_x = high(reach.slack_x, where.x0);
    high_y = high(reach.slack_y, where.y0);
    last_x = where.x1 - where.x0 - 1;
    last_y = where.y1 - where.y0 - 1;
    const float slack = reach.slack_x > reach.slack_y ? reach.slack_x : reach.slack_y;
    across = across_x > across_y ? across_x : across_y;
    besides = 2 * slack + static_cast<float>(4 * kError) + 0.001F;
  }

  // What a box measures on the picture, at most, at that depth and beyond.
  float widest(float per_depth) const { return across * per_depth + besides; }
};

// From box `at` on, until there is no more room. Returns where it stopped. With kMany boxes may cover several
// pixels.
template <bool kPerspective, bool kMany, bool kGray>
HWY_NOINLINE uint32_t scatter_some(const Frame& frame, const Run& run, const Scatter& scatter, uint32_t at,
                                   Batch* batch) {
  const F32 d;
  const I32 di;
  const U32 du;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  Pairs& waiting = batch->waiting;
  Boxes& queue = batch->boxes;
  const auto within = hn::Set(du, kWithin);
  const auto zero = hn::Zero(di);
  const auto last_x = hn::Set(di, scatter.last_x);
  const auto last_y = hn::Set(di, scatter.last_y);
  const auto first = hn::Set(
      du, (static_cast<uint32_t>(run.place.where.y0) << 16) + static_cast<uint32_t>(run.place.where.x0));
  for (; at < run.count && waiting.count + lanes <= Pairs::kSize && queue.count + lanes <= Boxes::kSize;
       at += lanes) {
    const auto entry = hn::LoadU(du, run.entries + at);
    const auto x = hn::ConvertTo(d, hn::BitCast(di, hn::And(entry, within)));
    const auto y = hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<10>(entry), within)));
    const auto z = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<20>(entry)));
    const auto apply = [&](const float(&row)[4], float last) {
      return hn::MulAdd(
          hn::Set(d, row[0]), x,
          hn::MulAdd(hn::Set(d, row[1]), y, hn::MulAdd(hn::Set(d, row[2]), z, hn::Set(d, last))));
    };
    auto per_depth = hn::Set(d, 1.0F);
    if (kPerspective) {
      per_depth = hn::Div(per_depth, apply(frame.w, batch->constant[2]));
    }
    const auto from_x = apply(frame.u, scatter.from_x);
    const auto from_y = apply(frame.v, scatter.from_y);
    // What lies beside the block's pixels comes out as some number on that side.
    const auto whole = [&](hn::Vec<F32> a, float last) {
      const auto sum = hn::BitCast(di, hn::MulAdd(a, per_depth, hn::Set(d, last)));
      return hn::Sub(hn::ShiftRight<Scatter::kFraction>(sum), hn::Set(di, Scatter::kFirst));
    };
    auto low_x = whole(from_x, scatter.low_x);
    auto low_y = whole(from_y, scatter.low_y);
    auto high_x = whole(hn::Add(from_x, hn::Set(d, scatter.across_x)), scatter.high_x);
    auto high_y = whole(hn::Add(from_y, hn::Set(d, scatter.across_y)), scatter.high_y);
    low_x = hn::Max(low_x, zero);
    low_y = hn::Max(low_y, zero);
    high_x = hn::Min(high_x, last_x);
    high_y = hn::Min(high_y, last_y);
    const auto place = hn::Add(hn::BitCast(du, hn::Or(hn::ShiftLeft<16>(low_y), low_x)), first);
    const auto wide_x = hn::Sub(high_x, low_x);
    const auto wide_y = hn::Sub(high_y, low_y);
    const auto live = hn::FirstN(di, run.count - at < lanes ? run.count - at : lanes);
    const auto is_one = hn::And(live, hn::Eq(hn::Or(wide_x, wide_y), zero));
    const auto number = hn::Iota(du, run.first + at);
    append<kGray>(hn::RebindMask(d, is_one), entry, number, place, &waiting);
    if (kMany) {
      const auto are_seen = hn::Gt(hn::Min(wide_x, wide_y), hn::Set(di, -1));
      const auto are_many = hn::And(live, hn::And(are_seen, hn::Gt(hn::Max(wide_x, wide_y), zero)));
      const auto chosen = hn::RebindMask(du, are_many);
      const auto wide = hn::BitCast(du, hn::Or(hn::ShiftLeft<16>(wide_y), wide_x));
      hn::StoreU(squeeze(entry, chosen), du, queue.entry + queue.count);
      hn::StoreU(squeeze(number, chosen), du, queue.number + queue.count);
      hn::StoreU(squeeze(place, chosen), du, queue.place + queue.count);
      hn::StoreU(squeeze(wide, chosen), du, queue.wide + queue.count);
      queue.count += hn::CountTrue(du, chosen);
    }
  }
  return at;
}

// A block of single voxels in no order that does not reach the eye's plane. False: it is not such a block.
template <bool kPerspective>
bool scatter_boxes(const Frame& frame, const Run& run, const Depths& depths, Batch* batch) {
  const Rectangle& where = run.place.where;
  if (run.place.per_depth == 0 || where.x1 - where.x0 > Scatter::kMostPx ||
      where.y1 - where.y0 > Scatter::kMostPx) {
    return false;
  }
  // The least depth in the block.
  float per_least = 1;
  if (kPerspective) {
    const float q = (frame.half_w * static_cast<float>(run.side) + frame.rounding_w) * run.place.per_depth;
    if (!(q < 0.9F)) {
      return false;
    }
    per_least = run.place.per_depth / (1 - q);
  }
  const Scatter scatter(frame, run, *batch);
  const float widest = scatter.widest(per_least);
  if (widest >= kMostQueued - 1) {
    return false;
  }
  const bool are_many = widest >= 1;
  const bool is_gray = depths.gray_scale != nullptr;
  batch->counts.boxes += run.count;
  batch->all_behind = batch->all_behind && !are_many;
  bool kept = false;
  for (uint32_t at = 0; at < run.count;) {
    if (are_many) {
      at = is_gray ? scatter_some<kPerspective, true, true>(frame, run, scatter, at, batch)
                   : scatter_some<kPerspective, true, false>(frame, run, scatter, at, batch);
    } else {
      at = is_gray ? scatter_some<kPerspective, false, true>(frame, run, scatter, at, batch)
                   : scatter_some<kPerspective, false, false>(frame, run, scatter, at, batch);
    }
    if (at < run.count) {
      if (batch->boxes.count + hn::Lanes(F32()) > Boxes::kSize) {
        pair_boxes<kPerspective, true>(frame, depths, &kept, batch);
        batch->all_behind = false;
      } else {
        test_waiting<kPerspective, true>(frame, depths, &kept, batch);
      }
    }
  }
  return true;
}

// A run in no order. Boxes whose pixels may all be covered go first; those left wait in the batch until there
// are enough to fill vectors.
//
// Boxes that wait are of whole runs, and all that goes into the picture before they are paired is of runs
// before theirs, so that pixels covered by then need no look. Where a run is cut in between, `all_behind`
// says so.
template <bool kPerspective, bool kUnit>
void draw_run_of(const Frame& frame, const Run& run, const Depths& depths, Batch* batch) {
  const F32 d;
  const U32 du;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  enter_cube<kPerspective, kUnit>(frame, run, depths, batch);
  if (kUnit && run.behind && pick_boxes<kPerspective>(frame, run, depths, batch)) {
    return;
  }
  if (kUnit && !run.behind && scatter_boxes<kPerspective>(frame, run, depths, batch)) {
    return;
  }
  Boxes& queue = batch->boxes;
  bool kept = false;
  if (run.behind) {
    // So that coverage is known where it saves work.
    if (queue.count >= kMostBoxesWaiting || batch->picked.count != 0) {
      pair_boxes<kPerspective, kUnit>(frame, depths, &kept, batch);
      test_waiting<kPerspective, kUnit>(frame, depths, &kept, batch);
    }
    keep(depths, batch);
    kept = false;
  }
  batch->counts.boxes += run.count;
  // Boxes of more than `near` pixels a side are not looked up.
  const uint32_t near = run.voxel_px < 1.6F ? 2 : run.voxel_px < 3.5F ? 4 : 8;
  const OpenPixels open_pixels(depths, run.behind ? run.place.where : Rectangle{0, 0, 64, 0}, near);
  const Rectangle clip = open_pixels.is_small() ? open_pixels.bounds() : run.place.where;
  if (clip.x0 >= clip.x1) {
    return;
  }
  const Reach reach(frame, clip);
  const auto most = hn::Set(d, kMostQueued - 1);
  bool cut = false;
  for (uint32_t at = 0; at < run.count; at += lanes) {
    const Projected boxes = project<kPerspective, kUnit>(frame, run, clip, reach, *batch, at);
    auto seen = boxes.seen;
    const auto widest = hn::Max(boxes.wide_x, boxes.wide_y);
    auto large = hn::And(seen, hn::Gt(widest, most));
    if (kPerspective) {
      large = hn::Or(large, boxes.crossing);
    }
    if (!hn::AllFalse(d, large)) {
      pair_boxes<kPerspective, kUnit>(frame, depths, &kept, batch);
      draw_large_of<kPerspective>(frame, run, at, boxes, large, false, &kept, depths, batch);
      cut = true;
      seen = hn::AndNot(large, seen);
    }
    const auto x = small_number(boxes.low_x);
    const auto y = small_number(boxes.low_y);
    if (run.behind && open_pixels.is_small()) {
      const auto is_open = hn::RebindMask(d, hn::TestBit(open_pixels.near(x, y), hn::Set(du, 1U)));
      seen = hn::And(seen, hn::Or(is_open, hn::Ge(widest, hn::Set(d, static_cast<float>(near)))));
    }
    const auto place = hn::Or(hn::ShiftLeft<16>(y), x);
    if (kUnit && !run.behind) {
      // What covers one pixel at most is a candidate as it is.
      Pairs& waiting = batch->waiting;
      append(hn::And(seen, hn::Lt(widest, hn::Set(d, 1.0F))), boxes.entry, hn::Iota(du, run.first + at),
             place, &waiting);
      if (waiting.count + lanes > Pairs::kSize) {
        test_waiting<kPerspective, kUnit>(frame, depths, &kept, batch);
      }
      seen = hn::And(seen, hn::Ge(widest, hn::Set(d, 1.0F)));
      if (hn::AllFalse(d, seen)) {
        continue;
      }
    }
    // No branch on whether any is left: that would be guessed wrong in every third vector.
    const auto chosen = hn::RebindMask(du, seen);
    const auto wide_x = small_number(boxes.wide_x);
    const auto wide_y = small_number(boxes.wide_y);
    hn::StoreU(squeeze(boxes.entry, chosen), du, queue.entry + queue.count);
    hn::StoreU(squeeze(hn::Iota(du, run.first + at), chosen), du, queue.number + queue.count);
    hn::StoreU(squeeze(place, chosen), du, queue.place + queue.count);
    hn::StoreU(squeeze(hn::Or(hn::ShiftLeft<16>(wide_y), wide_x), chosen), du, queue.wide + queue.count);
    queue.count += hn::CountTrue(du, chosen);
    batch->all_behind = batch->all_behind && run.behind && !cut;
    if (queue.count + lanes > Boxes::kSize) {
      pair_boxes<kPerspective, kUnit>(frame, depths, &kept, batch);
      cut = true;
    }
  }
}

// A run in order: what goes into the picture lies in front of all that follows.
template <bool kPerspective, bool kUnit>
void draw_sorted_of(const Frame& frame, const Run& run, const Depths& depths, Batch* batch) {
  const F32 d;
  const I32 di;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  enter_cube<kPerspective, kUnit>(frame, run, depths, batch);
  bool kept = false;
  pair_boxes<kPerspective, kUnit>(frame, depths, &kept, batch);
  if (batch->waiting.count >= 128) {
    test_waiting<kPerspective, kUnit>(frame, depths, &kept, batch);
  }
  keep(depths, batch);
  batch->counts.boxes += run.count;
  const OpenPixels open_pixels(depths, run.place.where);
  const Rectangle clip = open_pixels.is_small() ? open_pixels.bounds() : run.place.where;
  const Reach reach(frame, clip);
  const auto most = hn::Set(d, kMostQueuedSorted - 1);
  Pairs& waiting = batch->waiting;
  for (uint32_t at = 0; at < run.count; at += static_cast<uint32_t>(lanes)) {
    const Projected boxes = project<kPerspective, kUnit>(frame, run, clip, reach, *batch, at);
    auto large = hn::And(boxes.seen, hn::Gt(hn::Max(boxes.wide_x, boxes.wide_y), most));
    if (kPerspective) {
      large = hn::Or(large, boxes.crossing);
    }
    if (!hn::AllFalse(d, large)) {  // one after the other
      draw_large_of<kPerspective>(frame, run, at, boxes, hn::Or(large, boxes.seen), true, &kept, depths,
                                  batch);
      continue;
    }
    if (hn::AllFalse(d, boxes.seen)) {
      continue;
    }
    const auto number = hn::LoadU(du, run.numbers + at);
    const auto x = hn::BitCast(du, hn::ConvertTo(di, boxes.low_x));
    const auto y = hn::BitCast(du, hn::ConvertTo(di, boxes.low_y));
    const auto first = hn::Or(hn::ShiftLeft<16>(y), x);
    // Nothing may go into the picture between the boxes of a vector: a farther one may have been tested
    // before a nearer one has been looked up.
    constexpr size_t kMostSortedPairs = static_cast<size_t>(kMostQueuedSorted * kMostQueuedSorted);
    if (waiting.count + (kMostSortedPairs + 1) * lanes > Pairs::kSize) {
      test_waiting<kPerspective, kUnit>(frame, depths, &kept, batch);
    }
    auto in_row = boxes.seen;
    for (uint32_t down = 0; !hn::AllFalse(d, in_row); ++down) {
      const auto open = open_pixels.at(in_row, x, hn::Add(y, hn::Set(du, down)));
      auto in_column = hn::And(in_row, any_open(open, boxes.wide_x));
      for (uint32_t across = 0; !hn::AllFalse(d, in_column); ++across) {
        const auto chosen =
            hn::And(in_column, hn::RebindMask(d, hn::TestBit(open, hn::Set(du, 1U << across))));
        append(chosen, boxes.entry, number, hn::Add(first, hn::Set(du, down << 16 | across)), &waiting);
        in_column = hn::And(in_column, hn::Gt(boxes.wide_x, hn::Set(d, static_cast<float>(across))));
      }
      in_row = hn::And(in_row, hn::Gt(boxes.wide_y, hn::Set(d, static_cast<float>(down))));
    }
  }
}

// Which boxes of the run may be seen at pixels that are not covered: their entries and numbers, in the order
// of the run.
template <bool kPerspective, bool kUnit>
uint32_t cull_run_of(const Frame& frame, const Run& run, const Depths& depths, Batch* batch,
                     uint32_t* entries, uint32_t* numbers) {
  const F32 d;
  const I32 di;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  enter_cube<kPerspective, kUnit>(frame, run, depths, batch);
  bool kept = false;
  pair_boxes<kPerspective, kUnit>(frame, depths, &kept, batch);
  test_waiting<kPerspective, kUnit>(frame, depths, &kept, batch);
  keep(depths, batch);
  batch->counts.boxes += run.count;
  const OpenPixels open_pixels(depths, run.place.where);
  const Rectangle clip = open_pixels.is_small() ? open_pixels.bounds() : run.place.where;
  const Reach reach(frame, clip);
  uint32_t count = 0;
  for (uint32_t at = 0; at < run.count; at += static_cast<uint32_t>(lanes)) {
    const Projected boxes = project<kPerspective, kUnit>(frame, run, clip, reach, *batch, at);
    // Wider or taller ones are not looked at so closely.
    const auto most = hn::Set(d, 24.0F);
    auto chosen = hn::And(boxes.seen, hn::Or(hn::Gt(boxes.wide_x, most), hn::Gt(boxes.wide_y, most)));
    if (kPerspective) {
      chosen = hn::Or(chosen, boxes.crossing);
    }
    auto in_row = hn::AndNot(chosen, boxes.seen);
    const auto int_x = hn::BitCast(du, hn::ConvertTo(di, boxes.low_x));
    const auto int_y = hn::BitCast(du, hn::ConvertTo(di, boxes.low_y));
    for (uint32_t down = 0; !hn::AllFalse(d, in_row); ++down) {
      const auto open = open_pixels.at(in_row, int_x, hn::Add(int_y, hn::Set(du, down)));
      const auto found = hn::And(in_row, any_open(open, boxes.wide_x));
      chosen = hn::Or(chosen, found);
      in_row = hn::AndNot(found, hn::And(in_row, hn::Gt(boxes.wide_y, hn::Set(d, static_cast<float>(down)))));
    }
    const auto chosen_u = hn::RebindMask(du, chosen);
    hn::StoreU(squeeze(boxes.entry, chosen_u), du, entries + count);
    hn::StoreU(squeeze(hn::Iota(du, run.first + at), chosen_u), du, numbers + count);
    count += static_cast<uint32_t>(hn::CountTrue(du, chosen_u));
  }
  return count;
}

uint32_t cull_run(const Frame& frame, const Run& run, const Depths& depths, Batch* batch, uint32_t* entries,
                  uint32_t* numbers) {
  if (frame.perspective) {
    return run.unit ? cull_run_of<true, true>(frame, run, depths, batch, entries, numbers)
                    : cull_run_of<true, false>(frame, run, depths, batch, entries, numbers);
  }
  return run.unit ? cull_run_of<false, true>(frame, run, depths, batch, entries, numbers)
                  : cull_run_of<false, false>(frame, run, depths, batch, entries, numbers);
}

template <bool kPerspective, bool kUnit>
void draw_any(const Frame& frame, const Run& run, const Depths& depths, Batch* batch) {
  run.sorted ? draw_sorted_of<kPerspective, kUnit>(frame, run, depths, batch)
             : draw_run_of<kPerspective, kUnit>(frame, run, depths, batch);
}

void draw_run(const Frame& frame, const Run& run, const Depths& depths, Batch* batch) {
  if (frame.perspective) {
    run.unit ? draw_any<true, true>(frame, run, depths, batch)
             : draw_any<true, false>(frame, run, depths, batch);
  } else {
    run.unit ? draw_any<false, true>(frame, run, depths, batch)
             : draw_any<false, false>(frame, run, depths, batch);
  }
}

void finish(const Frame& frame, const Depths& depths, Batch* batch) {
  bool kept = false;
  if (frame.perspective) {
    pair_boxes<true, false>(frame, depths, &kept, batch);
    test_waiting<true, false>(frame, depths, &kept, batch);
  } else {
    pair_boxes<false, false>(frame, depths, &kept, batch);
    test_waiting<false, false>(frame, depths, &kept, batch);
  }
  test_unclear(frame, depths, &kept, batch);
  keep(depths, batch);
}

int find_children(const Frame& frame, const Block& block, unsigned mask, uint32_t first_child,
                  unsigned nearest, Block* children) {
  const hn::CappedTag<float, 8> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<uint8_t, decltype(d)> bytes;
  const size_t lanes = hn::Lanes(d);
  const uint32_t level = uint32_t{block.level} - 1;
  const uint32_t int_side = uint32_t{1} << level;
  const float side = static_cast<float>(int_side);
  // How many octants of the mask come before each: a byte for each of eight, by sums of bytes.
  constexpr uint64_t kOnes = 0x0101010101010101U;
  const uint64_t set = ((mask * kOnes & 0x8040201008040201U) + 0x7F7F7F7F7F7F7F7FU) >> 7 & kOnes;
  const uint64_t before = set * kOnes << 8;
  uint8_t numbers[8];
  __builtin_memcpy(numbers, &before, sizeof(before));
  struct alignas(16) Part {
    uint32_t words[4];
  };
  Part parts[3][8];
  uint32_t seen = 0;
  for (size_t at = 0; at < 8; at += lanes) {
    const auto octant = hn::Iota(du, static_cast<uint32_t>(at));
    const auto corner = [&](uint32_t low, uint32_t bit) {
      const auto is_high = hn::TestBit(octant, hn::Set(du, bit));
      return hn::Add(hn::Set(du, low), hn::IfThenElseZero(is_high, hn::Set(du, int_side)));
    };
    const auto corner_x = corner(block.corner[0], 1);
    const auto corner_y = corner(block.corner[1], 2);
    const auto corner_z = corner(block.corner[2], 4);
    const auto middle = hn::Set(d, side * 0.5F);
    const auto x = hn::Add(hn::ConvertTo(d, hn::BitCast(di, corner_x)), middle);
    const auto y = hn::Add(hn::ConvertTo(d, hn::BitCast(di, corner_y)), middle);
    const auto z = hn::Add(hn::ConvertTo(d, hn::BitCast(di, corner_z)), middle);
    const auto apply = [&](const float(&row)[4]) {
      return hn::MulAdd(
          hn::Set(d, row[0]), x,
          hn::MulAdd(hn::Set(d, row[1]), y, hn::MulAdd(hn::Set(d, row[2]), z, hn::Set(d, row[3]))));
    };
    auto column = apply(frame.u);
    auto row = apply(frame.v);
    const auto zero = hn::Zero(d);
    auto per_depth = hn::Set(d, 1.0F);
    auto crossing = hn::Lt(per_depth, zero);
    auto hidden = crossing;
    if (frame.perspective) {
      const auto depth = apply(frame.w);
      const float reach = frame.half_w * side + frame.rounding_w;
      crossing = hn::Le(depth, hn::Set(d, reach));
      hidden = hn::Le(depth, hn::Set(d, -reach));
      per_depth = hn::Div(per_depth, hn::IfThenElse(crossing, per_depth, depth));
      column = hn::Mul(column, per_depth);
      row = hn::Mul(row, per_depth);
    }
    const auto half = frame.perspective ? extent<true>(d, frame, hn::Set(d, side), column, row, per_depth)
                                        : extent<false>(d, frame, hn::Set(d, side), column, row, per_depth);
    const auto half_x = half.x;
    const auto half_y = half.y;
    const auto first_x = hn::Set(d, static_cast<float>(frame.tile.x0));
    const auto end_x = hn::Set(d, static_cast<float>(frame.tile.x1));
    const auto first_y = hn::Set(d, static_cast<float>(frame.tile.y0));
    const auto end_y = hn::Set(d, static_cast<float>(frame.tile.y1));
    // A block in the eye's plane is taken to be everywhere in the tile.
    const auto clamped = [&](auto value, auto low, auto high) { return hn::Max(low, hn::Min(value, high)); };
    const auto one = hn::Set(d, 1.0F);
    auto x0 = clamped(hn::Ceil(hn::Sub(column, half_x)), first_x, end_x);
    auto x1 = clamped(hn::Add(hn::Floor(hn::Add(column, half_x)), one), first_x, end_x);
    auto y0 = clamped(hn::Ceil(hn::Sub(row, half_y)), first_y, end_y);
    auto y1 = clamped(hn::Add(hn::Floor(hn::Add(row, half_y)), one), first_y, end_y);
    x0 = hn::IfThenElse(crossing, first_x, x0);
    y0 = hn::IfThenElse(crossing, first_y, y0);
    x1 = hn::IfThenElse(hidden, first_x, hn::IfThenElse(crossing, end_x, x1));
    y1 = hn::IfThenElse(crossing, end_y, y1);
    seen |= bits_of(d, hn::And(hn::Lt(x0, x1), hn::Lt(y0, y1))) << at;
    const auto whole = [&](auto value) { return hn::BitCast(du, hn::ConvertTo(di, value)); };
    const auto raw = [&](auto value) { return hn::BitCast(du, value); };
    hn::StoreInterleaved4(whole(x0), whole(y0), whole(x1), whole(y1), du, parts[0][at].words);
    hn::StoreInterleaved4(raw(column), raw(row), raw(hn::IfThenElse(crossing, zero, per_depth)), raw(zero),
                          du, parts[1][at].words);
    const auto node = hn::Add(hn::Set(du, first_child), hn::PromoteTo(du, hn::LoadU(bytes, numbers + at)));
    hn::StoreInterleaved4(node, hn::Or(hn::ShiftLeft<16>(corner_y), corner_x),
                          hn::Or(hn::Set(du, level << 16), corner_z), hn::Zero(du), du, parts[2][at].words);
  }
  seen &= mask;
  int count = 0;
  for (unsigned turn = 8; turn-- > 0;) {
    const unsigned octant = turn ^ nearest;
    for (unsigned part = 0; part < 3; ++part) {
      __builtin_memcpy(reinterpret_cast<Part*>(children + count) + part, &parts[part][octant], sizeof(Part));
    }
    count += static_cast<int>(seen >> octant & 1U);
  }
  return count;
}

// Every third bit to bits 0..9.
inline hn::Vec<U32> gathered10(hn::Vec<U32> v) {
  const U32 d;
  v = hn::And(v, hn::Set(d, 0x09249249U));
  v = hn::And(hn::Or(v, hn::ShiftRight<2>(v)), hn::Set(d, 0x030C30C3U));
  v = hn::And(hn::Or(v, hn::ShiftRight<4>(v)), hn::Set(d, 0x0300F00FU));
  v = hn::And(hn::Or(v, hn::ShiftRight<8>(v)), hn::Set(d, 0x030000FFU));
  return hn::And(hn::Or(v, hn::ShiftRight<16>(v)), hn::Set(d, 0x3FFU));
}

// The mirrored corners that keys stand for.
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

// The set bits of a word, each plus `first`, to `to`, which has room for 48. Returns how many.
HWY_INLINE uint32_t store_bits(uint32_t word, uint32_t first, uint32_t* to) {
  const U32 d;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  uint32_t count = 0;
  if (lanes < 8) {
    for (uint32_t bits = word; bits != 0; bits &= bits - 1) {
      to[count++] = first + static_cast<uint32_t>(__builtin_ctz(bits));
    }
    return count;
  }
  // No branch for each bit: how many there are cannot be guessed.
  uint8_t bytes[8] = {};
  __builtin_memcpy(bytes, &word, sizeof(word));
  for (uint32_t part = 0; part < 32; part += lanes) {
    const auto mask = hn::LoadMaskBits(d, bytes + part / 8);
    hn::StoreU(squeeze(hn::Iota(d, first + part), mask), d, to + count);
    count += static_cast<uint32_t>(hn::CountTrue(d, mask));
  }
  return count;
}

int32_t find_covered(const Depths& depths, int32_t left, int32_t row, int32_t end, Pixels* pixels) {
  const U32 d;
  const I32 di;
  const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
  const uint32_t before = pixels->count;
  uint32_t count = before;
  const uint32_t first_word = static_cast<uint32_t>(depths.word(left, depths.first_row));
  while (row < end && count <= kMostPixels - 32) {
    const uint32_t word = static_cast<uint32_t>(depths.word(left, row));
    const int32_t rows = end - row < lanes ? end - row : lanes;
    const auto some = load_some(depths.covered + word, rows);
    int32_t next = row + rows;
    for (uint32_t bits = bits_of(d, hn::Ne(some, hn::Zero(d))); bits != 0; bits &= bits - 1) {
      const uint32_t r = static_cast<uint32_t>(__builtin_ctz(bits));
      if (count > kMostPixels - 32) {
        next = row + static_cast<int32_t>(r);
        break;
      }
      count += store_bits(depths.covered[word + r], 32 * (word + r), pixels->at + count);
    }
    row = next;
  }
  for (uint32_t i = before; i < count; i += static_cast<uint32_t>(lanes)) {
    const auto at = hn::LoadU(d, pixels->at + i);
    const auto x = hn::Add(hn::And(at, hn::Set(d, 31U)), hn::Set(d, static_cast<uint32_t>(left)));
    const auto y =
        hn::Sub(hn::ShiftRight<5>(at), hn::Set(d, first_word - static_cast<uint32_t>(depths.first_row)));
    hn::StoreU(hn::BitCast(di, x), di, pixels->x + i);
    hn::StoreU(hn::BitCast(di, y), di, pixels->y + i);
  }
  pixels->count = count;
  return row;
}

void unpack(const Depths& depths, Pixels* pixels) {
  const U64 d;
  const HalfU32 d32;
  const uint32_t count = pixels->count;
  for (uint32_t i = count; i < count + hn::Lanes(U32()); ++i) {
    pixels->at[i] = pixels->at[0];
    pixels->x[i] = 0;
    pixels->y[i] = 0;
  }
  for (uint32_t i = 0; i < count + hn::Lanes(U32()); ++i) {
    pixels->value[i] = depths.nearest[pixels->at[i]];
  }
  for (uint32_t at = 0; at < count; at += static_cast<uint32_t>(hn::Lanes(d))) {
    const auto value = hn::LoadU(d, pixels->value + at);
    hn::StoreU(hn::TruncateTo(d32, hn::And(value, hn::Set(d, (uint64_t{1} << kEntryBits) - 1))), d32,
               pixels->number + at);
    const auto key = hn::And(hn::ShiftRight<kEntryBits>(value), hn::Set(d, 0x3FFFFFFFU));
    hn::StoreU(hn::TruncateTo(d32, key), d32, pixels->key + at);
    hn::StoreU(hn::TruncateTo(d32, hn::ShiftRight<kEntryBits + 30>(value)), d32, pixels->cube + at);
  }
}

// Where rays enter their boxes: over the axes, the latest t of the nearer plane, ties to the lowest axis;
// compared as fractions, num_a |d_b| > num_b |d_a|, in integers below 2^44. The boxes are ones that the rays
// meet.
struct Entries {
  hn::Vec<F64> axis;       // -1: the ray starts inside
  hn::Vec<F64> numerator;  // t = numerator / (256 * speed)
  hn::Vec<F64> speed;      // |direction[axis]|
  hn::Vec<F64> direction[3];
};

template <bool kPerspective>
HWY_INLINE Entries entries_of(const Frame& frame, const Pixels& pixels, const Corners& corners, size_t at) {
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
  // Mirrored in a world of 4096 voxels.
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
    // A plane at or behind the origin is not entered through.
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
  // Of a solid block it is a voxel that is entered. Where the ray passes from one voxel's slab to the next on
  // a lower axis just as it enters the block, it enters the voxel through that face too, and the lowest axis
  // counts.
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

// Greys of t = numerator / (256 * speed): the core's sum, with its roundings (src/shading.cpp). The ratio of
// integers below 2^32 is exact after Floor: one that is no integer lies farther from the next than a double's
// last bit. The product has up to 55 bits and is taken in two parts. The last quotient has a half added
// above, and so is no integer, by more than the inverse divisor's error.
HWY_INLINE hn::Vec<HalfI32> grays_in_doubles(const GrayScale& scale, hn::Vec<F64> numerator,
                                             hn::Vec<F64> speed) {
  const F64 d;
  const HalfI32 d32;
  const auto zero = hn::Zero(d);
  const auto dividend = hn::Set(d, scale.dividend);
  const auto near_plane = hn::Set(d, scale.near_q8);
  const auto most_fall = hn::Set(d, static_cast<double>(255 - kFarBrightness));
  const auto ratio = hn::Floor(hn::Div(dividend, speed));
  const auto high = hn::Floor(hn::Mul(ratio, hn::Set(d, 1.0 / 65536)));
  const auto low = hn::NegMulAdd(high, hn::Set(d, 65536), ratio);
  // numerator * ratio = a * 2^16 + b, divided by 2^(shift + 8) and rounded down.
  const auto a = hn::Mul(numerator, high);
  const auto b = hn::Mul(numerator, low);
  const auto b_high = hn::Floor(hn::Mul(b, hn::Set(d, 1.0 / 65536)));
  const auto whole = hn::Add(a, b_high);  // of 2^16, below 2^40
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

HWY_INLINE void store_bytes(hn::Vec<HalfI32> values, uint8_t* to) {
  const HalfI32 d;
  HWY_ALIGN int32_t stored[64];
  hn::Store(values, d, stored);
  for (size_t i = 0; i < hn::Lanes(d); ++i) {
    to[i] = static_cast<uint8_t>(stored[i]);
  }
}

template <bool kPerspective>
HWY_NOINLINE void find_grays_exactly(const Frame& frame, const Pixels& pixels, const GrayScale& scale,
                                     uint8_t* gray) {
  Corners corners;
  find_corners(pixels, &corners);
  for (size_t at = 0; at < pixels.count; at += hn::Lanes(F64())) {
    const Entries found = entries_of<kPerspective>(frame, pixels, corners, at);
    store_bytes(grays_in_doubles(scale, found.numerator, found.speed), gray + at);
  }
}

// Where rays enter their boxes, in floats: distances are integers below 2^24, directions as in judge(), and
// products are compared where they differ by more than their roundings. What is not clear is done again.
template <bool kPerspective>
void find_grays_of(const Frame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  const F32 d;
  const I32 di;
  const U32 du;
  const F64 d64;
  const size_t lanes = hn::Lanes(d);
  const size_t lanes64 = hn::Lanes(d64);
  const hn::Rebind<float, F64> half_d;
  const auto zero = hn::Zero(d);
  Corners corners;
  find_corners(pixels, &corners);
  uint32_t unclear_at[kMostPixels];
  uint32_t unclear_count = 0;
  for (size_t at = 0; at < pixels.count; at += lanes) {
    const auto x = hn::ConvertTo(d, hn::LoadU(di, pixels.x + at));
    const auto y = hn::ConvertTo(d, hn::LoadU(di, pixels.y + at));
    auto side = hn::Set(d, 1.0F);
    auto unclear = hn::Lt(zero, zero);
    if (pixels.any_levels) {
      const auto level = hn::BitCast(du, hn::LoadU(di, pixels.level + at));
      side = hn::ConvertTo(d, hn::BitCast(di, hn::Shl(hn::Set(du, 1U), level)));
      unclear = hn::Gt(side, hn::Set(d, 1.0F));
    }
    const auto size = hn::Mul(side, hn::Set(d, 256.0F));
    const auto last = hn::Sub(hn::Set(d, 4096.0F), side);
    auto numerator = zero;
    auto found_speed = hn::Set(d, 1.0F);
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const auto map = [&](const float(&of)[3][3]) {
        return hn::MulAdd(x, hn::Set(d, of[1][axis]),
                          hn::MulAdd(y, hn::Set(d, of[2][axis]), hn::Set(d, of[0][axis])));
      };
      const auto rest = map(frame.map_rest);
      const auto nearest = hn::Round(rest);
      unclear = hn::Or(unclear, hn::Gt(hn::Abs(hn::Sub(rest, nearest)), hn::Set(d, 0.5F - frame.map_error)));
      const auto varying = hn::Add(map(frame.map_whole), nearest);
      auto direction = varying;
      auto origin = hn::Set(d, static_cast<float>(frame.camera.eye()[axis].raw));
      if (!kPerspective) {
        origin = hn::Add(origin, varying);
        direction = hn::Set(d, static_cast<float>(frame.camera.direction()[axis]));
      }
      const auto downward = hn::Lt(direction, zero);
      const auto mirrored = hn::ConvertTo(d, hn::LoadU(di, corners.at[axis] + at));
      const auto corner = hn::IfThenElse(downward, hn::Sub(last, mirrored), mirrored);
      const auto low = hn::MulSub(corner, hn::Set(d, 256.0F), origin);
      const auto speed = hn::Abs(direction);
      const auto distance = hn::IfThenElse(downward, hn::Neg(hn::Add(low, size)), low);
      const auto ours = hn::Mul(distance, found_speed);
      const auto theirs = hn::Mul(numerator, speed);
      const auto ahead = hn::And(hn::Gt(distance, zero), hn::Gt(speed, zero));
      const auto later = hn::And(ahead, hn::Gt(ours, theirs));
      const auto margin = hn::Mul(theirs, hn::Set(d, 1.0F / (1 << 21)));
      unclear = hn::Or(unclear, hn::And(ahead, hn::Lt(hn::Abs(hn::Sub(ours, theirs)), margin)));
      numerator = hn::IfThenElse(later, distance, numerator);
      found_speed = hn::IfThenElse(later, speed, found_speed);
    }
    if (scale.floats_tell) {
      const hn::Rebind<uint8_t, I32> bytes;
      const auto product = hn::Mul(numerator, ratios_of(scale, found_speed));
      const auto found = grays_in_floats(scale, product, 1.0F, &unclear);
      hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(di, found)), bytes, gray + at);
    } else {
      HWY_ALIGN float numerators[64];
      HWY_ALIGN float speeds[64];
      hn::Store(numerator, d, numerators);
      hn::Store(found_speed, d, speeds);
      for (size_t part = 0; part < lanes; part += lanes64) {
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
  if (unclear_count == 0) {
    return;
  }
  Pixels few;
  few.count = unclear_count;
  few.any_levels = pixels.any_levels;
  for (uint32_t i = 0; i < unclear_count + lanes; ++i) {  // and some behind, that mean nothing
    const uint32_t from = unclear_at[i < unclear_count ? i : 0];
    few.x[i] = pixels.x[from];
    few.y[i] = pixels.y[from];
    few.key[i] = pixels.key[from];
    few.cube[i] = pixels.cube[from];
    few.level[i] = pixels.any_levels ? pixels.level[from] : 0;
    few.voxels[i] = pixels.any_levels ? pixels.voxels[from] : 0;
  }
  uint8_t again[kMostPixels + 64];
  find_grays_exactly<kPerspective>(frame, few, scale, again);
  for (uint32_t i = 0; i < unclear_count; ++i) {
    gray[unclear_at[i]] = again[i];
  }
}

void find_grays(const Frame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  uint32_t blocks = 0;  // are never clear in floats
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

uint32_t put_grays(const Depths& depths, int32_t y, int32_t width_px, uint8_t background, uint8_t* to) {
  const hn::CappedTag<uint8_t, 32> d;
  const size_t lanes = hn::Lanes(d);
  const auto behind = hn::Set(d, background);
  const size_t stride = 32 * static_cast<size_t>(depths.rows);
  const uint8_t* from = depths.gray + 32 * depths.word(0, y);
  size_t count = 0;
  const auto put_strip = [&](uint8_t* into) {
    for (size_t part = 0; part < 32; part += lanes) {
      const auto gray = hn::LoadU(d, from + part);
      const auto is_none = hn::Eq(gray, hn::Zero(d));
      count += lanes - hn::CountTrue(d, is_none);
      hn::StoreU(hn::IfThenElse(is_none, behind, gray), d, into + part);
    }
    from += stride;
  };
  int32_t left = 0;
  for (; left + 32 <= width_px; left += 32) {
    put_strip(to + left);
  }
  if (left < width_px) {
    HWY_ALIGN uint8_t last[32];
    put_strip(last);
    __builtin_memcpy(to + left, last, static_cast<size_t>(width_px - left));
  }
  return static_cast<uint32_t>(count);
}

// Of one word of coverage.
void merge_word(const Depths& from, size_t word, const Depths& to) {
  for (uint32_t bits = from.covered[word]; bits != 0; bits &= bits - 1) {
    const uint32_t bit = bits & (0 - bits);
    const size_t pixel = 32 * word + static_cast<size_t>(__builtin_ctz(bits));
    if ((to.covered[word] & bit) == 0 || from.nearest[pixel] < to.nearest[pixel]) {
      to.nearest[pixel] = from.nearest[pixel];
    }
  }
  to.covered[word] |= from.covered[word];
}

void merge_rows(const Depths& from, int32_t width_px, int32_t y0, int32_t y1, const Depths& to) {
  const U32 d;
  const hn::Rebind<uint8_t, U32> bytes;
  const hn::Rebind<uint16_t, U32> shorts;
  const size_t lanes = hn::Lanes(d);
  for (int32_t left = 0; left < width_px; left += 32) {
    const size_t first = to.word(left, y0);
    const size_t end = to.word(left, y1);
    for (size_t word = first; to.gray_scale == nullptr && word < end; ++word) {
      merge_word(from, word, to);
    }
    for (size_t at = 32 * first; to.gray_scale != nullptr && at < 32 * end; at += lanes) {
      const auto theirs = hn::PromoteTo(d, hn::LoadU(bytes, from.gray + at));
      const auto ours = hn::PromoteTo(d, hn::LoadU(bytes, to.gray + at));
      const auto their_sum = hn::PromoteTo(d, hn::LoadU(shorts, from.nearest_sum + at));
      const auto our_sum = hn::PromoteTo(d, hn::LoadU(shorts, to.nearest_sum + at));
      const auto is_nearer = hn::Or(hn::Eq(ours, hn::Zero(d)), hn::Lt(their_sum, our_sum));
      const auto taken = hn::And(hn::Ne(theirs, hn::Zero(d)), is_nearer);
      const auto gray = hn::BitCast(I32(), hn::IfThenElse(taken, theirs, ours));
      const auto sum = hn::BitCast(I32(), hn::IfThenElse(taken, their_sum, our_sum));
      hn::StoreU(hn::DemoteTo(shorts, sum), shorts, to.nearest_sum + at);
      hn::StoreU(hn::DemoteTo(bytes, gray), bytes, to.gray + at);
    }
  }
}

template <bool kPerspective>
void find_faces_of(const Frame& frame, const Pixels& pixels, uint8_t* face) {
  const F64 d;
  const HalfI32 d32;
  const size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  Corners corners;
  find_corners(pixels, &corners);
  for (size_t at = 0; at < pixels.count; at += lanes) {
    const Entries found = entries_of<kPerspective>(frame, pixels, corners, at);
    // From inside: the face opposed to the largest component, the lowest axis on a tie.
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

void find_faces(const Frame& frame, const Pixels& pixels, uint8_t* face) {
  frame.perspective ? find_faces_of<true>(frame, pixels, face) : find_faces_of<false>(frame, pixels, face);
}

const char* instruction_set() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thimble::wide {

HWY_EXPORT(draw_run);
HWY_EXPORT(finish);
HWY_EXPORT(cull_run);
HWY_EXPORT(find_children);
HWY_EXPORT(find_covered);
HWY_EXPORT(unpack);
HWY_EXPORT(find_grays);
HWY_EXPORT(put_grays);
HWY_EXPORT(merge_rows);
HWY_EXPORT(find_faces);
HWY_EXPORT(instruction_set);

void draw_run(const Frame& frame, const Run& run, const Depths& depths, Batch* batch) {
  HWY_DYNAMIC_DISPATCH(draw_run)(frame, run, depths, batch);
}
void finish(const Frame& frame, const Depths& depths, Batch* batch) {
  HWY_DYNAMIC_DISPATCH(finish)(frame, depths, batch);
}
uint32_t cull_run(const Frame& frame, const Run& run, const Depths& depths, Batch* batch, uint32_t* entries,
                  uint32_t* numbers) {
  return HWY_DYNAMIC_DISPATCH(cull_run)(frame, run, depths, batch, entries, numbers);
}
int find_children(const Frame& frame, const Block& block, unsigned mask, uint32_t first_child,
                  unsigned nearest, Block* children) {
  return HWY_DYNAMIC_DISPATCH(find_children)(frame, block, mask, first_child, nearest, children);
}
int32_t find_covered(const Depths& depths, int32_t left, int32_t row, int32_t end, Pixels* pixels) {
  return HWY_DYNAMIC_DISPATCH(find_covered)(depths, left, row, end, pixels);
}
void unpack(const Depths& depths, Pixels* pixels) {
  HWY_DYNAMIC_DISPATCH(unpack)(depths, pixels);
}
void find_grays(const Frame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  HWY_DYNAMIC_DISPATCH(find_grays)(frame, pixels, scale, gray);
}
uint32_t put_grays(const Depths& depths, int32_t y, int32_t width_px, uint8_t background, uint8_t* to) {
  return HWY_DYNAMIC_DISPATCH(put_grays)(depths, y, width_px, background, to);
}
void merge_rows(const Depths& from, int32_t width_px, int32_t y0, int32_t y1, const Depths& to) {
  HWY_DYNAMIC_DISPATCH(merge_rows)(from, width_px, y0, y1, to);
}
void find_faces(const Frame& frame, const Pixels& pixels, uint8_t* face) {
  HWY_DYNAMIC_DISPATCH(find_faces)(frame, pixels, face);
}
const char* instruction_set() {
  return HWY_DYNAMIC_DISPATCH(instruction_set)();
}

int instruction_set_count() {
  hwy::SetSupportedTargetsForTest(0);
  return __builtin_popcountll(static_cast<uint64_t>(hwy::SupportedTargets() & HWY_TARGETS));
}
void use_instruction_set(int number) {
  hwy::SetSupportedTargetsForTest(0);
  if (number >= 0) {
    uint64_t targets = static_cast<uint64_t>(hwy::SupportedTargets() & HWY_TARGETS);
    for (; number > 0; --number) {
      targets &= targets - 1;
    }
    hwy::SetSupportedTargetsForTest(static_cast<int64_t>(targets & (0 - targets)));
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace thimble::wide
#endif
