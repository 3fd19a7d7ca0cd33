/// The queues: boxes wait to be paired with their pixels, and pairs wait for their test. Tables tell which pixels are open:
/// not covered by anything drawn so far.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_QUEUE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_QUEUE_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_QUEUE_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_QUEUE_INL_H_
#endif

#include <type_traits>

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/lanes-inl.h"
#include "wide/raster/kernels/pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// Returns which of the pixels (x .. x + 31, y) are open, a bit each. Bits right of the picture and lanes outside `mask`
// mean nothing; such lanes read `own_row`, since other rows may belong to another thread.
HWY_INLINE hn::Vec<U32> open_at(const Depths& depths, hn::Mask<F32> mask, hn::Vec<U32> x, hn::Vec<U32> y,
                                int32_t own_row) {
  const U32 d;
  const auto own = hn::Set(d, static_cast<uint32_t>(own_row - depths.first_row));
  const auto word = hn::IfThenElse(hn::RebindMask(d, mask), word_of(depths, x, y), own);
  const auto column = hn::And(x, hn::Set(d, 31U));
#if HWY_TARGET == HWY_SCALAR
  const auto covered = hn::Set(d, depths.covered[hn::GetLane(word)]);
  const auto beside = hn::Set(d, depths.covered[hn::GetLane(word) + static_cast<uint32_t>(depths.rows)]);
#else
  const auto covered = hn::GatherIndex(d, depths.covered, hn::BitCast(I32(), word));
  const auto beside = hn::GatherIndex(d, depths.covered + depths.rows, hn::BitCast(I32(), word));
#endif
  // In two steps, since the shift is by 32 where the column is 0.
  const auto from_beside = hn::Shl(hn::Add(beside, beside), hn::Xor(column, hn::Set(d, 31U)));
  return hn::Not(hn::Or(hn::Shr(covered, column), from_beside));
}

// Returns a rectangle that holds all open pixels of one of at most 32 by 32 pixels, empty where none is open; a larger
// one as it is.
inline Rectangle open_bounds(const Depths& depths, const Rectangle& where) {
  const int32_t width = where.x1 - where.x0;
  const int32_t rows = where.y1 - where.y0;
  if (width > 32 || rows > 32) {
    return where;
  }
  const uint32_t shift = static_cast<uint32_t>(where.x0) & 31U;
  const uint32_t* const left = depths.covered + depths.word(where.x0, where.y0);
  // Where the rectangle lies in one strip, the right words are the left ones again.
  const uint32_t* const right = shift + static_cast<uint32_t>(width) > 32 ? left + depths.rows : left;
  const uint32_t inside = UINT32_MAX >> (32 - width);
  uint32_t columns = 0;
  uint32_t open_rows = 0;
  for (int32_t row = 0; row < rows; ++row) {
    const uint64_t bits = uint64_t{right[row]} << 32 | left[row];
    const uint32_t open = ~static_cast<uint32_t>(bits >> shift) & inside;
    columns |= open;
    open_rows |= (open != 0 ? 1U : 0U) << row;
  }
  return columns == 0
             ? Rectangle{0, 0, 0, 0}
             : Rectangle{where.x0 + __builtin_ctz(columns), where.y0 + __builtin_ctz(open_rows),
                         where.x0 + 32 - __builtin_clz(columns), where.y0 + 32 - __builtin_clz(open_rows)};
}

// Whether one of the first `wide` + 1 pixels is open.
HWY_INLINE hn::Mask<F32> any_open(hn::Vec<U32> open, hn::Vec<F32> wide) {
  const F32 d;
  const I32 di;
  const U32 du;
  // 2^(wide + 1) - 1
  const auto count = hn::BitCast(du, hn::ConvertTo(di, hn::Add(wide, hn::Set(d, 1.0F))));
  const auto bits = hn::Sub(hn::Shl(hn::Set(du, 1U), hn::Min(count, hn::Set(du, 25U))), hn::Set(du, 1U));
  return hn::RebindMask(d, hn::Ne(hn::And(open, bits), hn::Zero(du)));
}

// The open pixels of a rectangle, as a table for pick_some. Columns and rows are counted from kMargin before
// the rectangle's first, and nothing outside the rectangle is open.
class OpenTable {
 public:
  static constexpr int32_t kMargin = 3;
  // The most pixels of a side, with one more row and column behind the last. A row of up to kNarrowPx takes one word, a
  // wider one two.
  static constexpr int32_t kMostPx = 60 - kMargin - 1;
  static constexpr int32_t kNarrowPx = 32 - kMargin - 1;

  OpenTable(const Depths& depths, const Rectangle& where, int32_t least_rows = 16)
      : depths_(depths), where_(where) {
    const int32_t columns = where.x1 - where.x0;
    const int32_t rows = where.y1 - where.y0;
    rows_ = columns > kNarrowPx || rows > kNarrowPx ? 64 : rows + kMargin + 1 > 16 ? 32 : least_rows;
    none_ = fill(0, words_, kMargin);
    if (rows_ == 64) {
      none_ = fill(kRightColumn - kMargin, words_ + kRight, 0) && none_;
    }
  }

  bool none() const { return none_; }
  // A word for each of rows() rows, where these are at most 32.
  const uint32_t* words() const { return words_; }
  // The number of rows: 16, 32 or 64. There are 32 columns or, with 64 rows, 64.
  int rows() const { return rows_; }
  // Says in the lowest bit whether column `x` of row `y` modulo kRows is open, and in the next bit whether column x + 1
  // is. x: 0 .. 31, or 63 with 64 rows.
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
    // The last columns lie beyond all pixels and are not stored; each is read as the last stored one.
    return hn::Shr(row, hn::Min(shift, hn::Set(d, 31U)));
  }

 private:
  // Wide tables have two words a row. The second word, kRight words behind the first, repeats the first word's last
  // columns, so that each pixel stands in one word with its right neighbour.
  static constexpr int32_t kRightColumn = 28;
  static constexpr uint32_t kRight = 128;

  // Stores the open pixels from column `first` of the rectangle on, shifted up by `shift` bits. Returns whether none is
  // open.
  bool fill(int32_t first, uint32_t* words, int shift) {
    const U32 d;
    const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
    const int32_t rows = where_.y1 - where_.y0;
    const int32_t columns = where_.x1 - where_.x0 - first;
    const int32_t x = where_.x0 + first;
    const uint32_t* const left = depths_.covered + depths_.word(columns > 0 ? x : where_.x0, where_.y0);
    const int left_shift = x & 31;
    // Where the rectangle reaches into the strip beside it, that strip is read too.
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
    // Highway 1.0 has no function that looks up in two vectors. The instruction reads the lowest five bits of a row.
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

// Pairs some boxes with each of their pixels. Leaves out covered pixels as long as nothing was written into the picture
// meanwhile (`written`).
template <bool kPerspective, bool kUnit>
HWY_INLINE void pair_vector(const WideFrame& frame, const Depths& depths, hn::Mask<F32> live,
                            hn::Vec<U32> entry, hn::Vec<U32> number, hn::Vec<U32> place, hn::Vec<U32> wide_x,
                            hn::Vec<U32> wide_y, bool* written, Batch* batch) {
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
    const bool rejects = batch->all_behind && !*written;
    if (rejects) {
      open = open_at(depths, in_row, x, hn::Add(y, hn::Set(du, down)), frame.tile.y0);
    }
    for (uint32_t across = 0; !hn::AllFalse(d, in_column); ++across) {
      auto chosen = in_column;
      if (rejects) {
        chosen = hn::And(chosen, hn::RebindMask(d, hn::TestBit(open, hn::Set(du, 1U << across))));
      }
      append(chosen, entry, number, hn::Add(place, hn::Set(du, down << 16 | across)), &waiting);
      if (waiting.count + lanes > Pairs::kSize) {
        test_waiting<kPerspective, kUnit>(frame, depths, written, batch);
      }
      in_column = hn::And(in_column, hn::RebindMask(d, hn::Gt(wide_x, hn::Set(du, across))));
    }
    in_row = hn::And(in_row, hn::RebindMask(d, hn::Gt(wide_y, hn::Set(du, down))));
  }
}

// Masks the coordinates of a picked pixel.
constexpr uint32_t kPlacePixels = ((1U << kPlaceBits) - 1) * 0x10001U;

// Pairs the boxes that were picked with their pixels.
template <bool kPerspective, bool kGray>
HWY_NOINLINE void pair_picked_of(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  Picked& picked = batch->picked;
  Pairs& waiting = batch->waiting;
  const auto pixels = hn::Set(du, kPlacePixels);
  for (size_t at = 0; at < picked.count; at += lanes) {
    if (waiting.count + 4 * lanes > Pairs::kSize) {
      test_waiting<kPerspective, true>(frame, depths, written, batch);
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
void pair_picked(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  depths.gray_scale != nullptr ? pair_picked_of<kPerspective, true>(frame, depths, written, batch)
                               : pair_picked_of<kPerspective, false>(frame, depths, written, batch);
}

// Pairs the boxes that wait with their pixels.
template <bool kPerspective, bool kUnit>
HWY_NOINLINE void pair_boxes(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  const F32 d;
  const U32 du;
  const size_t lanes = hn::Lanes(d);
  if (batch->picked.count != 0) {
    pair_picked<kPerspective>(frame, depths, written, batch);
  }
  Boxes& boxes = batch->boxes;
  for (size_t at = 0; at < boxes.count; at += lanes) {
    const auto live = hn::FirstN(d, boxes.count - at < lanes ? boxes.count - at : lanes);
    const auto wide = hn::Load(du, boxes.wide + at);
    pair_vector<kPerspective, kUnit>(frame, depths, live, hn::Load(du, boxes.entry + at),
                                     hn::Load(du, boxes.number + at), hn::Load(du, boxes.place + at),
                                     hn::And(wide, hn::Set(du, 0xFFFFU)), hn::ShiftRight<16>(wide), written,
                                     batch);
  }
  boxes.count = 0;
  batch->all_behind = true;
}

// Boxes of at most so many pixels a side are paired; larger ones, and those of sorted runs, are drawn row by row.
constexpr float kMostQueued = 8;
// When so many boxes wait, they are drawn before the next run looks up open pixels.
constexpr size_t kMostBoxesWaiting = 128;

// Places on the picture as fixed-point numbers: a float to which kBase is added ends in 10 bits of the whole number and
// 12 bits of fraction.
struct FixedPoint {
  static constexpr int kFraction = 12;
  static constexpr int32_t kOne = 1 << kFraction;
  static constexpr double kBase = 3072;
  static constexpr int32_t kFirst = 0x45400000 >> kFraction;  // the whole number of the float 3072
  // A sum is within this of its exact value, as long as it is below 4096.
  static constexpr float kRounding = 1.0F / (1 << (kFraction + 1));
};

// Calls `call` with two constants.
template <class Call>
HWY_INLINE auto with_constants(bool first, bool second, const Call& call) {
  using Yes = std::true_type;
  using No = std::false_type;
  if (first) {
    return second ? call(Yes(), Yes()) : call(Yes(), No());
  }
  return second ? call(No(), Yes()) : call(No(), No());
}

// Pairs and tests all that waits. Unclear pairs may be left.
template <bool kPerspective, bool kUnit>
HWY_INLINE void test_boxes(const WideFrame& frame, const Depths& depths, bool* written, Batch* batch) {
  pair_boxes<kPerspective, kUnit>(frame, depths, written, batch);
  test_waiting<kPerspective, kUnit>(frame, depths, written, batch);
}

// Appends the boxes of the lanes in `mask`. `wide_x`, `wide_y`: pixels beyond the first.
HWY_INLINE void append_boxes(hn::Mask<U32> mask, hn::Vec<U32> entry, hn::Vec<U32> number, hn::Vec<U32> place,
                             hn::Vec<U32> wide_x, hn::Vec<U32> wide_y, Boxes* boxes) {
  const U32 d;
  const auto wide = hn::Or(hn::ShiftLeft<16>(wide_y), wide_x);
  hn::StoreU(squeeze(entry, mask), d, boxes->entry + boxes->count);
  hn::StoreU(squeeze(number, mask), d, boxes->number + boxes->count);
  hn::StoreU(squeeze(place, mask), d, boxes->place + boxes->count);
  hn::StoreU(squeeze(wide, mask), d, boxes->wide + boxes->count);
  boxes->count += hn::CountTrue(d, mask);
}

// Readies the batch for the run's cube; first draws what waits of another cube.
template <bool kPerspective, bool kUnit>
void enter_cube(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch) {
  if (batch->corner[0] == run.corner[0] && batch->corner[1] == run.corner[1] &&
      batch->corner[2] == run.corner[2]) {
    return;
  }
  bool written = false;
  test_boxes<kPerspective, kUnit>(frame, depths, &written, batch);
  test_unclear(frame, depths, &written, batch);
  write_hits(depths, batch);
  // The constants hold the cube's corner and, for single voxels, the centre of a voxel.
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
    batch->cube_value[down] = cube_value(run.corner, down);
  }
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
