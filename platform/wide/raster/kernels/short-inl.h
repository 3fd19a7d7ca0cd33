/// Picks the voxels that have open pixels from a block of short entries, in lanes of 16 bits.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_SHORT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_SHORT_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_SHORT_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_SHORT_INL_H_
#endif

#include <math.h>

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/pick-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

using I16 = hn::ScalableTag<int16_t>;
using U16 = hn::RebindToUnsigned<I16>;

// Widens short entries; writes whole vectors.
void widen(const ShortEntries& from, uint32_t count, uint32_t* entries) {
  const U32 d;
  const hn::Rebind<uint16_t, U32> half;
  const auto cube = hn::Set(d, from.cube);
  for (uint32_t at = 0; at < count; at += static_cast<uint32_t>(hn::Lanes(d))) {
    const auto entry = hn::PromoteTo(d, hn::LoadU(half, from.entries + at));
    const auto x = hn::And(entry, hn::Set(d, 31U));
    const auto y = hn::ShiftLeft<5>(hn::And(entry, hn::Set(d, 31U << 5)));
    const auto z = hn::ShiftLeft<10>(hn::And(entry, hn::Set(d, 31U << 10)));
    hn::StoreU(hn::Or(hn::Or(cube, x), hn::Or(y, z)), d, entries + at);
  }
}

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128

// Cuts a number off to its lowest 16 bits.
HWY_INLINE int16_t low_bits(double value) {
  return static_cast<int16_t>(static_cast<int32_t>(value));
}

// Rounds the steps of a row of Linear. Returns the middle of the block by them.
HWY_INLINE float round_steps(const float (&row)[4], float one, const float (&center)[3], int16_t (&step)[3]) {
  float middle = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float rounded = __builtin_nearbyintf(row[axis] * (axis == 1 ? 1024 * one : one));
    step[axis] = static_cast<int16_t>(rounded);
    middle += rounded * center[axis];
  }
  // An entry is x + 32 y + 1024 z. It is multiplied whole, and shifted by 5 and by 10 bits: no bits are cut out.
  step[2] = low_bits(step[2] - 32 * step[1]);
  step[1] = low_bits(step[1] - 32 * step[0]);
  return middle;
}

// The distance from the block's middle to its farthest voxel on one axis, by a row of Linear.
HWY_INLINE float farthest_of(const float (&row)[4], float h) {
  return (__builtin_fabsf(row[0]) + 1024 * __builtin_fabsf(row[1]) + __builtin_fabsf(row[2])) * h;
}

// Finds the map of a block but for its place. Returns false where a voxel might cover more than one pixel, or the block
// more than half of what 16 bits hold.
//
// A step is off by half a unit, so three by 1.5 (h - 0.5); what is added to them by another half, in perspective once
// more by the unit that is cut off a product.
template <bool kPerspective>
HWY_INLINE bool find_short_map(const WideFrame& frame, const Run& run, int fraction, ShortMap* map) {
  constexpr float kBendOne = 65536;
  Linear linear;
  find_linear<kPerspective>(frame, run.block, run.side, run.place, &linear);
  if (!linear.is_sound) {
    return false;
  }
  const float one = static_cast<float>(1 << fraction);
  const float h = 0.5F * static_cast<float>(run.side);
  const float units = 1.5F * h;
  float center[3];  // of the block, in its cube of 32 a side
  for (int axis = 0; axis < 3; ++axis) {
    center[axis] = static_cast<float>(run.block[axis] & 31U) + h - 0.5F;
  }
  float bend = 0;
  if (kPerspective) {
    bend = farthest_of(linear.s, h);
    if (!(bend < 0.4F)) {
      return false;
    }
    map->bend_last = low_bits(-round_steps(linear.s, kBendOne, center, map->bend));
  }
  const auto find_axis = [&](const float(&row)[4], float wide, ShortMap::Axis* axis) {
    const float farthest = farthest_of(row, h);
    if (!(farthest * one < 30000)) {
      return false;
    }
    axis->middle = -round_steps(row, one, center, axis->step);
    const float error =
        kPerspective ? (units * (1 + bend) + 1) / one + farthest * units / kBendOne : units / one;
    const float reach = wide + 2 * error + 4 / one;
    axis->below = 0.5 * static_cast<double>(wide) + static_cast<double>(error);
    axis->least = static_cast<int16_t>(static_cast<int32_t>((1 - reach) * one) - 1);
    return reach < 1;
  };
  return find_axis(linear.x, linear.wide_x, &map->x) && find_axis(linear.y, linear.wide_y, &map->y);
}

// Moves the map of one axis to a block whose middle is seen at `place`.
template <bool kPerspective>
HWY_INLINE void move_short_map(float place, int32_t first_px, int fraction, ShortMap::Axis* axis) {
  const double one = 1 << fraction;
  const double first = first_px - OpenTable::kMargin;
  const double base = floor((static_cast<double>(place) - axis->below - first + 1) * one) - 1;
  axis->base = low_bits(base);
  axis->last = low_bits(floor((kPerspective ? 0 : base) + static_cast<double>(axis->middle)));
}

// The open pixels of up to 32 rows and columns.
class ShortTable {
 public:
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  HWY_INLINE explicit ShortTable(const OpenTable& table) {
    const U32 d;
    const auto low = hn::Load(d, table.words()).raw;
    const auto high = table.rows() == 16 ? _mm512_setzero_si512() : hn::Load(d, table.words() + 16).raw;
    const auto packed = [](__m512i a, __m512i b) {
      return _mm512_inserti64x4(_mm512_castsi256_si512(_mm512_cvtepi32_epi16(a)), _mm512_cvtepi32_epi16(b),
                                1);
    };
    left_ = packed(low, high);
    right_ = packed(_mm512_srli_epi32(low, 16), _mm512_srli_epi32(high, 16));
  }

  // Which of the lanes in `mask` have an open pixel, a bit each. kFraction 12: a table of 16 rows and columns, which x
  // and y do not exceed.
  template <int kFraction>
  HWY_INLINE uint32_t open_of(hn::Mask<I16> mask, hn::Vec<U16> x, hn::Vec<U16> y) const {
    const I16 d;
    const U16 du;
    auto row = hn::Vec<U16>{_mm512_permutexvar_epi16(y.raw, left_)};
    if (kFraction == 11) {
      const auto is_right = hn::TestBit(x, hn::Set(du, 16));
      row = hn::IfThenElse(is_right, hn::Vec<U16>{_mm512_permutexvar_epi16(y.raw, right_)}, row);
      x = hn::And(x, hn::Set(du, 15));
    }
    const hn::Vec<U16> open{_mm512_srlv_epi16(row.raw, x.raw)};
    return hn::And(mask, hn::RebindMask(d, hn::TestBit(open, hn::Set(du, 1)))).raw;
  }

 private:
  __m512i left_, right_;  // columns 0 .. 15 and 16 .. 31, a lane a row
#else
  HWY_INLINE explicit ShortTable(const OpenTable& table) : table_(table) {}

  template <int kFraction>
  HWY_INLINE uint32_t open_of(hn::Mask<I16> mask, hn::Vec<U16> x, hn::Vec<U16> y) const {
    const I16 d;
    const U32 d32;
    const hn::Rebind<uint16_t, U32> half;
    const auto bits = [&](auto some_x, auto some_y) {
      constexpr int kRows = kFraction == 11 ? 32 : 16;
      const auto open = table_.template at<kRows>(hn::PromoteTo(d32, some_x), hn::PromoteTo(d32, some_y));
      return bits_of(d32, hn::TestBit(open, hn::Set(d32, 1U)));
    };
    const uint32_t open = bits(hn::LowerHalf(half, x), hn::LowerHalf(half, y)) |
                          bits(hn::UpperHalf(half, x), hn::UpperHalf(half, y)) << hn::Lanes(d32);
    return open & bits_of(d, mask);
  }

 private:
  const OpenTable& table_;
#endif
};

// Finds the places of voxels, as fixed-point numbers that count from the table's first pixel.
template <bool kPerspective>
class ShortPlaces {
 public:
  HWY_INLINE explicit ShortPlaces(const ShortMap& map)
      : x_(map.x.step, map.x.last),
        y_(map.y.step, map.y.last),
        bend_(kPerspective ? map.bend : map.x.step, kPerspective ? map.bend_last : map.x.last),
        base_x_(held(hn::Set(I16(), map.x.base))),
        base_y_(held(hn::Set(I16(), map.y.base))) {}

  HWY_INLINE void find(hn::Vec<I16> entry, hn::Vec<I16>* low_x, hn::Vec<I16>* low_y) const {
    const auto yz = hn::ShiftRight<5>(entry);
    const auto z = hn::ShiftRight<10>(entry);
    *low_x = x_.of(entry, yz, z);
    *low_y = y_.of(entry, yz, z);
    if (kPerspective) {
      const auto bend = bend_.of(entry, yz, z);
      *low_x = hn::Add(hn::Add(*low_x, hn::MulHigh(*low_x, bend)), base_x_);
      *low_y = hn::Add(hn::Add(*low_y, hn::MulHigh(*low_y, bend)), base_y_);
    }
  }

 private:
  struct Row {
    hn::Vec<I16> step[3], last;
    HWY_INLINE Row(const int16_t (&steps)[3], int16_t last_one)
        : step{held(hn::Set(I16(), steps[0])), held(hn::Set(I16(), steps[1])),
               held(hn::Set(I16(), steps[2]))},
          last(held(hn::Set(I16(), last_one))) {}
    HWY_INLINE hn::Vec<I16> of(hn::Vec<I16> entry, hn::Vec<I16> yz, hn::Vec<I16> z) const {
      return hn::Add(hn::Add(hn::Mul(entry, step[0]), hn::Mul(yz, step[1])),
                     hn::Add(hn::Mul(z, step[2]), last));
    }
  };
  Row x_, y_, bend_;
  hn::Vec<I16> base_x_, base_y_;
};

// Finds the voxels of a run that cover an open pixel; stores their entries, and returns how many those are.
template <bool kPerspective, int kFraction>
HWY_NOINLINE uint32_t pick_short(const ShortEntries& from, uint32_t count, const ShortMap& map,
                                 const ShortTable& table, Batch* batch, uint16_t* picked) {
  const I16 d;
  const U16 du;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  const ShortPlaces<kPerspective> places(map);
  const auto fraction = hn::Set(d, (1 << kFraction) - 1);
  const auto least_x = held(hn::Set(d, map.x.least));
  const auto least_y = held(hn::Set(d, map.y.least));
  const uint32_t* ahead = batch->ahead;
  const uint32_t* const ahead_end = batch->ahead_end;
  // Vectors with such voxels are taken apart afterwards: a branch for each vector would be mispredicted.
  uint32_t masks[kMostShortEntries / 8 + 1];
  uint32_t starts[kMostShortEntries / 8 + 1];
  uint32_t kept = 0;
  for (uint32_t at = 0; at < count; at += lanes) {
    __builtin_prefetch(ahead);
    ahead += ahead < ahead_end ? lanes / 2 : 0;
    hn::Vec<I16> low_x;
    hn::Vec<I16> low_y;
    places.find(hn::BitCast(d, hn::LoadU(du, from.entries + at)), &low_x, &low_y);
    const auto column = hn::ShiftRight<kFraction>(hn::BitCast(du, low_x));
    const auto row = hn::ShiftRight<kFraction>(hn::BitCast(du, low_y));
    const auto seen =
        hn::And(hn::Gt(hn::And(low_x, fraction), least_x), hn::Gt(hn::And(low_y, fraction), least_y));
    masks[kept] = table.template open_of<kFraction>(seen, column, row);
    starts[kept] = at;
    kept += masks[kept] != 0 ? 1 : 0;
  }
  batch->ahead = ahead;
  if (kept != 0 && count - starts[kept - 1] < lanes) {
    masks[kept - 1] &= (uint32_t{1} << (count - starts[kept - 1])) - 1;
  }
  uint32_t number = 0;
  for (uint32_t i = 0; i < kept; ++i) {
    uint32_t left = masks[i];
    const auto pick = [&] {
      picked[number] = from.entries[starts[i] + static_cast<uint32_t>(__builtin_ctz(left | 1U << 31))];
      number += left != 0 ? 1 : 0;
      left &= left - 1;
    };
    // Few vectors have more than three. How many of these there are would be mispredicted, too.
    pick();
    pick();
    pick();
    while (left != 0) {
      pick();
    }
  }
  return number;
}

// Pairs voxels with their pixels.
template <bool kPerspective, int kFraction>
HWY_NOINLINE void pair_short(const WideFrame& frame, const Run& run, const ShortEntries& from,
                             const uint16_t* picked, uint32_t count, const ShortMap& map,
                             const Depths& depths, Batch* batch) {
  const I16 d;
  const U16 du;
  const U32 d32;
  const hn::Rebind<uint16_t, U32> half;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  const auto first = hn::Set(d32, (static_cast<uint32_t>(run.place.where.y0 - OpenTable::kMargin) << 16) +
                                      static_cast<uint32_t>(run.place.where.x0 - OpenTable::kMargin));
  const ShortPlaces<kPerspective> of(map);
  bool written = false;
  Pairs& waiting = batch->waiting;
  for (uint32_t at = 0; at < count; at += lanes) {
    if (waiting.count + lanes > Pairs::kSize) {
      test_boxes<kPerspective, true>(frame, depths, &written, batch);
    }
    hn::Vec<I16> low_x;
    hn::Vec<I16> low_y;
    of.find(hn::BitCast(d, hn::LoadU(du, picked + at)), &low_x, &low_y);
    const auto column = hn::ShiftRight<kFraction>(hn::BitCast(du, low_x));
    const auto row = hn::ShiftRight<kFraction>(hn::BitCast(du, low_y));
    uint32_t* const places = waiting.place + waiting.count;
    const auto place = [&](auto x, auto y) {
      return hn::Add(first, hn::Or(hn::ShiftLeft<16>(hn::PromoteTo(d32, y)), hn::PromoteTo(d32, x)));
    };
    hn::StoreU(place(hn::LowerHalf(half, column), hn::LowerHalf(half, row)), d32, places);
    hn::StoreU(place(hn::UpperHalf(half, column), hn::UpperHalf(half, row)), d32, places + lanes / 2);
    const uint32_t some = count - at < lanes ? count - at : lanes;
    widen({picked + at, from.cube}, some, waiting.entry + waiting.count);
    __builtin_memset(waiting.number + waiting.count, 0, lanes * sizeof(uint32_t));
    waiting.count += some;
  }
}

template <bool kPerspective, int kFraction>
HWY_INLINE void draw_short_of(const WideFrame& frame, const Run& run, const ShortEntries& from,
                              const ShortMap& map, const OpenTable& open, const Depths& depths,
                              Batch* batch) {
  uint16_t picked[kMostShortEntries + 32];
  const ShortTable table(open);
  const uint32_t count = pick_short<kPerspective, kFraction>(from, run.count, map, table, batch, picked);
  pair_short<kPerspective, kFraction>(frame, run, from, picked, count, map, depths, batch);
}

template <bool kPerspective>
bool draw_short_run_of(const WideFrame& frame, const Run& run, const ShortEntries& from, const Depths& depths,
                       Batch* batch) {
  const Rectangle& where = run.place.where;
  const int32_t most = where.x1 - where.x0 > where.y1 - where.y0 ? where.x1 - where.x0 : where.y1 - where.y0;
  if (most > OpenTable::kNarrowPx) {
    return false;
  }
  enter_cube<kPerspective, true>(frame, run, depths, batch);
  const bool is_small = most + OpenTable::kMargin + 1 <= 16;
  const int fraction = is_small ? 12 : 11;
  ShortMap& map = batch->short_map;
  // Without perspective the steps of blocks of one size are alike.
  const uint32_t kind = (run.block[0] & 31U) | (run.block[1] & 31U) << 5 | (run.block[2] & 31U) << 10 |
                        run.side << 16 | (is_small ? 1U << 31 : 0);
  if (kPerspective || map.kind != kind) {
    map.kind = 0;
    if (!find_short_map<kPerspective>(frame, run, fraction, &map)) {
      return false;
    }
    map.kind = kind;
  }
  move_short_map<kPerspective>(run.place.column, where.x0, fraction, &map.x);
  move_short_map<kPerspective>(run.place.row, where.y0, fraction, &map.y);
  bool written = false;
  // Draws what waits first, so that its pixels are known to be covered.
  if (batch->boxes.count != 0 || batch->picked.count + batch->waiting.count >= kMostBoxesWaiting) {
    test_boxes<kPerspective, true>(frame, depths, &written, batch);
  }
  write_hits(depths, batch);
  const OpenTable open(depths, where, is_small ? 16 : 32);
  if (open.none()) {
    return true;
  }
  batch->counts.boxes += run.count;
  is_small ? draw_short_of<kPerspective, 12>(frame, run, from, map, open, depths, batch)
           : draw_short_of<kPerspective, 11>(frame, run, from, map, open, depths, batch);
  return true;
}

bool draw_short_run(const WideFrame& frame, const Run& run, const ShortEntries& from, const Depths& depths,
                    Batch* batch) {
  return frame.perspective ? draw_short_run_of<true>(frame, run, from, depths, batch)
                           : draw_short_run_of<false>(frame, run, from, depths, batch);
}

#else

bool draw_short_run(const WideFrame&, const Run&, const ShortEntries&, const Depths&, Batch*) {
  return false;
}

#endif

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
