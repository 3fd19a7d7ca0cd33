/// Picks the voxels that have open pixels, from blocks of small voxels that lie behind all that is drawn.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_PICK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_PICK_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_PICK_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_PICK_INL_H_
#endif

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/queue-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// An approximate map of a block's single voxels to the picture, without divisions. A voxel at v in the cube
// covers columns from low = (x.v + x[3]) (s.v + s[3]) + low_x to low + wide_x, and rows alike. The steps along y are
// divided by 1024, since an entry holds v's y times 1024. An orthographic map has no s, and x[3] is part of low_x.
struct Linear {
  bool is_sound;  // false: the block is too near for such a map
  float x[4], y[4], s[4];
  double low_x, low_y;
  float wide_x, wide_y;
};

// Finds the map of a block. Let m be the block's centre, e = c - m, g = (U - column(m) W) / W.m and q = W.e / W.m. Then
//
//     column(c) = column(m) + g.e / (1 + q) = column(m) + g.e (1 - q) + g.e q^2 / (1 + q)
//
// for |e| <= h on every axis. The last term is at most |g|_1 h q0^2 / (1 - q0) with q0 = |W|_1 h / W.m. It is added to
// the extent, which is that of frame.h with |U - column(c) W|_1 <= W.m |g|_1 + |column(c) - column(m)| |W|_1.
//
// This takes no divisions either: 1 / (1 - q) <= 1 + q + 4/3 q^2 for q <= 1/4.
template <bool kPerspective>
HWY_INLINE void find_linear(const WideFrame& frame, const uint32_t (&block)[3], uint32_t side,
                            const Place& place, Linear* linear) {
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
    // The map rounds four sums and products, each at most 1024 times the steps.
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

// The constants of pick_some for one block.
template <bool kPerspective, bool kOne, int kRows>
struct PickPlaces {
  // Places are fixed-point numbers (queue-inl.h), sums of four terms that are each within kRounding.
  static constexpr float kError = 4 * FixedPoint::kRounding;
  static constexpr int kFraction = FixedPoint::kFraction;

  const Linear& linear;
  hn::Vec<F32> base_x, base_y;
  int32_t least_x, least_y;  // a box reaches the next pixel where the fraction is greater
  hn::Vec<U32> first;        // the table's first pixel

  HWY_INLINE PickPlaces(const Linear& map, const Rectangle& where) : linear(map) {
    // Exceeds FixedPoint::kBase by so much that cutting off rounds up.
    constexpr double kBase = FixedPoint::kBase + 1 - 1.0 / FixedPoint::kOne - static_cast<double>(kError);
    const auto base_of = [](double low, int32_t first_px) {  // counted as in the table
      return hn::Set(F32(), static_cast<float>(low - (first_px - OpenTable::kMargin) + kBase));
    };
    base_x = base_of(linear.low_x, where.x0);
    base_y = base_of(linear.low_y, where.y0);
    const auto least = [](float wide) {
      return static_cast<int32_t>((1 - wide - 2 * kError) * FixedPoint::kOne) - 1;
    };
    least_x = least(linear.wide_x);
    least_y = least(linear.wide_y);
    // The margin may lie outside the picture. Boxes of several pixels keep x and y modulo 2^14 each, which suffices
    // since open pixels are in the picture.
    const uint32_t x = static_cast<uint32_t>(where.x0 - OpenTable::kMargin);
    const uint32_t y = static_cast<uint32_t>(where.y0 - OpenTable::kMargin);
    first = hn::Set(U32(), kOne ? (y << 16) + x : (y << 16 | (x & 0xFFFFU)) & kPlacePixels);
  }

  // Finds the first pixels of the boxes, as fixed-point numbers.
  HWY_INLINE void find_low(hn::Vec<U32> entry, hn::Vec<U32>* low_x, hn::Vec<U32>* low_y) const {
    const F32 d;
    const I32 di;
    const U32 du;
    Points<F32> at;
    at.x = hn::ConvertTo(d, hn::BitCast(di, hn::And(entry, hn::Set(du, kWithin))));
    at.y = hn::ConvertTo(d, hn::BitCast(di, hn::And(entry, hn::Set(du, kWithin << 10))));  // of 1024
    at.z = hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<20>(entry)));
    if (kPerspective) {
      const auto s = affine(linear.s, at, hn::Set(d, linear.s[3]));
      *low_x = hn::BitCast(du, hn::MulAdd(affine(linear.x, at, hn::Set(d, linear.x[3])), s, base_x));
      *low_y = hn::BitCast(du, hn::MulAdd(affine(linear.y, at, hn::Set(d, linear.y[3])), s, base_y));
    } else {
      *low_x = hn::BitCast(du, affine(linear.x, at, base_x));
      *low_y = hn::BitCast(du, affine(linear.y, at, base_y));
    }
  }

  // Finds which of the four pixels that each box might cover are open, as bits of Picked::place. `open` holds those
  // of the first row; `part_x` and `part_y` are the fractions.
  HWY_INLINE hn::Vec<U32> open_of_four(const OpenTable& table, hn::Vec<U32> at_x, hn::Vec<U32> at_y,
                                       hn::Vec<I32> part_x, hn::Vec<I32> part_y, hn::Vec<U32> open) const {
    const I32 di;
    const U32 du;
    // The row behind the last one wraps to the first, which is of the margin.
    const auto below = table.template at<kRows>(at_x, hn::Add(at_y, hn::Set(du, 1U)));
    const auto has_more = hn::RebindMask(du, hn::Gt(part_y, hn::Set(di, least_y + FixedPoint::kOne)));
    const auto has_wider = hn::RebindMask(du, hn::Gt(part_x, hn::Set(di, least_x + FixedPoint::kOne)));
    const auto columns = hn::IfThenElse(has_wider, hn::Set(du, 3U), hn::Set(du, 1U));
    const auto upper = hn::ShiftLeft<kPlaceBits>(hn::And(open, columns));
    return hn::Or(upper,
                  hn::IfThenElseZero(has_more, hn::ShiftLeft<kPlaceBits + 16>(hn::And(below, columns))));
  }
};

// Picks boxes from number `at` on until none is left or the room is full. Returns the number at which it stopped.
// With kOne no box covers more than one pixel, and it appends pairs at once; else no box covers more than two pixels
// in a row or column. Greys need no numbers of entries.
template <bool kPerspective, bool kOne, bool kGray, int kRows>
HWY_NOINLINE uint32_t pick_some(const Run& run, const Linear& linear, const OpenTable& table, uint32_t at,
                                Batch* batch) {
  const I32 di;
  const U32 du;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(du));
  uint32_t* const entries = kOne ? batch->waiting.entry : batch->picked.entry;
  [[maybe_unused]] uint32_t* const numbers = kOne ? batch->waiting.number : batch->picked.number;
  uint32_t* const places = kOne ? batch->waiting.place : batch->picked.place;
  const size_t most = (kOne ? Pairs::kSize : Picked::kSize) - lanes;
  size_t count = kOne ? batch->waiting.count : batch->picked.count;
  const PickPlaces<kPerspective, kOne, kRows> of(linear, run.place.where);
  constexpr int kFraction = FixedPoint::kFraction;
  const auto fraction = hn::Set(du, FixedPoint::kOne - 1U);
  // A box beyond the table, at the edge of the tile, gets some place in the table: that may add a useless pair.
  const auto last_column = hn::Set(du, kRows < 64 ? 31U : 63U);
  const auto place_rows = hn::Set(du, (kRows - 1U) << 16);
  const uint32_t* ahead = batch->ahead;
  const uint32_t* const ahead_end = batch->ahead_end;
  for (; at < run.count && count <= most; at += lanes) {
    __builtin_prefetch(ahead);
    ahead += ahead < ahead_end ? lanes : 0;
    const auto entry = hn::LoadU(du, run.entries + at);
    hn::Vec<U32> low_x;
    hn::Vec<U32> low_y;
    of.find_low(entry, &low_x, &low_y);
    const auto at_x = hn::And(hn::ShiftRight<kFraction>(low_x), last_column);
    const auto at_y = hn::ShiftRight<kFraction>(low_y);
    auto open = table.template at<kRows>(at_x, at_y);
    // Many narrow boxes lie between the centres of pixels.
    const auto part_x = hn::BitCast(di, hn::And(low_x, fraction));
    const auto part_y = hn::BitCast(di, hn::And(low_y, fraction));
    auto seen = hn::And(hn::Gt(part_x, hn::Set(di, of.least_x)), hn::Gt(part_y, hn::Set(di, of.least_y)));
    if (run.count - at < lanes) {
      seen = hn::And(seen, hn::FirstN(di, run.count - at));
    }
    auto place = hn::Add(hn::OrAnd(at_x, hn::ShiftLeft<16 - kFraction>(low_y), place_rows), of.first);
    hn::Mask<U32> is_open;
    if (kOne) {
      is_open = hn::TestBit(open, hn::Set(du, 1U));
    } else {
      open = of.open_of_four(table, at_x, at_y, part_x, part_y, open);
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

// Pairs the voxels of a block with those of their pixels that are open: small single voxels, behind all that is in the
// picture. Returns false, with nothing done, for other blocks.
template <bool kPerspective>
bool pick_boxes(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch) {
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
  bool written = false;
  // Draws what waits first, so that its pixels are known to be covered.
  if (batch->boxes.count != 0 || batch->picked.count + batch->waiting.count >= kMostBoxesWaiting) {
    test_boxes<kPerspective, true>(frame, depths, &written, batch);
  }
  write_hits(depths, batch);
  const OpenTable table(depths, where);
  if (table.none()) {
    return true;
  }
  batch->counts.boxes += run.count;
  for (uint32_t at = 0; at < run.count;) {
    at = with_constants(widest < 1, depths.gray_scale != nullptr, [&](auto is_one, auto is_gray) {
      return pick_in<kPerspective, is_one.value, is_gray.value>(run, linear, table, at, batch);
    });
    if (at < run.count) {
      test_boxes<kPerspective, true>(frame, depths, &written, batch);
    }
  }
  return true;
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
