/// The state of rays under way, one in each lane, and the queue from which lanes are filled.
#if defined(THIMBLE_WIDE_RAYS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RAYS_LANES_INL_H_
#undef THIMBLE_WIDE_RAYS_LANES_INL_H_
#else
#define THIMBLE_WIDE_RAYS_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>

#include "wide/rays/job.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F64 = hn::CappedTag<double, 8>;
using U64 = hn::RebindToUnsigned<F64>;
using I64 = hn::RebindToSigned<F64>;
using I32 = hn::Rebind<int32_t, F64>;
using VF = hn::Vec<F64>;
using VU = hn::Vec<U64>;
using MF = hn::Mask<F64>;
using MU = hn::Mask<U64>;

constexpr size_t kLanes = hn::MaxLanes(F64());

// A coordinate c of the mirrored world, 0 <= c < 2^20, is held as the double 2^20 + c. Its bits are then a fixed-point
// number: 32 bits of fraction, and above them the cell. A sum is rounded to these 32 bits, which makes a number that is
// whole but for an error whole again (../README.md).
constexpr double kBias = 1048576.0;
constexpr int kFraction = 32;
// In place of 1/0: planes that are never crossed.
constexpr double kNever = 0x1p60;

// The numbers of a ray. Doubles first, then words.
enum Column : size_t {
  kOriginX,  // mirrored and biased
  kOriginY,
  kOriginZ,
  kDirectionX,  // >= 0
  kDirectionY,
  kDirectionZ,
  kInverseX,
  kInverseY,
  kInverseZ,
  kPlaceX,  // where the ray is, biased
  kPlaceY,
  kPlaceZ,
  kEnd,  // the t from which on nothing counts
  kDoubles,
  kTopFlip = kDoubles,  // xor with a mirrored cube's index gives the unmirrored one
  kCellFlip,            // low 6 bits: the same for a leaf or voxel; from bit 32 on: the ray's number
  kOctant,              // 4 times the octant
  kColumns,
};

// Rays under way.
struct Lanes {
  alignas(64) double doubles[kDoubles][kLanes];
  alignas(64) uint64_t words[kColumns - kDoubles][kLanes];
  alignas(64) uint64_t visits[kLanes];
  uint32_t alive;  // a bit a lane
};

// Rays that wait: those from `next` to `count`.
struct Queue {
  static constexpr size_t kSize = 128;
  static constexpr size_t kRoom = kSize + 8;
  size_t next = 0;
  size_t count = 0;
  alignas(64) double doubles[kDoubles][kRoom];
  alignas(64) uint64_t words[kColumns - kDoubles][kRoom];
};

template <class D>
HWY_INLINE uint32_t lane_bits(D d, hn::Mask<D> mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return uint32_t{bytes[0]};
}

#if HWY_TARGET == HWY_AVX2
// Where the halves of doubles go when the lanes of a mask move to the front, and when they move back.
struct MoveTable {
  uint32_t pack[16][8];
  uint32_t spread[16][8];
  constexpr MoveTable() : pack{}, spread{} {
    for (uint32_t mask = 0; mask < 16; ++mask) {
      uint32_t front = 0;
      for (uint32_t lane = 0; lane < 4; ++lane) {
        if ((mask >> lane & 1U) != 0) {
          pack[mask][2 * front] = 2 * lane;
          pack[mask][2 * front + 1] = 2 * lane + 1;
          spread[mask][2 * lane] = 2 * front;
          spread[mask][2 * lane + 1] = 2 * front + 1;
          ++front;
        }
      }
    }
  }
};
alignas(64) constexpr MoveTable kMoves;
#endif

// Moves the lanes in `mask` (`bits`) to the front. Highway 1.0's Compress copies a table onto the stack.
HWY_INLINE VF pack(VF v, [[maybe_unused]] MF mask, [[maybe_unused]] uint32_t bits) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return VF{_mm512_maskz_compress_pd(mask.raw, v.raw)};
#elif HWY_TARGET == HWY_AVX2
  const hn::Repartition<uint32_t, F64> d;
  const auto moved = _mm256_permutevar8x32_epi32(hn::BitCast(d, v).raw, hn::LoadU(d, kMoves.pack[bits]).raw);
  return hn::BitCast(F64(), hn::Vec<decltype(d)>{moved});
#else
  const F64 d;
  HWY_ALIGN double packed[kLanes];
  hn::Store(v, d, packed);
  for (size_t lane = 0, next = 0; lane < hn::Lanes(d); ++lane) {
    packed[next] = packed[lane];
    next += bits >> lane & 1U;
  }
  return hn::Load(d, packed);
#endif
}

// Puts the front lanes of `from` into those of `old` that are in `mask` (`bits`).
HWY_INLINE VF fill_lanes(VF old, VF from, [[maybe_unused]] MF mask, [[maybe_unused]] uint32_t bits) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return VF{_mm512_mask_expand_pd(old.raw, mask.raw, from.raw)};
#elif HWY_TARGET == HWY_AVX2
  const hn::Repartition<uint32_t, F64> d;
  const auto moved =
      _mm256_permutevar8x32_epi32(hn::BitCast(d, from).raw, hn::LoadU(d, kMoves.spread[bits]).raw);
  return hn::IfThenElse(mask, hn::BitCast(F64(), hn::Vec<decltype(d)>{moved}), old);
#else
  const F64 d;
  HWY_ALIGN double moved[kLanes];
  HWY_ALIGN double front[kLanes];
  hn::Store(old, d, moved);
  hn::Store(from, d, front);
  for (size_t lane = 0, next = 0; lane < hn::Lanes(d); ++lane) {
    if ((bits >> lane & 1U) != 0) {
      moved[lane] = front[next++];
    }
  }
  return hn::Load(d, moved);
#endif
}

// Fills the lanes of `empty` from the queue, as far as it reaches.
HWY_INLINE void refill(Lanes* lanes, uint32_t empty, Queue* queue) {
  const F64 d;
  const U64 du;
  const size_t left = queue->count - queue->next;
  uint32_t bits = empty;
  size_t wanted = static_cast<size_t>(__builtin_popcount(bits));
  for (; wanted > left; --wanted) {
    bits &= bits - 1;
  }
  if (bits == 0) {
    return;
  }
  const uint8_t bytes[8] = {static_cast<uint8_t>(bits)};
  const MF mask = hn::LoadMaskBits(d, bytes);
  const MU mask_u = hn::LoadMaskBits(du, bytes);
  for (size_t column = 0; column < kDoubles; ++column) {
    double* to = lanes->doubles[column];
    hn::Store(fill_lanes(hn::Load(d, to), hn::LoadU(d, queue->doubles[column] + queue->next), mask, bits), d,
              to);
  }
  for (size_t column = 0; column < kColumns - kDoubles; ++column) {
    uint64_t* to = lanes->words[column];
    const VF old = hn::BitCast(d, hn::Load(du, to));
    const VF from = hn::BitCast(d, hn::LoadU(du, queue->words[column] + queue->next));
    hn::Store(hn::BitCast(du, fill_lanes(old, from, mask, bits)), du, to);
  }
  hn::Store(hn::IfThenZeroElse(mask_u, hn::Load(du, lanes->visits)), du, lanes->visits);
  queue->next += wanted;
  lanes->alive |= bits;
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
