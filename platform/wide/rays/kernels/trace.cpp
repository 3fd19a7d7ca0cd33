// Traces rays through the map, one in each lane. ../README.md derives why doubles find every cell.
#include "wide/rays/job.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/rays/kernels/trace.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "wide/rays/kernels/enqueue-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// The cells of a cube of 4^3 cells that a ray can still come to, its own among them, by octant and cell. `on_axis` has
// the part of each axis, by direction (4: down) and coordinate.
struct AheadTable {
  alignas(64) uint64_t on_axis[3][8];
  uint64_t of[8 * 64];
  constexpr AheadTable() : on_axis{}, of{} {
    for (unsigned axis = 0; axis < 3; ++axis) {
      for (unsigned from = 0; from < 8; ++from) {
        for (unsigned to = 0; to < 64; ++to) {
          const unsigned cell = to >> (2 * axis) & 3U;
          const bool ahead = from < 4 ? cell >= from : cell <= from - 4;
          on_axis[axis][from] |= uint64_t{ahead} << to;
        }
      }
    }
    for (unsigned octant = 0; octant < 8; ++octant) {
      for (unsigned from = 0; from < 64; ++from) {
        of[octant * 64 + from] = on_axis[0][(octant << 2 & 4U) | (from & 3U)] &
                                 on_axis[1][(octant << 1 & 4U) | (from >> 2 & 3U)] &
                                 on_axis[2][(octant & 4U) | from >> 4];
      }
    }
  }
};
alignas(64) constexpr AheadTable kAhead;

// The cells of a cube of 4^3 cells that rays whose directions lie in a range of one octant can still come to, by their own
// cell.
struct AheadOfRays {
  alignas(64) uint64_t of[64];
  explicit AheadOfRays(const Spread& spread);
};

// A ray is d cells farther on an axis from (d - 1) to (d + 1) times the inverse of its speed on, wherever it begins in its
// cell. So it comes to a cell only where what the three axes say has a t in common.
AheadOfRays::AheadOfRays(const Spread& spread) : of{} {
  double from[3][4];
  double to[3][4];
  unsigned flip = 0;
  unsigned octant = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const bool down = spread.low[axis] < 0;
    flip |= down ? 3U << (2 * axis) : 0;
    octant |= down ? 1U << axis : 0;
    const double slowest = std::abs(static_cast<double>(down ? spread.high[axis] : spread.low[axis]));
    const double fastest = std::abs(static_cast<double>(down ? spread.low[axis] : spread.high[axis]));
    for (int way = 0; way < 4; ++way) {
      from[axis][way] = way < 2 ? 0 : fastest == 0 ? kNever : (way - 1) / fastest * kJustBefore;
      to[axis][way] = slowest == 0 ? kNever : (way + 1) / slowest;
    }
  }
  uint64_t cells = 0;  // for the cell where all of the cube lies ahead
  for (unsigned cell = 0; cell < 64; ++cell) {
    const unsigned ways[3] = {cell & 3U, cell >> 2 & 3U, cell >> 4};
    double latest = 0;
    double earliest = kNever;
    for (int axis = 0; axis < 3; ++axis) {
      latest = std::max(latest, from[axis][ways[axis]]);
      earliest = std::min(earliest, to[axis][ways[axis]]);
    }
    cells |= uint64_t{latest <= earliest} << (cell ^ flip);
  }
  // What a shift takes into another row is not ahead.
  for (unsigned cell = 0; cell < 64; ++cell) {
    of[cell] =
        (cell >= flip ? cells << (cell - flip) : cells >> (flip - cell)) & kAhead.of[octant * 64 + cell];
  }
}

// Bits of a fixed-point coordinate below a voxel, a leaf and a cube.
constexpr int kVoxel = kFraction;
constexpr int kLeaf = kFraction + 2;
constexpr int kCube = kFraction + 4;

// What all steps share.
struct View {
  const uint32_t* top;
  const uint64_t* chunks;
  uint64_t header;          // words of a chunk before its leaves
  int bits;                 // bits of a cube's index on each axis
  const uint64_t* of_rays;  // of AheadOfRays
};

// Makes lanes of the words load(0), load(1), ... A gather of x86 takes several times as many micro-operations.
template <class Load>
HWY_INLINE VU load_lanes(const Load& load) {
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  return VU{_mm512_set_epi64(load(7), load(6), load(5), load(4), load(3), load(2), load(1), load(0))};
#elif HWY_TARGET == HWY_AVX2
  return VU{_mm256_set_epi64x(load(3), load(2), load(1), load(0))};
#else
  const U64 d;
  HWY_ALIGN uint64_t words[kLanes];
  for (size_t lane = 0; lane < kLanes; ++lane) {
    words[lane] = static_cast<uint64_t>(load(lane));
  }
  return hn::Load(d, words);
#endif
}

// Loads from[index], or from[0] where the mask is not set.
HWY_INLINE VU gather(const uint64_t* from, VU index, MU mask) {
  const U64 d;
  alignas(64) uint64_t at[kLanes];
  hn::Store(hn::IfThenElseZero(mask, index), d, at);
  return hn::IfThenElseZero(mask,
                            load_lanes([&](size_t lane) { return static_cast<long long>(from[at[lane]]); }));
}

// Loads from[index] into the low half of each lane.
HWY_INLINE VU gather_low(const uint32_t* from, VU index) {
  const U64 d;
  alignas(64) uint64_t at[kLanes];
  hn::Store(index, d, at);
  return load_lanes([&](size_t lane) { return static_cast<long long>(from[at[lane]]); });
}

// The number of a cell of 2^level voxels in its cube of 4^3 cells.
template <int kLevel>
HWY_INLINE VU cell_index(const VU (&place)[3], VU flip) {
  const U64 d;
  constexpr int kShift = kFraction + kLevel;
  const VU index = hn::Or(hn::And(hn::ShiftRight<kShift>(place[0]), hn::Set(d, 3)),
                          hn::Or(hn::And(hn::ShiftRight<kShift - 2>(place[1]), hn::Set(d, 12)),
                                 hn::And(hn::ShiftRight<kShift - 4>(place[2]), hn::Set(d, 48))));
  return hn::And(hn::Xor(index, flip), hn::Set(d, 63));
}

// The cells of a cube of 4^3 that a ray in `cell` can still come to.
template <Alike kAlike>
HWY_INLINE VU cells_ahead(VU cell, [[maybe_unused]] VU octant, const uint64_t* of_rays) {
  const U64 d;
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  if constexpr (kAlike != Alike::kNothing) {
    const auto among_16 = [&](size_t first) {
      const VU low = hn::Load(d, of_rays + first);
      const VU high = hn::Load(d, of_rays + first + 8);
      return VU{_mm512_permutex2var_epi64(low.raw, cell.raw, high.raw)};
    };
    const MU odd = hn::TestBit(cell, hn::Set(d, 16));
    const VU low = hn::IfThenElse(odd, among_16(16), among_16(0));
    const VU high = hn::IfThenElse(odd, among_16(48), among_16(32));
    return hn::IfThenElse(hn::TestBit(cell, hn::Set(d, 32)), high, low);
  }
  const VU way = hn::Set(d, 4);
  const VU x = hn::Or(hn::And(cell, hn::Set(d, 3)), hn::And(octant, way));
  const VU y =
      hn::Or(hn::And(hn::ShiftRight<2>(cell), hn::Set(d, 3)), hn::And(hn::ShiftRight<1>(octant), way));
  const VU z = hn::Or(hn::ShiftRight<4>(cell), hn::And(hn::ShiftRight<2>(octant), way));
  const auto look_up = [&](const uint64_t(&of)[8], VU index) {
    return VU{_mm512_permutexvar_epi64(index.raw, hn::Load(d, of).raw)};
  };
  return hn::And(look_up(kAhead.on_axis[0], x),
                 hn::And(look_up(kAhead.on_axis[1], y), look_up(kAhead.on_axis[2], z)));
#else
  if constexpr (kAlike != Alike::kNothing) {
    return hn::GatherIndex(d, of_rays, hn::BitCast(I64(), cell));
  }
  return hn::GatherIndex(d, kAhead.of, hn::BitCast(I64(), hn::Or(hn::ShiftLeft<4>(octant), cell)));
#endif
}

// What a group of lanes finds at their places. That takes three steps, each of which waits for words from memory, so
// all groups take one step before any takes the next.
struct Sight {
  VU place[3];
  VU word;  // the cube's word
  MU is_chunk;
  VU chunk;   // where the chunk begins
  VU mask;    // the chunk's leaves
  VU unit;    // the unit of a step: 4 voxels, or 16 where no other leaf of the chunk lies ahead
  VU voxels;  // the leaf's voxels
};

HWY_INLINE void see_cube(const View& view, const Lanes& lanes, Sight* sight) {
  const F64 d;
  const U64 du;
  VU(&place)[3] = sight->place;
  for (size_t axis = 0; axis < 3; ++axis) {
    place[axis] = hn::BitCast(du, hn::Load(d, lanes.doubles[kPlace + axis]));
  }
  const uint64_t within = (uint64_t{1} << view.bits) - 1;
  const VU x = hn::And(hn::ShiftRight<kCube>(place[0]), hn::Set(du, within));
  const VU y = hn::And(hn::ShiftRightSame(place[1], kCube - view.bits), hn::Set(du, within << view.bits));
  const VU z =
      hn::And(hn::ShiftRightSame(place[2], kCube - 2 * view.bits), hn::Set(du, within << (2 * view.bits)));
  const VU cube = hn::Xor(hn::Or(x, hn::Or(y, z)), hn::Load(du, lanes.words[kTopFlip - kDoubles]));
  sight->word = gather_low(view.top, cube);
}

HWY_INLINE void see_chunk(const View& view, Sight* sight) {
  const U64 d;
  sight->is_chunk = hn::Eq(hn::And(sight->word, hn::Set(d, 15)), hn::Zero(d));
  sight->chunk = hn::And(hn::ShiftRight<4>(sight->word), hn::Set(d, (1U << 28) - 1));
  sight->mask = gather(view.chunks, sight->chunk, sight->is_chunk);
}

template <Alike kAlike>
HWY_INLINE void see_leaf(const View& view, const Lanes& lanes, Sight* sight) {
  const U64 d;
  const VU one = hn::Set(d, 1);
  const VU mask = sight->mask;
  const VU leaf = cell_index<2>(sight->place, hn::Load(d, lanes.words[kCellFlip - kDoubles]));
  const VU leaf_bit = hn::Shl(one, leaf);
  const MU in_leaf = hn::TestBit(mask, leaf_bit);  // an empty cube's mask is 0
  // Leaves stand in the order of their bits. Bits are counted lane by lane: few instruction sets do it in vectors.
  alignas(64) uint64_t at[kLanes];
  alignas(64) uint64_t before[kLanes];
  hn::Store(hn::IfThenElseZero(in_leaf, hn::Add(sight->chunk, hn::Set(d, view.header))), d, at);
  hn::Store(hn::And(mask, hn::Sub(leaf_bit, one)), d, before);
  sight->voxels = hn::IfThenElseZero(in_leaf, load_lanes([&](size_t lane) {
                                       const auto leaves =
                                           static_cast<unsigned>(__builtin_popcountll(before[lane]));
                                       return static_cast<long long>(view.chunks[at[lane] + leaves]);
                                     }));
  const VU octant = hn::Load(d, lanes.words[kOctant - kDoubles]);
  const VU ahead = hn::And(mask, cells_ahead<kAlike>(leaf, octant, view.of_rays));
  // Whether no other leaf lies ahead than the one that the ray is in (which may be empty ahead, too).
  const MU is_last = hn::Eq(hn::AndNot(leaf_bit, ahead), hn::Zero(d));
  sight->unit = hn::IfThenElse(is_last, hn::Set(d, uint64_t{1} << kCube), hn::Set(d, uint64_t{1} << kLeaf));
}

// The empty box ahead of each lane: its lower corner is the place rounded down to `grain`; `side` is its side. `solid`:
// the voxel is solid, so there is no box.
struct Box {
  VU grain;
  VU side;
  MU solid;
};

template <Alike kAlike>
HWY_INLINE Box see_voxel(const View& view, const Lanes& lanes, const Sight& sight) {
  const U64 d;
  const VU octant = hn::Load(d, lanes.words[kOctant - kDoubles]);
  const VU voxel = cell_index<0>(sight.place, hn::Load(d, lanes.words[kCellFlip - kDoubles]));
  const VU ahead = hn::And(sight.voxels, cells_ahead<kAlike>(voxel, octant, view.of_rays));
  const VU unit = hn::IfThenElse(hn::Eq(ahead, hn::Zero(d)), sight.unit, hn::Set(d, uint64_t{1} << kVoxel));
  const VU reach = hn::ShiftLeft<kCube>(hn::And(hn::Shr(sight.word, octant), hn::Set(d, 15)));
  Box box;
  box.solid = hn::TestBit(sight.voxels, hn::Shl(hn::Set(d, 1), voxel));
  box.grain = hn::IfThenElse(sight.is_chunk, unit, hn::Set(d, uint64_t{1} << kCube));
  box.side = hn::IfThenElse(sight.is_chunk, unit, reach);
  return box;
}

// Finds the t at which a ray leaves the box on one axis.
HWY_INLINE VF leaves_at(const Lanes& lanes, size_t axis, VU place, const Box& box) {
  const F64 d;
  const U64 du;
  const VU plane = hn::Add(hn::And(place, hn::Sub(hn::Zero(du), box.grain)), box.side);
  return hn::Mul(hn::Sub(hn::BitCast(d, plane), hn::Load(d, lanes.doubles[kOrigin + axis])),
                 hn::Load(d, lanes.doubles[kInverse + axis]));
}

HWY_INLINE void put_hits(Job* job, const Lanes& lanes, uint32_t hits) {
  const uint64_t* flips = lanes.words[kCellFlip - kDoubles];
  for (; hits != 0; hits &= hits - 1) {
    const unsigned lane = static_cast<unsigned>(__builtin_ctz(hits));
    const size_t number = flips[lane] >> 32;
    if (job->any != nullptr && job->classes == nullptr && job->bound != Bound::kBefore) {
      job->any[number] = 1;
      continue;
    }
    const auto cell = [&](size_t axis) {
      return static_cast<int32_t>(lanes.doubles[kPlace + axis][lane] - kBias);
    };
    put_hit(job, number, {cell(0), cell(1), cell(2)}, static_cast<uint32_t>(lanes.visits[lane]));
  }
}

HWY_INLINE void put_misses(Job* job, const Lanes& lanes, uint32_t misses) {
  const uint64_t* flips = lanes.words[kCellFlip - kDoubles];
  if (job->hits == nullptr) {
    return;
  }
  for (; misses != 0; misses &= misses - 1) {
    const unsigned lane = static_cast<unsigned>(__builtin_ctz(misses));
    job->hits[flips[lane] >> 32].visits = static_cast<uint32_t>(lanes.visits[lane]);
  }
}

// Takes each lane on by one box. Lanes that are done store their answers.
template <Alike kAlike>
HWY_INLINE void advance(Job* job, const View& view, const Sight& sight, Lanes* lanes) {
  const F64 d;
  const U64 du;
  hn::Store(hn::Add(hn::Load(du, lanes->visits), hn::Set(du, 1)), du, lanes->visits);
  const Box box = see_voxel<kAlike>(view, *lanes, sight);
  const VF t =
      hn::Min(leaves_at(*lanes, 0, sight.place[0], box),
              hn::Min(leaves_at(*lanes, 1, sight.place[1], box), leaves_at(*lanes, 2, sight.place[2], box)));
  const uint32_t hits = lane_bits(du, box.solid) & lanes->alive;
  const uint32_t out = lane_bits(d, hn::Ge(t, hn::Load(d, lanes->doubles[kEnd]))) & lanes->alive & ~hits;
  if ((hits | out) != 0) {
    put_hits(job, *lanes, hits);
    put_misses(job, *lanes, out);
    lanes->alive &= ~(hits | out);
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    hn::Store(hn::MulAdd(t, hn::Load(d, lanes->doubles[kDirection + axis]),
                         hn::Load(d, lanes->doubles[kOrigin + axis])),
              d, lanes->doubles[kPlace + axis]);
  }
}

// A group is filled again when so many of its lanes are idle: few, where that moves few columns.
constexpr int least_idle(Alike alike) {
  return kLanes < 8 || alike != Alike::kNothing ? 1 : 2;
}

// How many groups of lanes are under way at a time.
constexpr size_t kGroups = kLanes < 4 ? 4 : 32 / kLanes;

template <Alike kAlike>
void trace_alike(Job* job, const uint64_t* of_rays) {
  const F64 d;
  const U64 du;
  const MapCells& cells = *job->map->cells();
  const View view{cells.top, cells.chunks, cells.header(), cells.level - 4, of_rays};
  constexpr uint32_t kAll = static_cast<uint32_t>((uint64_t{1} << kLanes) - 1);
  Queue queue;
  Lanes groups[kGroups] = {};
  const Ways shared = ways_of(*job, RayColumns<6>(job->rays, 1).of + 3);
  for (Lanes& lanes : groups) {
    for (size_t axis = 0; axis < 3; ++axis) {
      hn::Store(shared.direction[axis], d, lanes.doubles[kDirection + axis]);
      hn::Store(shared.inverse[axis], d, lanes.doubles[kInverse + axis]);
    }
    hn::Store(shared.top_flip, du, lanes.words[kTopFlip - kDoubles]);
    hn::Store(shared.octant, du, lanes.words[kOctant - kDoubles]);
  }
  size_t next = 0;
  for (;;) {
    uint32_t alive = 0;
    for (Lanes& lanes : groups) {
      const uint32_t idle = kAll & ~lanes.alive;
      if (__builtin_popcount(idle) >= least_idle(kAlike) || lanes.alive == 0) {
        if (queue.count - queue.next < kLanes && next < job->count) {
          fill_queue<kAlike>(job, shared, &next, &queue);
        }
        refill<kAlike>(&lanes, idle, &queue);
      }
      alive |= lanes.alive;
    }
    if (alive == 0) {
      if (next >= job->count && queue.next == queue.count) {
        return;
      }
      continue;
    }
    Sight sights[kGroups];
    for (size_t group = 0; group < kGroups; ++group) {
      see_cube(view, groups[group], &sights[group]);
    }
    for (size_t group = 0; group < kGroups; ++group) {
      see_chunk(view, &sights[group]);
    }
    for (size_t group = 0; group < kGroups; ++group) {
      see_leaf<kAlike>(view, groups[group], &sights[group]);
    }
    for (size_t group = 0; group < kGroups; ++group) {
      advance<kAlike>(job, view, sights[group], &groups[group]);
    }
  }
}

void trace_job(Job* job) {
  const Spread spread(*job);
  const Alike alike = spread.alike();
  if (alike == Alike::kNothing) {
    trace_alike<Alike::kNothing>(job, nullptr);
    return;
  }
  const AheadOfRays ahead(spread);
  (alike == Alike::kOctant ? trace_alike<Alike::kOctant> : trace_alike<Alike::kDirection>)(job, ahead.of);
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thimble::wide {

THIMBLE_KERNEL(trace_job);

}  // namespace thimble::wide
#endif
