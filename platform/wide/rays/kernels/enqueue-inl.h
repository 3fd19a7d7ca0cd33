/// The state of rays under way, one in each lane, and the queue from which lanes are filled: how rays as they are given become
/// its columns, mirrored, clipped to the occupied box, biased.
#if defined(THIMBLE_WIDE_RAYS_ENQUEUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RAYS_ENQUEUE_INL_H_
#undef THIMBLE_WIDE_RAYS_ENQUEUE_INL_H_
#else
#define THIMBLE_WIDE_RAYS_ENQUEUE_INL_H_
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
  kOrigin = 0,     // three, by axis, mirrored and biased
  kPlace = 3,      // three: where the ray is, biased
  kEnd = 6,        // the t from which on nothing counts
  kDirection = 7,  // three, >= 0
  kInverse = 10,
  kDoubles = 13,
  kCellFlip =
      kDoubles,  // low 6 bits: xor with a leaf's or voxel's index, mirrored or not, gives the other; from bit 32 on:
                 // the ray's number
  kTopFlip,  // the same for a cube
  kOctant,   // 4 times the octant
  kColumns,
};

// What all rays of a job have in common.
enum class Alike : uint8_t { kNothing, kOctant, kDirection };

// How many columns differ from ray to ray: the others are set once.
constexpr size_t own_doubles(Alike alike) {
  return alike == Alike::kDirection ? size_t{kDirection} : size_t{kDoubles};
}
constexpr size_t own_words(Alike alike) {
  return alike == Alike::kNothing ? kColumns - kDoubles : kTopFlip - kDoubles;
}

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
template <Alike kAlike>
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
  for (size_t column = 0; column < own_doubles(kAlike); ++column) {
    double* to = lanes->doubles[column];
    hn::Store(fill_lanes(hn::Load(d, to), hn::LoadU(d, queue->doubles[column] + queue->next), mask, bits), d,
              to);
  }
  for (size_t column = 0; column < own_words(kAlike); ++column) {
    uint64_t* to = lanes->words[column];
    const VF old = hn::BitCast(d, hn::Load(du, to));
    const VF from = hn::BitCast(d, hn::LoadU(du, queue->words[column] + queue->next));
    hn::Store(hn::BitCast(du, fill_lanes(old, from, mask, bits)), du, to);
  }
  hn::Store(hn::IfThenZeroElse(mask_u, hn::Load(du, lanes->visits)), du, lanes->visits);
  queue->next += wanted;
  lanes->alive |= bits;
}

// A t is off by at most 2^-52 of itself, and the t of two planes differ by at least 2^-43 of it. So kJustBefore moves
// an end before every crossing at that t but not before earlier ones; kJustAfter moves a bound, which may be any
// fraction, behind all crossings below it.
constexpr double kJustBefore = 1.0 - 0x1p-46;
constexpr double kJustAfter = 1.0 + 0x1p-46;
// The greatest numerator of a plane's t.
constexpr double kMostNumerator = 8388608.0;

// Where new rays go, one in each lane.
struct Ways {
  MF down[3];
  VF direction[3];  // >= 0
  VF inverse[3];
  VU top_flip;
  VU cell_flip;
  VU octant;
  MF taken;  // rays that the vectors take
};

// A group of new rays, one in each lane.
struct NewRays {
  Ways ways;
  VF origin[3];  // biased
  VF begin;
  VF end;
  MF inside;  // rays that come to the occupied box
};

// Where the numbers of each lane's ray, or point, begin; lanes behind the last ray repeat it.
struct Rows {
  const int32_t* of[kLanes];
  Rows(const int32_t* first, size_t stride, size_t count) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      of[lane] = first + stride * std::min(lane, count - 1);
    }
  }
};

HWY_INLINE VF load_column(const Rows& rows, size_t column) {
  const auto* const* of = rows.of;
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return VF{_mm512_cvtepi32_pd(_mm256_set_epi32(of[7][column], of[6][column], of[5][column], of[4][column],
                                                of[3][column], of[2][column], of[1][column], of[0][column]))};
#elif HWY_TARGET == HWY_AVX2
  return VF{_mm256_cvtepi32_pd(_mm_set_epi32(of[3][column], of[2][column], of[1][column], of[0][column]))};
#else
  const I32 d;
  HWY_ALIGN int32_t numbers[kLanes];
  for (size_t lane = 0; lane < kLanes; ++lane) {
    numbers[lane] = of[lane][column];
  }
  return hn::PromoteTo(F64(), hn::Load(d, numbers));
#endif
}

// The first `kCount` of the six numbers of up to kLanes rays, one ray in each lane.
template <size_t kCount>
struct RayColumns {
  VF of[kCount];
  RayColumns(const Ray* rays, size_t count) {
    const Rows rows(reinterpret_cast<const int32_t*>(rays), 6, count);
    for (size_t column = 0; column < kCount; ++column) {
      of[column] = load_column(rows, column);
    }
  }
};

HWY_INLINE VF whole_number(int64_t number) {
  return hn::Set(F64(), static_cast<double>(number));
}

// Mirrors the rays' directions.
HWY_INLINE Ways ways_of(const Job& job, const VF* directions) {
  const F64 d;
  const U64 du;
  const int bits = job.map->cells()->level - 4;
  Ways ways;
  ways.top_flip = ways.cell_flip = ways.octant = hn::Zero(du);
  VF sum = hn::Zero(d);
  VF most = sum;
  for (int axis = 0; axis < 3; ++axis) {
    ways.down[axis] = hn::Lt(directions[axis], hn::Zero(d));
    const VF direction = hn::Abs(directions[axis]);
    sum = hn::Add(sum, direction);
    most = hn::Max(most, direction);
    ways.direction[axis] = direction;
    ways.inverse[axis] = hn::IfThenElse(hn::Eq(direction, hn::Zero(d)), hn::Set(d, kNever),
                                        hn::Div(hn::Set(d, 1.0), direction));
    const MU down = hn::RebindMask(du, ways.down[axis]);
    const auto flip = [&](uint64_t mask) { return hn::IfThenElseZero(down, hn::Set(du, mask)); };
    ways.top_flip = hn::Or(ways.top_flip, flip(((uint64_t{1} << bits) - 1) << (bits * axis)));
    ways.cell_flip = hn::Or(ways.cell_flip, flip(uint64_t{3} << (2 * axis)));
    ways.octant = hn::Or(ways.octant, flip(uint64_t{4} << axis));
  }
  ways.taken = hn::And(hn::Gt(sum, hn::Zero(d)), hn::Le(most, whole_number(kMaxDirection)));
  return ways;
}

// Adds one axis: the mirrored origin, and the planes of the occupied box.
HWY_INLINE void add_axis(const Job& job, int axis, VF origin, NewRays* rays, VF* low, VF* high) {
  const F64 d;
  Ways& ways = rays->ways;
  const int level = job.map->tree().level();
  const VoxelBox& box = job.map->tree().bounds();
  ways.taken =
      hn::And(ways.taken, hn::And(hn::Ge(origin, whole_number(kMinOriginWorlds * (Q8::kOne << level))),
                                  hn::Le(origin, whole_number(kMaxOriginWorlds * (Q8::kOne << level)))));
  const MF down = ways.down[axis];
  const int32_t side = int32_t{1} << job.map->cells()->level;
  origin = hn::IfThenElse(down, hn::Sub(whole_number(side * Q8::kOne), origin), origin);
  origin = hn::Add(hn::Mul(origin, hn::Set(d, 1.0 / Q8::kOne)), hn::Set(d, kBias));
  rays->origin[axis] = origin;
  const auto biased = [&](int32_t whole) { return hn::Set(d, kBias + whole); };
  *low = hn::IfThenElse(down, biased(side - box.high[axis]), biased(box.low[axis]));
  *high = hn::IfThenElse(down, biased(side - box.low[axis]), biased(box.high[axis]));
  rays->begin = hn::Max(rays->begin, hn::Mul(hn::Sub(*low, origin), ways.inverse[axis]));
  rays->end = hn::Min(rays->end, hn::Mul(hn::Sub(*high, origin), ways.inverse[axis]));
}

// Adds the points at which rays begin or end.
HWY_INLINE void add_bound(const Job& job, size_t first, size_t count, NewRays* rays) {
  static_assert(sizeof(RayPoint) == 8 && offsetof(RayPoint, t_denominator) == 4);
  const F64 d;
  const auto* const points = reinterpret_cast<const int32_t*>(job.points + first * job.point_step);
  const Rows rows(points, 2 * job.point_step, count);
  const VF numerator = load_column(rows, 0);
  const VF denominator = load_column(rows, 1);
  if (job.bound == Bound::kBefore) {
    const VF t = hn::Div(numerator, denominator);
    rays->end = hn::Min(rays->end, hn::Mul(t, hn::Set(d, kJustAfter)));
    return;
  }
  // The denominator is 256 times a component, of which the core takes the whole part.
  const VF divisor = hn::Floor(hn::Mul(denominator, hn::Set(d, 1.0 / 256)));
  const VF zero = hn::Zero(d);
  const MF at_start = hn::Or(hn::Le(numerator, zero), hn::Le(divisor, zero));
  const VF t = hn::Div(numerator, hn::Mul(divisor, hn::Set(d, 256.0)));
  const VF from = hn::IfThenElse(at_start, zero, t);
  rays->begin = hn::Max(rays->begin, from);
  // The proof holds only for points on a plane of one of the three axes.
  const MF of_plane =
      hn::Or(hn::Eq(divisor, rays->ways.direction[0]),
             hn::Or(hn::Eq(divisor, rays->ways.direction[1]), hn::Eq(divisor, rays->ways.direction[2])));
  const MF known = hn::And(of_plane, hn::Le(numerator, hn::Set(d, kMostNumerator)));
  rays->ways.taken = hn::And(rays->ways.taken, hn::Or(at_start, known));
}

// `shared` is for rays of one direction.
template <Alike kAlike>
HWY_INLINE NewRays load_rays(const Job& job, size_t first, size_t count, const Ways& shared, VF (&place)[3]) {
  static_assert(sizeof(Ray) == 24 && offsetof(Ray, direction) == 12);
  const F64 d;
  constexpr bool kShared = kAlike == Alike::kDirection;
  const RayColumns<kShared ? 3 : 6> numbers(job.rays + first, count);
  NewRays rays;
  if constexpr (kShared) {
    rays.ways = shared;
  } else {
    rays.ways = ways_of(job, numbers.of + 3);
  }
  rays.ways.taken = hn::And(rays.ways.taken, hn::FirstN(d, count));
  rays.begin = hn::Zero(d);
  rays.end = hn::Set(d, 1e300);
  VF low[3];
  VF high[3];
  for (int axis = 0; axis < 3; ++axis) {
    add_axis(job, axis, numbers.of[axis], &rays, &low[axis], &high[axis]);
  }
  rays.end = hn::Mul(rays.end, hn::Set(d, kJustBefore));
  if (job.bound != Bound::kNone) {
    add_bound(job, first, count, &rays);
  }
  rays.inside = hn::And(rays.ways.taken, hn::Lt(rays.begin, rays.end));
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] = hn::MulAdd(rays.begin, rays.ways.direction[axis], rays.origin[axis]);
    rays.inside =
        hn::And(rays.inside, hn::And(hn::Ge(place[axis], low[axis]), hn::Lt(place[axis], high[axis])));
  }
  return rays;
}

// Puts up to kLanes rays, from number `first` on, into the queue. Leaves out rays that never come to anything; the core
// traces those that are beyond the limits.
template <Alike kAlike>
HWY_INLINE void enqueue(Job* job, size_t first, size_t count, const Ways& shared, Queue* queue) {
  const F64 d;
  const U64 du;
  VF place[3];
  const NewRays rays = load_rays<kAlike>(*job, first, count, shared, place);
  const uint32_t all = (1U << count) - 1;
  for (uint32_t rest = all & ~lane_bits(d, rays.ways.taken); rest != 0; rest &= rest - 1) {
    trace_by_core(job, first + static_cast<unsigned>(__builtin_ctz(rest)));
  }
  const uint32_t bits = lane_bits(d, rays.inside);
  if (bits == 0) {
    return;
  }
  const size_t at = queue->count;
  const auto put = [&](Column column, VF v) {
    hn::StoreU(pack(v, rays.inside, bits), d, queue->doubles[column] + at);
  };
  const auto put_word = [&](Column column, VU v) {
    hn::StoreU(hn::BitCast(du, pack(hn::BitCast(d, v), rays.inside, bits)), du,
               queue->words[column - kDoubles] + at);
  };
  for (size_t axis = 0; axis < 3; ++axis) {
    put(static_cast<Column>(kOrigin + axis), rays.origin[axis]);
    put(static_cast<Column>(kPlace + axis), place[axis]);
    if constexpr (kAlike != Alike::kDirection) {
      put(static_cast<Column>(kDirection + axis), rays.ways.direction[axis]);
      put(static_cast<Column>(kInverse + axis), rays.ways.inverse[axis]);
    }
  }
  put(kEnd, rays.end);
  const VU numbers = hn::ShiftLeft<32>(hn::Iota(du, first));
  put_word(kCellFlip, hn::Or(rays.ways.cell_flip, numbers));
  if constexpr (kAlike == Alike::kNothing) {
    put_word(kTopFlip, rays.ways.top_flip);
    put_word(kOctant, rays.ways.octant);
  }
  queue->count += static_cast<size_t>(__builtin_popcount(bits));
}

// Fills the queue from the job's rays; `*next` is the first ray that is not taken yet.
template <Alike kAlike>
inline void fill_queue(Job* job, const Ways& shared, size_t* next, Queue* queue) {
  const size_t left = queue->count - queue->next;  // less than a vector
  for (size_t column = 0; column < own_doubles(kAlike); ++column) {
    std::copy_n(queue->doubles[column] + queue->next, left, queue->doubles[column]);
  }
  for (size_t column = 0; column < own_words(kAlike); ++column) {
    std::copy_n(queue->words[column] + queue->next, left, queue->words[column]);
  }
  queue->next = 0;
  queue->count = left;
  const size_t lanes = hn::Lanes(F64());
  while (*next < job->count && queue->count + lanes <= Queue::kSize) {
    const size_t count = std::min(lanes, job->count - *next);
    enqueue<kAlike>(job, *next, count, shared, queue);
    *next += count;
  }
}

// The least and greatest components of the rays' directions.
struct Spread {
  Vec3i low;
  Vec3i high;
  explicit Spread(const Job& job) : low(job.rays[0].direction), high(low) {
    for (size_t i = 1; i < job.count; ++i) {
      const Vec3i& direction = job.rays[i].direction;
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], direction[axis]);
        high[axis] = std::max(high[axis], direction[axis]);
      }
    }
  }
  Alike alike() const {
    if (low == high) {
      return Alike::kDirection;
    }
    bool is_one_octant = true;
    for (int axis = 0; axis < 3; ++axis) {
      is_one_octant = is_one_octant && (low[axis] < 0) == (high[axis] < 0);
    }
    return is_one_octant ? Alike::kOctant : Alike::kNothing;
  }
};

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
