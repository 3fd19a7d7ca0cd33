#include "host/wide/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/wide/kernels.cpp"
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
using HalfI32 = hn::Rebind<int32_t, F64>;  // as many lanes as F64
using HalfU32 = hn::Rebind<uint32_t, F64>;

// A bit a lane.
template <class D>
inline uint64_t bits_of(D d, hn::Mask<D> mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  uint64_t bits = 0;
  for (unsigned i = 0; i < 8; ++i) {
    bits |= uint64_t{bytes[i]} << (8 * i);
  }
  return bits;
}

// Pairs of a box and a pixel that wait for the exact test.
struct Queue {
  static constexpr size_t kSize = 1024;
  size_t count = 0;
  // Room for a store of a whole vector behind the last.
  alignas(64) uint32_t entry[kSize + 64];
  alignas(64) uint32_t number[kSize + 64];
  alignas(64) int32_t x[kSize + 64];
  alignas(64) int32_t y[kSize + 64];
};

// Pairs that were met, on their way into the picture.
struct Met {
  static constexpr size_t kSize = 1024;
  size_t count = 0;
  alignas(64) uint64_t value[kSize + 64];  // as in Depths::nearest
  alignas(64) uint32_t pixel[kSize + 64];  // y * width + x
};

// Bits 0..11 of numbers to every third bit.
using U64 = hn::RebindToUnsigned<F64>;
inline hn::Vec<U64> spread(hn::Vec<U64> v) {
  const U64 d;
  v = hn::And(hn::Or(v, hn::ShiftLeft<16>(v)), hn::Set(d, 0x00000000FF0000FFULL));
  v = hn::And(hn::Or(v, hn::ShiftLeft<8>(v)), hn::Set(d, 0x000000F00F00F00FULL));
  v = hn::And(hn::Or(v, hn::ShiftLeft<4>(v)), hn::Set(d, 0x000000C30C30C30C3ULL));
  return hn::And(hn::Or(v, hn::ShiftLeft<2>(v)), hn::Set(d, 0x0000001249249249ULL));
}

// Side of an entry as a power of two, and its x without the bits that tell it.
inline int32_t level_of(uint32_t entry) {
  const uint32_t side = entry >> 30;
  return static_cast<int32_t>(side < 3 ? side : 3 + (entry & 7U));
}
inline uint32_t x_of(uint32_t entry) {
  return (entry >> 30) < 3 ? entry & 1023U : entry & 1016U;
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
      rays.origin[axis] = hn::Set(d, frame.eye[axis]);
      rays.direction[axis] = varying;
    } else {
      rays.origin[axis] = hn::Add(hn::Set(d, frame.eye[axis]), varying);
      rays.direction[axis] = hn::Set(d, frame.direction[axis]);
    }
  }
  return rays;
}

// Whether rays spend a positive length, at t >= 0, in boxes whose centres are `center` (less the origin, in
// 1/512 voxel) and whose half sides are `half` (in the same unit). All numbers are integers; products are
// below 2^25 * 2^20, so they are exact.
//
// Two planes of different axes a and b: the ray passes the lower plane of each before the upper one of the
// other just when |c_a d_b - c_b d_a| < half (|d_a| + |d_b|). Along an axis with d = 0 it must lie in the
// slab, lower plane included.
inline hn::Mask<F64> meets(const Rays& rays, const hn::Vec<F64> (&center)[3], hn::Vec<F64> half) {
  const F64 d;
  const auto zero = hn::Zero(d);
  hn::Vec<F64> size[3];
  hn::Mask<F64> still[3];
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = hn::Abs(rays.direction[axis]);
    still[axis] = hn::Eq(size[axis], zero);
  }
  constexpr int kPairs[3][2] = {{0, 1}, {1, 2}, {2, 0}};
  const auto any_still = hn::Or(hn::Or(still[0], still[1]), still[2]);
  const bool none_still = hn::AllFalse(d, any_still);
  auto met = hn::Eq(zero, zero);
  for (const auto& pair : kPairs) {
    const int a = pair[0];
    const int b = pair[1];
    const auto cross = hn::Sub(hn::Mul(center[a], rays.direction[b]), hn::Mul(center[b], rays.direction[a]));
    auto within = hn::Lt(hn::Abs(cross), hn::Mul(half, hn::Add(size[a], size[b])));
    if (!none_still) {
      within = hn::Or(within, hn::Or(still[a], still[b]));
    }
    met = hn::And(met, within);
  }
  const auto minus_half = hn::Neg(half);
  for (int axis = 0; axis < 3; ++axis) {
    // The upper plane, as the ray goes, lies ahead.
    const auto sign = hn::CopySign(hn::Set(d, 1), rays.direction[axis]);
    auto fits = hn::Gt(hn::Mul(sign, center[axis]), minus_half);
    if (!none_still) {
      const auto in_slab = hn::And(hn::Le(center[axis], half), hn::Gt(center[axis], minus_half));
      fits = hn::Or(hn::And(still[axis], in_slab), hn::AndNot(still[axis], fits));
    }
    met = hn::And(met, fits);
  }
  return met;
}

inline hn::Vec<F64> doubles(const uint32_t* from) {
  const HalfU32 d32;
  return hn::ConvertTo(F64(), hn::PromoteTo(hn::RebindToUnsigned<F64>(), hn::LoadU(d32, from)));
}
inline hn::Vec<F64> doubles(const int32_t* from) {
  const HalfI32 d32;
  return hn::PromoteTo(F64(), hn::LoadU(d32, from));
}

// What Depths keeps of boxes with lowest corners `place`, for rays that run downwards where `rays` says so.
inline hn::Vec<U64> values_of(const Rays& rays, const hn::Vec<F64> (&place)[3], hn::Vec<F64> half, bool unit,
                              hn::Vec<U64> number) {
  const F64 d;
  const U64 d64;
  const hn::RebindToSigned<F64> di64;
  const auto zero = hn::Zero(d);
  auto value = hn::Zero(d64);
  for (int axis = 2; axis >= 0; --axis) {
    // Mirrored in a world of 4096: the box's upper corner becomes its lowest.
    auto low = place[axis];
    if (!unit) {
      const auto last = hn::NegMulAdd(half, hn::Set(d, 1.0 / 256), hn::Set(d, 4096));
      low = hn::IfThenElse(hn::Lt(rays.direction[axis], zero), hn::Sub(last, low), low);
    } else {
      low = hn::IfThenElse(hn::Lt(rays.direction[axis], zero), hn::Sub(hn::Set(d, 4095), low), low);
    }
    const auto whole = hn::BitCast(d64, hn::ConvertTo(di64, low));
    value = hn::Or(hn::ShiftLeft<1>(value), spread(whole));
  }
  return hn::Or(hn::ShiftLeft<kEntryBits>(value), number);
}

// Takes what was met into the picture.
inline void keep(const Depths& depths, Met* met) {
  constexpr size_t kAhead = 12;
  for (size_t i = 0; i < met->count; ++i) {
    __builtin_prefetch(depths.nearest + met->pixel[i + kAhead < met->count ? i + kAhead : i], 1);
    const uint32_t pixel = met->pixel[i];
    const uint64_t bit = uint64_t{1} << (pixel & 63U);
    uint64_t* covered = depths.covered + (pixel >> 6);
    uint64_t* nearest = depths.nearest + pixel;
    const uint64_t before = (*covered & bit) != 0 ? *nearest : UINT64_MAX;
    *covered |= bit;
    *nearest = met->value[i] < before ? met->value[i] : before;
  }
  met->count = 0;
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

// The exact test of what waits.
template <bool kPerspective>
void test_exactly(const Frame& frame, const Run& run, const Depths& depths, Queue* queue, Met* hits,
                  Counts* counts) {
  const F64 d;
  const size_t lanes = hn::Lanes(d);
  const HalfU32 d32;
  const HalfI32 di32;
  const U64 d64;
  for (size_t i = queue->count; i < queue->count + lanes;
       ++i) {  // lanes of the last vector that are for nothing
    queue->entry[i] = 0;
    queue->x[i] = frame.tile.x0;
    queue->y[i] = frame.tile.y0;
  }
  counts->exact += queue->count;
  for (size_t at = 0; at < queue->count; at += lanes) {
    const Rays rays = rays_of<kPerspective>(frame, doubles(queue->x + at), doubles(queue->y + at));
    const auto entry = hn::LoadU(d32, queue->entry + at);
    hn::Vec<HalfU32> level;
    hn::Vec<HalfU32> entry_x;
    unpack_side(d32, entry, run.unit, &level, &entry_x);
    const auto half = hn::PromoteTo(d, hn::BitCast(di32, hn::Shl(hn::Set(d32, 256U), level)));
    const auto as_double = [&](auto value, uint32_t corner) {
      return hn::PromoteTo(d, hn::BitCast(di32, hn::Add(value, hn::Set(d32, corner))));
    };
    const auto within = hn::Set(d32, 1023U);
    const hn::Vec<F64> place[3] = {as_double(entry_x, run.corner[0]),
                                   as_double(hn::And(hn::ShiftRight<10>(entry), within), run.corner[1]),
                                   as_double(hn::And(hn::ShiftRight<20>(entry), within), run.corner[2])};
    hn::Vec<F64> center[3];
    for (int axis = 0; axis < 3; ++axis) {
      center[axis] = hn::Add(hn::Mul(place[axis], hn::Set(d, 512)), half);
      center[axis] = hn::NegMulAdd(rays.origin[axis], hn::Set(d, 2), center[axis]);
    }
    auto met = hn::And(meets(rays, center, half), hn::FirstN(d, queue->count - at));
    if (hn::AllFalse(d, met)) {
      continue;
    }
    const auto number = hn::PromoteTo(d64, hn::LoadU(d32, queue->number + at));
    const auto value = values_of(rays, place, half, run.unit, number);
    const auto pixel = hn::Add(hn::Mul(hn::LoadU(di32, queue->y + at), hn::Set(di32, depths.width_px)),
                               hn::LoadU(di32, queue->x + at));
    const auto wide_pixel = hn::PromoteTo(d64, hn::BitCast(d32, pixel));
    hn::StoreU(hn::Compress(value, hn::RebindMask(d64, met)), d64, hits->value + hits->count);
    hn::StoreU(hn::TruncateTo(d32, hn::Compress(wide_pixel, hn::RebindMask(d64, met))), d32,
               hits->pixel + hits->count);
    hits->count += hn::CountTrue(d, met);
    if (hits->count + lanes > Met::kSize) {
      counts->hits += hits->count;
      keep(depths, hits);
    }
  }
  queue->count = 0;
}

// Bits 0..9 to every third bit.
inline hn::Vec<U32> spread10(hn::Vec<U32> v) {
  const U32 d;
  v = hn::And(hn::Or(v, hn::ShiftLeft<16>(v)), hn::Set(d, 0x030000FFU));
  v = hn::And(hn::Or(v, hn::ShiftLeft<8>(v)), hn::Set(d, 0x0300F00FU));
  v = hn::And(hn::Or(v, hn::ShiftLeft<4>(v)), hn::Set(d, 0x030C30C3U));
  return hn::And(hn::Or(v, hn::ShiftLeft<2>(v)), hn::Set(d, 0x09249249U));
}

// The mirrored keys of a cube's corner, for each choice of axes along which rays run downwards.
struct CubeKeys {
  uint64_t of[8];
  explicit CubeKeys(const Run& run) {
    for (unsigned down = 0; down < 8; ++down) {
      uint64_t key = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const uint32_t cube = run.corner[axis] >> 10 ^ ((down >> axis & 1U) != 0 ? 3U : 0U);
        key |= uint64_t{cube & 1U} << (30 + axis) | uint64_t{cube >> 1 & 1U} << (33 + axis);
      }
      of[down] = key << kEntryBits;
    }
  }
};

// Tests what waits in floats where they can tell, and exactly where they cannot.
//
// Rounded directions: off a half by more than the error of the float map, the float's nearest integer is the
// direction. Centres (below 2^24) and directions (below 2^16) are then exact, and so is what is compared
// with: half * (|d_a| + |d_b|) is an integer below 2^24 times a power of two. c_a d_b - c_b d_a, by Kahan's
// method with fused products, is within 2 units in the last place of itself (C.-P. Jeannerod, N. Louvet,
// J.-M. Muller, "Further analysis of Kahan's algorithm", Math. Comp. 2013: 1.5), so 2^-21 of it settles what
// is nearer than that; without fused products the two roundings of the products count too.
template <bool kPerspective>
void test_all(const Frame& frame, const Run& run, const Depths& depths, const CubeKeys& cubes, Queue* queue,
              Queue* unsure, Met* hits, Counts* counts) {
  const F32 d;
  const I32 di;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  counts->candidates += queue->count;
  for (size_t i = queue->count; i < queue->count + lanes; ++i) {
    queue->entry[i] = 0;
    queue->x[i] = frame.tile.x0;
    queue->y[i] = frame.tile.y0;
  }
  const auto within = hn::Set(du, 1023U);
  const auto zero = hn::Zero(d);
  for (size_t at = 0; at < queue->count; at += lanes) {
    const auto live = hn::FirstN(d, queue->count - at);
    const auto x = hn::ConvertTo(d, hn::Load(di, queue->x + at));
    const auto y = hn::ConvertTo(d, hn::Load(di, queue->y + at));
    const auto entry = hn::Load(du, queue->entry + at);
    hn::Vec<U32> level;
    hn::Vec<U32> entry_x;
    unpack_side(du, entry, run.unit, &level, &entry_x);
    const auto half =
        run.unit ? hn::Set(d, 256.0F) : hn::ConvertTo(d, hn::BitCast(di, hn::Shl(hn::Set(du, 256U), level)));
    const hn::Vec<U32> low[3] = {entry_x, hn::And(hn::ShiftRight<10>(entry), within),
                                 hn::And(hn::ShiftRight<20>(entry), within)};
    hn::Vec<F32> direction[3];
    hn::Vec<F32> center[3];
    auto unclear = hn::Lt(zero, zero);
    for (int axis = 0; axis < 3; ++axis) {
      const auto map = [&](const float(&of)[3][3]) {
        return hn::MulAdd(x, hn::Set(d, of[1][axis]),
                          hn::MulAdd(y, hn::Set(d, of[2][axis]), hn::Set(d, of[0][axis])));
      };
      const auto rest = map(frame.map_rest);
      const auto nearest = hn::Round(rest);
      unclear = hn::Or(unclear, hn::Gt(hn::Abs(hn::Sub(rest, nearest)), hn::Set(d, 0.5F - frame.map_error)));
      const auto varying = hn::Add(map(frame.map_whole), nearest);
      const auto place = hn::ConvertTo(d, hn::BitCast(di, low[axis]));
      const float origin = static_cast<float>(512.0 * run.corner[axis] - 2 * frame.eye[axis]);
      center[axis] = hn::Add(hn::MulAdd(place, hn::Set(d, 512.0F), hn::Set(d, origin)), half);
      if (kPerspective) {
        direction[axis] = varying;
      } else {
        direction[axis] = hn::Set(d, static_cast<float>(frame.direction[axis]));
        center[axis] = hn::NegMulAdd(varying, hn::Set(d, 2.0F), center[axis]);
      }
    }
    // An orthographic camera's rays may all stand still along an axis; a perspective camera's do so here and
    // there.
    hn::Vec<F32> size[3];
    bool still[3] = {false, false, false};
    for (int axis = 0; axis < 3; ++axis) {
      size[axis] = hn::Abs(direction[axis]);
      if (kPerspective) {
        unclear = hn::Or(unclear, hn::Eq(size[axis], zero));
      } else {
        still[axis] = frame.direction[axis] == 0;
      }
    }
    auto met = live;
    constexpr int kPairs[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    for (const auto& pair : kPairs) {
      const int a = pair[0];
      const int b = pair[1];
      if (still[a] || still[b]) {
        continue;
      }
      const auto product = hn::Mul(center[b], direction[a]);
      const auto wanted = hn::Mul(half, hn::Add(size[a], size[b]));
#if HWY_NATIVE_FMA
      const auto error = hn::NegMulAdd(center[b], direction[a], product);
      const auto cross = hn::Abs(hn::Add(hn::MulSub(center[a], direction[b], product), error));
      const auto margin = hn::Mul(wanted, hn::Set(d, 1.0F / (1 << 21)));
#else
      const auto other = hn::Mul(center[a], direction[b]);
      const auto cross = hn::Abs(hn::Sub(other, product));
      const auto margin =
          hn::Mul(hn::Add(wanted, hn::Add(hn::Abs(other), hn::Abs(product))), hn::Set(d, 1.0F / (1 << 21)));
#endif
      met = hn::And(met, hn::Lt(cross, wanted));
      unclear = hn::Or(unclear, hn::Le(hn::Abs(hn::Sub(cross, wanted)), margin));
    }
    const auto minus_half = hn::Neg(half);
    for (int axis = 0; axis < 3; ++axis) {
      if (still[axis]) {
        met = hn::And(met, hn::And(hn::Le(center[axis], half), hn::Gt(center[axis], minus_half)));
        continue;
      }
      const auto sign = hn::CopySign(hn::Set(d, 1.0F), direction[axis]);
      met = hn::And(met, hn::Gt(hn::Mul(sign, center[axis]), minus_half));
    }
    unclear = hn::And(unclear, live);
    if (!hn::AllFalse(d, unclear)) {
      const auto to = unsure->count;
      hn::StoreU(hn::Compress(entry, hn::RebindMask(du, unclear)), du, unsure->entry + to);
      hn::StoreU(hn::Compress(hn::Load(du, queue->number + at), hn::RebindMask(du, unclear)), du,
                 unsure->number + to);
      hn::StoreU(hn::Compress(hn::Load(di, queue->x + at), hn::RebindMask(di, unclear)), di, unsure->x + to);
      hn::StoreU(hn::Compress(hn::Load(di, queue->y + at), hn::RebindMask(di, unclear)), di, unsure->y + to);
      unsure->count += hn::CountTrue(d, unclear);
      met = hn::AndNot(unclear, met);
      if (unsure->count + 2 * lanes > Queue::kSize) {
        test_exactly<kPerspective>(frame, run, depths, unsure, hits, counts);
      }
    }
    if (hn::AllFalse(d, met)) {
      continue;
    }
    // Keys, mirrored by the signs of the directions; then those that were met, in a row.
    auto key = hn::Zero(du);
    auto down = hn::Zero(du);
    const auto side_mask = hn::Neg(hn::BitCast(di, hn::Shl(hn::Set(du, 1U), level)));
    for (int axis = 2; axis >= 0; --axis) {
      const auto is_down = hn::RebindMask(du, hn::Lt(direction[axis], zero));
      auto mirrored = hn::Xor(low[axis], hn::IfThenElseZero(is_down, within));
      if (!run.unit) {
        mirrored = hn::And(mirrored, hn::BitCast(du, side_mask));
      }
      key = hn::Or(hn::ShiftLeft<1>(key), spread10(mirrored));
      down = hn::Or(hn::ShiftLeft<1>(down), hn::IfThenElseZero(is_down, hn::Set(du, 1U)));
    }
    const auto pixel = hn::Add(hn::Mul(hn::Load(di, queue->y + at), hn::Set(di, depths.width_px)),
                               hn::Load(di, queue->x + at));
    HWY_ALIGN uint32_t keys[64], downs[64], numbers[64];
    const auto chosen = hn::RebindMask(du, met);
    hn::StoreU(hn::Compress(key, chosen), du, keys);
    hn::StoreU(hn::Compress(down, chosen), du, downs);
    hn::StoreU(hn::Compress(hn::Load(du, queue->number + at), chosen), du, numbers);
    hn::StoreU(hn::Compress(hn::BitCast(du, pixel), chosen), du, hits->pixel + hits->count);
    const size_t count = hn::CountTrue(d, met);
    for (size_t i = 0; i < count; ++i) {
      hits->value[hits->count + i] = cubes.of[downs[i]] | uint64_t{keys[i]} << kEntryBits | numbers[i];
    }
    hits->count += count;
    if (hits->count + lanes > Met::kSize) {
      counts->hits += hits->count;
      keep(depths, hits);
    }
  }
  queue->count = 0;
}

// A box that covers many pixels: along the rows of its rectangle, all that fit a vector at once.
template <bool kPerspective>
void draw_large(const Frame& frame, const Run& run, uint32_t entry, uint32_t number, const Rectangle& where,
                const Depths& depths, Met* hits, Counts* counts) {
  const F64 d;
  const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
  const double side = 1 << level_of(entry);
  const auto half = hn::Set(d, side * 256);
  const double corner[3] = {static_cast<double>(run.corner[0] + x_of(entry)),
                            static_cast<double>(run.corner[1] + (entry >> 10 & 1023U)),
                            static_cast<double>(run.corner[2] + (entry >> 20 & 1023U))};
  const hn::Vec<F64> place[3] = {hn::Set(d, corner[0]), hn::Set(d, corner[1]), hn::Set(d, corner[2])};
  for (int32_t y = where.y0; y < where.y1; ++y) {
    for (int32_t x = where.x0; x < where.x1; x += lanes) {
      const auto column = hn::Iota(d, static_cast<double>(x));
      const Rays rays = rays_of<kPerspective>(frame, column, hn::Set(d, y));
      hn::Vec<F64> center[3];
      for (int axis = 0; axis < 3; ++axis) {
        center[axis] =
            hn::NegMulAdd(rays.origin[axis], hn::Set(d, 2), hn::Set(d, corner[axis] * 512 + side * 256));
      }
      auto met = meets(rays, center, half);
      const int32_t left = where.x1 - x;
      if (left < lanes) {
        met = hn::And(met, hn::FirstN(d, static_cast<size_t>(left)));
      }
      counts->candidates += static_cast<uint64_t>(left < lanes ? left : lanes);
      if (hn::AllFalse(d, met)) {
        continue;
      }
      const U64 d64;
      const auto value = values_of(rays, place, half, false, hn::Set(d64, number));
      const uint32_t first_pixel = static_cast<uint32_t>(y * depths.width_px + x);
      const auto pixel = hn::Iota(d64, first_pixel);
      hn::StoreU(hn::Compress(value, hn::RebindMask(d64, met)), d64, hits->value + hits->count);
      hn::StoreU(hn::TruncateTo(HalfU32(), hn::Compress(pixel, hn::RebindMask(d64, met))), HalfU32(),
                 hits->pixel + hits->count);
      hits->count += hn::CountTrue(d, met);
      if (hits->count + hn::Lanes(d) > Met::kSize) {
        counts->hits += hits->count;
        keep(depths, hits);
      }
    }
  }
}

// Whether a box in the eye's plane may be seen through the tile: not when it lies wholly outside one of the
// tile's four sides. In doubles, by its corners: few boxes come here.
bool crosses_tile(const Frame& frame, const double (&center)[3], double side) {
  const double slack_x = double{frame.slack_x} + 1;
  const double slack_y = double{frame.slack_y} + 1;
  const double edge[4] = {frame.tile.x0 - slack_x, frame.tile.x1 + slack_x, frame.tile.y0 - slack_y,
                          frame.tile.y1 + slack_y};
  for (int s = 0; s < 4; ++s) {
    const float(&row)[4] = s < 2 ? frame.u : frame.v;
    const double sign = (s & 1) != 0 ? -1 : 1;
    const auto plane = [&](int i) { return sign * (double{row[i]} - edge[s] * double{frame.w[i]}); };
    double distance = plane(3);
    double reach = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double normal = plane(axis);
      distance += normal * center[axis];
      reach += (normal < 0 ? -normal : normal) * side * 0.5;
    }
    const double rounding = double{s < 2 ? frame.rounding_x : frame.rounding_y};
    if (distance + reach + 2 * rounding < 0) {
      return false;
    }
  }
  return true;
}

template <bool kPerspective, bool kUnit>
void draw_run_of(const Frame& frame, const Run& run, const Depths& depths, Counts* counts) {
  const F32 d;
  const I32 di;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  counts->boxes += run.count;
  HWY_ALIGN Queue queue;
  HWY_ALIGN Queue unsure;
  HWY_ALIGN Met hits;
  const CubeKeys cubes(run);
  const auto within = hn::Set(du, 1023U);
  // The corner of the cube and the middle of a voxel go into the constants.
  const auto constant = [&](const float(&row)[4]) {
    double sum = row[3];
    for (int axis = 0; axis < 3; ++axis) {
      sum += static_cast<double>(row[axis]) * (run.corner[axis] + (kUnit ? 0.5 : 0.0));
    }
    return hn::Set(d, static_cast<float>(sum));
  };
  const auto u3 = constant(frame.u);
  const auto v3 = constant(frame.v);
  const auto w3 = constant(frame.w);
  const auto first_x = hn::Set(d, static_cast<float>(frame.tile.x0));
  const auto last_x = hn::Set(d, static_cast<float>(frame.tile.x1 - 1));
  const auto first_y = hn::Set(d, static_cast<float>(frame.tile.y0));
  const auto last_y = hn::Set(d, static_cast<float>(frame.tile.y1 - 1));
  const auto zero = hn::Zero(d);
  const auto one = hn::Set(d, 1.0F);
  for (uint32_t at = 0; at < run.count; at += static_cast<uint32_t>(lanes)) {
    if (queue.count + 4 * lanes > Queue::kSize) {
      test_all<kPerspective>(frame, run, depths, cubes, &queue, &unsure, &hits, counts);
    }
    const uint32_t left = run.count - at;
    const auto live = hn::FirstN(d, left);
    const auto entry = left >= lanes ? hn::LoadU(du, run.entries + at)
                                     : hn::MaskedLoad(hn::FirstN(du, left), du, run.entries + at);
    auto entry_x = hn::And(entry, within);
    auto side = one;
    if (!kUnit) {
      const auto code = hn::ShiftRight<30>(entry);
      const auto is_large = hn::Eq(code, hn::Set(du, 3U));
      const auto more = hn::IfThenElseZero(is_large, hn::And(entry, hn::Set(du, 7U)));
      entry_x = hn::Sub(entry_x, more);
      side = hn::ConvertTo(d, hn::BitCast(di, hn::Shl(hn::Set(du, 1U), hn::Add(code, more))));
    }
    auto x = hn::ConvertTo(d, hn::BitCast(di, entry_x));
    auto y = hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<10>(entry), within)));
    auto z = hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<20>(entry), within)));
    if (!kUnit) {
      const auto middle = hn::Mul(side, hn::Set(d, 0.5F));
      x = hn::Add(x, middle);
      y = hn::Add(y, middle);
      z = hn::Add(z, middle);
    }
    const auto apply = [&](const float(&row)[4], auto last) {
      return hn::MulAdd(hn::Set(d, row[0]), x,
                        hn::MulAdd(hn::Set(d, row[1]), y, hn::MulAdd(hn::Set(d, row[2]), z, last)));
    };
    auto column = apply(frame.u, u3);
    auto row = apply(frame.v, v3);
    auto seen = live;
    hn::Mask<F32> crossing = hn::Lt(one, zero);
    auto per_depth = one;
    if (kPerspective) {
      const auto depth = apply(frame.w, w3);
      const auto behind = hn::Le(depth, zero);
      const auto reach_w = hn::MulAdd(hn::Set(d, frame.half_w), side, hn::Set(d, frame.rounding_w));
      crossing = hn::And(live, hn::And(hn::Le(depth, zero), hn::Gt(hn::Add(depth, reach_w), zero)));
      seen = hn::AndNot(behind, seen);
      per_depth = hn::Div(one, depth);
      column = hn::Mul(column, per_depth);
      row = hn::Mul(row, per_depth);
    }
    const auto half_x = hn::MulAdd(hn::MulAdd(hn::Set(d, frame.reach_x), side, hn::Set(d, frame.rounding_x)),
                                   per_depth, hn::Set(d, frame.slack_x));
    const auto half_y = hn::MulAdd(hn::MulAdd(hn::Set(d, frame.reach_y), side, hn::Set(d, frame.rounding_y)),
                                   per_depth, hn::Set(d, frame.slack_y));
    const auto low_x = hn::Max(hn::Ceil(hn::Sub(column, half_x)), first_x);
    const auto high_x = hn::Min(hn::Floor(hn::Add(column, half_x)), last_x);
    const auto low_y = hn::Max(hn::Ceil(hn::Sub(row, half_y)), first_y);
    const auto high_y = hn::Min(hn::Floor(hn::Add(row, half_y)), last_y);
    seen = hn::And(seen, hn::And(hn::Le(low_x, high_x), hn::Le(low_y, high_y)));
    if (kPerspective && !hn::AllFalse(d, crossing)) {
      uint64_t bits = bits_of(d, crossing);
      for (; bits != 0; bits &= bits - 1) {
        const uint32_t i = at + static_cast<uint32_t>(__builtin_ctzll(bits));
        const double box = 1 << level_of(run.entries[i]);
        const double center[3] = {run.corner[0] + x_of(run.entries[i]) + box / 2,
                                  run.corner[1] + (run.entries[i] >> 10 & 1023U) + box / 2,
                                  run.corner[2] + (run.entries[i] >> 20 & 1023U) + box / 2};
        if (crosses_tile(frame, center, box)) {
          ++counts->crossing;
          draw_large<kPerspective>(frame, run, run.entries[i], run.first + i,
                                   {frame.tile.x0, frame.tile.y0, frame.tile.x1, frame.tile.y1}, depths,
                                   &hits, counts);
        }
      }
    }
    if (hn::AllFalse(d, seen)) {
      continue;
    }
    const auto wide_x = hn::Gt(high_x, low_x);
    const auto wide_y = hn::Gt(high_y, low_y);
    const auto large =
        hn::And(seen, hn::Or(hn::Gt(high_x, hn::Add(low_x, one)), hn::Gt(high_y, hn::Add(low_y, one))));
    if (!hn::AllFalse(d, large)) {
      HWY_ALIGN int32_t x0[64], x1[64], y0[64], y1[64];
      hn::Store(hn::ConvertTo(di, low_x), di, x0);
      hn::Store(hn::ConvertTo(di, high_x), di, x1);
      hn::Store(hn::ConvertTo(di, low_y), di, y0);
      hn::Store(hn::ConvertTo(di, high_y), di, y1);
      uint64_t bits = bits_of(d, large);
      for (; bits != 0; bits &= bits - 1) {
        const unsigned lane = static_cast<unsigned>(__builtin_ctzll(bits));
        draw_large<kPerspective>(frame, run, run.entries[at + lane], run.first + at + lane,
                                 {x0[lane], y0[lane], x1[lane] + 1, y1[lane] + 1}, depths, &hits, counts);
      }
      seen = hn::AndNot(large, seen);
    }
    const auto int_x = hn::ConvertTo(di, low_x);
    const auto int_y = hn::ConvertTo(di, low_y);
    const auto number = hn::Iota(du, run.first + at);
    const auto push = [&](auto mask, auto pixel_x, auto pixel_y) {
      const auto chosen = hn::RebindMask(du, mask);
      hn::StoreU(hn::Compress(entry, chosen), du, queue.entry + queue.count);
      hn::StoreU(hn::Compress(number, chosen), du, queue.number + queue.count);
      hn::StoreU(hn::Compress(pixel_x, hn::RebindMask(di, mask)), di, queue.x + queue.count);
      hn::StoreU(hn::Compress(pixel_y, hn::RebindMask(di, mask)), di, queue.y + queue.count);
      queue.count += hn::CountTrue(d, mask);
    };
    push(seen, int_x, int_y);
    const auto across = hn::And(seen, wide_x);
    const auto down = hn::And(seen, wide_y);
    if (!hn::AllFalse(d, hn::Or(across, down))) {
      const auto next_x = hn::Add(int_x, hn::Set(di, 1));
      const auto next_y = hn::Add(int_y, hn::Set(di, 1));
      push(across, next_x, int_y);
      push(down, int_x, next_y);
      push(hn::And(across, down), next_x, next_y);
    }
  }
  test_all<kPerspective>(frame, run, depths, cubes, &queue, &unsure, &hits, counts);
  test_exactly<kPerspective>(frame, run, depths, &unsure, &hits, counts);
  counts->hits += hits.count;
  keep(depths, &hits);
}

void draw_run(const Frame& frame, const Run& run, const Depths& depths, Counts* counts) {
  if (frame.perspective) {
    run.unit ? draw_run_of<true, true>(frame, run, depths, counts)
             : draw_run_of<true, false>(frame, run, depths, counts);
  } else {
    run.unit ? draw_run_of<false, true>(frame, run, depths, counts)
             : draw_run_of<false, false>(frame, run, depths, counts);
  }
}

void find_rectangles(const Frame& frame, const float* xs, const float* ys, const float* zs, float side,
                     Rectangle* rectangles) {
  const hn::CappedTag<float, 8> d;
  const hn::RebindToSigned<decltype(d)> di;
  const size_t lanes = hn::Lanes(d);
  for (size_t at = 0; at < 8; at += lanes) {
    const auto middle = hn::Set(d, side * 0.5F);
    const auto x = hn::Add(hn::LoadU(d, xs + at), middle);
    const auto y = hn::Add(hn::LoadU(d, ys + at), middle);
    const auto z = hn::Add(hn::LoadU(d, zs + at), middle);
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
    const auto half_x =
        hn::MulAdd(hn::Set(d, frame.reach_x * side + frame.rounding_x), per_depth, hn::Set(d, frame.slack_x));
    const auto half_y =
        hn::MulAdd(hn::Set(d, frame.reach_y * side + frame.rounding_y), per_depth, hn::Set(d, frame.slack_y));
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
    HWY_ALIGN int32_t stored[4][8];
    hn::StoreU(hn::ConvertTo(di, x0), di, stored[0]);
    hn::StoreU(hn::ConvertTo(di, y0), di, stored[1]);
    hn::StoreU(hn::ConvertTo(di, x1), di, stored[2]);
    hn::StoreU(hn::ConvertTo(di, y1), di, stored[3]);
    for (size_t i = 0; i < lanes; ++i) {
      const bool empty = stored[0][i] >= stored[2][i] || stored[1][i] >= stored[3][i];
      rectangles[at + i] =
          empty ? Rectangle{0, 0, 0, 0} : Rectangle{stored[0][i], stored[1][i], stored[2][i], stored[3][i]};
    }
  }
}

// Every third bit of a key, from bit 0 on, to bits 0..11.
inline hn::Vec<F64> gathered(hn::Vec<hn::RebindToUnsigned<F64>> key, hn::Mask<F64> mirrored,
                             hn::Vec<HalfI32> side_mask) {
  const F64 d;
  const hn::RebindToUnsigned<F64> d64;
  auto v = hn::And(key, hn::Set(d64, 0x1249249249249249ULL));
  v = hn::And(hn::Or(v, hn::ShiftRight<2>(v)), hn::Set(d64, 0x10C30C30C30C30C3ULL));
  v = hn::And(hn::Or(v, hn::ShiftRight<4>(v)), hn::Set(d64, 0x100F00F00F00F00FULL));
  v = hn::And(hn::Or(v, hn::ShiftRight<8>(v)), hn::Set(d64, 0x001F0000FF0000FFULL));
  v = hn::And(hn::Or(v, hn::ShiftRight<16>(v)), hn::Set(d64, 0x001F00000000FFFFULL));
  v = hn::And(hn::Or(v, hn::ShiftRight<32>(v)), hn::Set(d64, 0xFFFULL));
  const auto flip = hn::IfThenElseZero(hn::RebindMask(d64, mirrored), hn::Set(d64, 0xFFFULL));
  const auto place = hn::BitCast(HalfI32(), hn::TruncateTo(HalfU32(), hn::Xor(v, flip)));
  return hn::PromoteTo(d, hn::And(place, side_mask));
}

// Where the ray enters its box: over the axes, the latest t of the nearer plane, ties to the lowest axis;
// compared as fractions, num_a |d_b| > num_b |d_a|, in integers below 2^44. The box is one that the ray
// meets.
template <bool kPerspective>
void resolve(const Frame& frame, int32_t y, int32_t word, const uint64_t* nearest, const int32_t* levels,
             WordHits* hits) {
  const F64 d;
  const HalfI32 d32;
  const hn::RebindToUnsigned<F64> d64;
  const size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  for (size_t at = 0; at < 64; at += lanes) {
    const double first = static_cast<double>(word * 64) + static_cast<double>(at);
    const Rays rays = rays_of<kPerspective>(frame, hn::Iota(d, first), hn::Set(d, y));
    auto side = hn::Set(d32, 1);
    if (levels != nullptr) {
      side = hn::Shl(side, hn::LoadU(d32, levels + at));
    }
    const auto side_mask = hn::Neg(side);
    const auto size = hn::Mul(hn::PromoteTo(d, side), hn::Set(d, 256));
    const auto key = hn::ShiftRight<kEntryBits>(hn::LoadU(d64, nearest + at));
    const hn::Vec<hn::RebindToUnsigned<F64>> keys[3] = {key, hn::ShiftRight<1>(key), hn::ShiftRight<2>(key)};
    auto best_axis = hn::Set(d, -1);
    auto best_numerator = zero;
    auto best_speed = hn::Set(d, 1);
    for (int axis = 0; axis < 3; ++axis) {
      const auto downward = hn::Lt(rays.direction[axis], zero);
      const auto corner = gathered(keys[axis], downward, side_mask);
      const auto low = hn::Sub(hn::Mul(corner, hn::Set(d, 256)), rays.origin[axis]);
      const auto speed = hn::Abs(rays.direction[axis]);
      const auto distance = hn::IfThenElse(downward, hn::Neg(hn::Add(low, size)), low);
      // A plane at or behind the origin is not entered through.
      const auto later = hn::And(hn::And(hn::Gt(distance, zero), hn::Gt(speed, zero)),
                                 hn::Gt(hn::Mul(distance, best_speed), hn::Mul(best_numerator, speed)));
      best_axis = hn::IfThenElse(later, hn::Set(d, axis), best_axis);
      best_numerator = hn::IfThenElse(later, distance, best_numerator);
      best_speed = hn::IfThenElse(later, speed, best_speed);
      hn::StoreU(hn::DemoteTo(d32, rays.direction[axis]), d32, hits->direction[axis] + at);
    }
    hn::StoreU(hn::DemoteTo(d32, best_axis), d32, hits->axis + at);
    hn::StoreU(hn::DemoteTo(d32, best_numerator), d32, hits->numerator + at);
  }
}

void resolve_word(const Frame& frame, int32_t y, int32_t word, const uint64_t* nearest, const int32_t* levels,
                  WordHits* hits) {
  frame.perspective ? resolve<true>(frame, y, word, nearest, levels, hits)
                    : resolve<false>(frame, y, word, nearest, levels, hits);
}

// The core's sum, with its two roundings. Quotients of integers below 2^32 by integers below 2^20 are exact
// after Floor: two different ones lie farther apart than a double's last bit. The product has up to 55 bits
// and is taken in two parts.
void find_depths(const WordHits& hits, int32_t depth_per_t_q8, int32_t* depths_q8) {
  const F64 d;
  const HalfI32 d32;
  const size_t lanes = hn::Lanes(d);
  int shift = 0;
  while (depth_per_t_q8 > 0 && (static_cast<uint32_t>(depth_per_t_q8) << shift & 0x80000000U) == 0) {
    ++shift;
  }
  const auto zero = hn::Zero(d);
  const auto dividend = hn::Set(d, static_cast<double>(static_cast<uint32_t>(depth_per_t_q8) << shift));
  const auto most = hn::Set(d, 2147483647.0);
  const double scale = 1.0 / static_cast<double>(uint64_t{1} << (shift + 8));
  for (size_t at = 0; at < 64; at += lanes) {
    const auto axis = hn::LoadU(d32, hits.axis + at);
    auto speed = hn::LoadU(d32, hits.direction[0] + at);
    speed = hn::IfThenElse(hn::Eq(axis, hn::Set(d32, 1)), hn::LoadU(d32, hits.direction[1] + at), speed);
    speed = hn::IfThenElse(hn::Eq(axis, hn::Set(d32, 2)), hn::LoadU(d32, hits.direction[2] + at), speed);
    const auto size = hn::Abs(hn::PromoteTo(d, speed));
    const auto numerator = hn::PromoteTo(d, hn::LoadU(d32, hits.numerator + at));
    const auto ratio = hn::Floor(hn::Div(dividend, hn::Max(size, hn::Set(d, 1))));
    const auto high = hn::Floor(hn::Mul(ratio, hn::Set(d, 1.0 / 65536)));
    const auto low = hn::NegMulAdd(high, hn::Set(d, 65536), ratio);
    // numerator * ratio = a * 2^16 + b, divided by 2^(shift + 8) and rounded down.
    const auto a = hn::Mul(numerator, high);
    const auto b = hn::Mul(numerator, low);
    const auto b_high = hn::Floor(hn::Mul(b, hn::Set(d, 1.0 / 65536)));
    const auto whole = hn::Add(a, b_high);  // of 2^16, below 2^40
    const auto b_low = hn::NegMulAdd(b_high, hn::Set(d, 65536), b);
    hn::Vec<F64> depth;
    if (shift + 8 >= 16) {
      depth = hn::Floor(hn::Mul(whole, hn::Set(d, scale * 65536)));
    } else {
      depth = hn::Floor(hn::MulAdd(whole, hn::Set(d, scale * 65536), hn::Mul(b_low, hn::Set(d, scale))));
    }
    depth = hn::IfThenElse(hn::Gt(hn::Min(numerator, dividend), zero), hn::Min(depth, most), zero);
    hn::StoreU(hn::DemoteTo(d32, depth), d32, depths_q8 + at);
  }
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
HWY_EXPORT(find_rectangles);
HWY_EXPORT(resolve_word);
HWY_EXPORT(find_depths);
HWY_EXPORT(instruction_set);

void draw_run(const Frame& frame, const Run& run, const Depths& depths, Counts* counts) {
  HWY_DYNAMIC_DISPATCH(draw_run)(frame, run, depths, counts);
}
void find_rectangles(const Frame& frame, const float* x, const float* y, const float* z, float side,
                     Rectangle* rectangles) {
  HWY_DYNAMIC_DISPATCH(find_rectangles)(frame, x, y, z, side, rectangles);
}
void resolve_word(const Frame& frame, int32_t y, int32_t word, const uint64_t* nearest, const int32_t* levels,
                  WordHits* hits) {
  HWY_DYNAMIC_DISPATCH(resolve_word)(frame, y, word, nearest, levels, hits);
}
void find_depths(const WordHits& hits, int32_t depth_per_t_q8, int32_t* depths_q8) {
  HWY_DYNAMIC_DISPATCH(find_depths)(hits, depth_per_t_q8, depths_q8);
}
const char* instruction_set() {
  return HWY_DYNAMIC_DISPATCH(instruction_set)();
}

}  // namespace thimble::wide
#endif
