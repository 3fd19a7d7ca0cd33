/// Projects boxes to the rectangles of pixels that they might cover, and draws those that cover many, row by row.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_LARGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_LARGE_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_LARGE_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_LARGE_INL_H_
#endif

#include "wide/raster/exact.h"
#include "wide/raster/hidden_voxels.h"
#include "wide/raster/kernels.h"
#include "wide/raster/kernels/pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// How far boxes reach from the pixels of their centres: the bound of frame.h, for the part of the tile in which the run
// may be seen.
struct Reach {
  float x, y;
  float slack_x, slack_y;

  Reach(const WideFrame& frame, const Rectangle& where)
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

// A vector of boxes on the picture: each might cover the pixels low_x .. low_x + wide_x, low_y .. low_y + wide_y.
struct Projected {
  hn::Vec<U32> entry;
  hn::Vec<F32> low_x, low_y;
  hn::Vec<F32> wide_x, wide_y;
  hn::Mask<F32> seen;
  hn::Mask<F32> crossing;  // the centre lies behind the eye's plane, but not all of the box
};

// Projects the boxes of the run from number `at` on, cut to the rectangle `clip`.
template <bool kPerspective, bool kUnit>
HWY_INLINE Projected project(const WideFrame& frame, const Run& run, const Rectangle& clip,
                             const Reach& reach, const Batch& batch, uint32_t at) {
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
  Points<F32> center;  // half a voxel less where all boxes are single voxels: enter_cube adds it
  center.x = hn::ConvertTo(d, hn::BitCast(di, entry_x));
  center.y = hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<10>(entry), within)));
  center.z = hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<20>(entry), within)));
  auto side = one;
  if (!kUnit) {
    side = hn::ConvertTo(d, hn::BitCast(di, hn::Shl(hn::Set(du, 1U), level)));
    const auto middle = hn::Mul(side, hn::Set(d, 0.5F));
    center = {hn::Add(center.x, middle), hn::Add(center.y, middle), hn::Add(center.z, middle)};
  }
  auto column = affine(frame.u, center, hn::Set(d, batch.constant[0]));
  auto row = affine(frame.v, center, hn::Set(d, batch.constant[1]));
  boxes.seen = live;
  boxes.crossing = hn::Lt(one, zero);
  auto per_depth = one;
  if (kPerspective) {
    const auto depth = affine(frame.w, center, hn::Set(d, batch.constant[2]));
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

// The test of one vector of pixels of a row.
struct RowTest {
  uint32_t* word;  // word of coverage, which holds the pixels from bit `shift` on
  uint32_t shift;
  size_t first;           // the first pixel's index in Depths::nearest
  uint32_t hits;          // a bit a pixel: floats say that its ray hits
  bool same;              // whether all rays have the same signs, as they mostly do
  uint32_t down;          // where `same`: the axes along which they run downwards
  uint32_t axis_down[3];  // the hits whose rays run downwards along an axis

  HWY_INLINE void set_directions(const Aims& aims) {
    const F32 d;
    same = true;
    down = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
      axis_down[axis] = bits_of(d, hn::Lt(aims.direction[axis], hn::Zero(d))) & hits;
      same = same && (axis_down[axis] == 0 || axis_down[axis] == hits);
      down |= axis_down[axis] != 0 ? 1U << axis : 0U;
    }
  }
  HWY_INLINE uint32_t down_of(uint32_t lane) const {
    return (axis_down[0] >> lane & 1U) | (axis_down[1] >> lane & 1U) << 1 | (axis_down[2] >> lane & 1U) << 2;
  }
};

// A box that covers many pixels, and how hits on it are written straight into the picture.
template <bool kGray>
class LargeBox {
 public:
  HWY_INLINE LargeBox(uint32_t entry, uint32_t number, const Depths& depths, Batch* batch)
      : depths_(depths), batch_(batch), entry_(entry), number_(number) {}

  // Tests in integers the pixels that floats could not decide: those in `unclear`, counted from column `x` of the row.
  HWY_INLINE void put_unclear(const WideFrame& frame, int32_t x, int32_t y, uint32_t unclear,
                              const RowTest& test) {
    for (; unclear != 0; unclear &= unclear - 1) {
      const int32_t lane = __builtin_ctz(unclear);
      uint32_t key = 0;
      uint32_t down = 0;
      ++batch_->counts.exact;
      const Meeting meeting = meet_exactly(frame, x + lane, y, entry_, batch_->corner, &key, &down);
      if (meeting == Meeting::kTouch && frame.hidden_in != nullptr) {
        ask_core_behind(frame, depths_, x + lane, y, entry_, key, down, batch_);
      }
      if (meeting == Meeting::kHit) {
        const uint8_t gray = kGray ? code_exactly(*frame.camera, *depths_.shading, depths_.gray_scale->code,
                                                  x + lane, y, entry_, batch_->corner)
                                   : uint8_t{0};
        put(test, static_cast<uint32_t>(lane),
            kGray ? mirrored_sum(entry_, batch_->corner, down) : value_of(*batch_, key, down, number_), gray);
        ++batch_->counts.hits;
      }
    }
  }

  // Writes hits with their greys; sums of mirrored coordinates decide which voxel is nearer.
  HWY_INLINE void put_grays(const RowTest& test, const uint8_t* grays) {
    HWY_ALIGN uint32_t sums[64];
    if (test.same) {
      find_value(test.down);
    }
    for (uint32_t left = test.same ? 0 : test.hits; left != 0; left &= left - 1) {
      const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(left));
      sums[lane] = static_cast<uint32_t>(value_for(test.down_of(lane)));
    }
    const U32 du;
    const hn::Rebind<uint8_t, U32> bytes;
    const hn::Rebind<uint16_t, U32> shorts;
    uint8_t* const to_gray = depths_.gray + test.first;
    uint16_t* const to_sum = depths_.nearest_sum + test.first;
    const auto sum = test.same ? hn::Set(du, static_cast<uint32_t>(value_)) : hn::Load(du, sums);
    uint32_t taken = test.hits;
    // What is open need not be read: reads would wait for the masked stores of the neighbours.
    if (!depths_.marks || (*test.word >> test.shift & test.hits) != 0) {
      const auto is_new = hn::Eq(hn::PromoteTo(du, hn::LoadU(bytes, to_gray)), hn::Zero(du));
      const auto before = hn::PromoteTo(du, hn::LoadU(shorts, to_sum));
      taken &= bits_of(du, hn::Or(is_new, hn::Lt(sum, before)));
    }
    const uint8_t mask_bits[8] = {static_cast<uint8_t>(taken), static_cast<uint8_t>(taken >> 8),
                                  static_cast<uint8_t>(taken >> 16), static_cast<uint8_t>(taken >> 24)};
    hn::BlendedStore(hn::DemoteTo(shorts, hn::BitCast(I32(), sum)), hn::LoadMaskBits(shorts, mask_bits),
                     shorts, to_sum);
    hn::BlendedStore(hn::Load(bytes, grays), hn::LoadMaskBits(bytes, mask_bits), bytes, to_gray);
    if (depths_.marks) {
      *test.word |= test.hits << test.shift;
    }
  }

  // Writes hits; values of Depths::nearest decide which box is nearer.
  HWY_INLINE void put_values(const RowTest& test) {
    const U64 d64;
    const int32_t lanes = static_cast<int32_t>(hn::Lanes(F32()));
    const int32_t lanes64 = static_cast<int32_t>(hn::Lanes(d64));
    const uint32_t before = *test.word >> test.shift & test.hits;
    if (test.same && before == 0) {
      find_value(test.down);
      *test.word |= test.hits << test.shift;
      const auto values = hn::Set(d64, value_);
      for (int32_t part = 0; part < lanes; part += lanes64) {
        const uint8_t mask_bits[8] = {static_cast<uint8_t>(test.hits >> part & ((1U << lanes64) - 1))};
        hn::BlendedStore(values, hn::LoadMaskBits(d64, mask_bits), d64,
                         depths_.nearest + test.first + static_cast<size_t>(part));
      }
      return;
    }
    for (uint32_t left = test.hits; left != 0; left &= left - 1) {
      const uint32_t lane = static_cast<uint32_t>(__builtin_ctz(left));
      put(test, lane, value_for(test.down_of(lane)), 0);
    }
  }

 private:
  uint64_t value_for(uint32_t down) const {
    if (kGray) {
      return uint64_t{mirrored_sum(entry_, batch_->corner, down)};
    }
    const uint32_t corner[3] = {x_of(entry_), entry_ >> 10 & kWithin, entry_ >> 20 & kWithin};
    return value_of(*batch_, mirrored_key(corner, level_of(entry_), down), down, number_);
  }
  // Sets value_, unless it is the last pixel's, as it mostly is.
  HWY_INLINE void find_value(uint32_t down) {
    if (down != known_down_) {
      known_down_ = down;
      value_ = value_for(down);
    }
  }

  // Writes the pixel of one lane if the value is less than the one in the picture.
  HWY_INLINE void put(const RowTest& test, uint32_t lane, uint64_t value, uint8_t gray) const {
    const uint32_t bit = uint32_t{1} << (test.shift + lane);
    const size_t at = test.first + lane;
    if (kGray) {
      if (depths_.gray[at] == 0 || value < depths_.nearest_sum[at]) {
        depths_.nearest_sum[at] = static_cast<uint16_t>(value);
        depths_.gray[at] = gray;
      }
    } else if ((*test.word & bit) == 0 || value < depths_.nearest[at]) {
      depths_.nearest[at] = value;
    }
    if (depths_.marks) {
      *test.word |= bit;
    }
  }

  const Depths& depths_;
  Batch* batch_;
  uint32_t entry_;
  uint32_t number_;
  uint32_t known_down_ = 8;  // the way that value_ belongs to; 8: none yet
  uint64_t value_ = 0;
};

// Where a box and the rays' origin lie in the block.
struct PlacedBox {
  HWY_INLINE PlacedBox(const WideFrame& frame, uint32_t entry, const Batch& batch)
      : low{hn::Set(F32(), static_cast<float>(x_of(entry))),
            hn::Set(F32(), static_cast<float>(entry >> 10 & kWithin)),
            hn::Set(F32(), static_cast<float>(entry >> 20 & kWithin))},
        half(hn::Set(F32(), static_cast<float>(256 << level_of(entry)))) {
    origin_of(frame, batch, origin);
  }
  hn::Vec<F32> low[3];
  hn::Vec<F32> half;
  float origin[3];
};

// Draws a box that covers many pixels along the rows of its rectangle, a vector of pixels at a time. With `reject` it
// skips covered pixels.
template <bool kPerspective, Keep kKeep>
HWY_NOINLINE void draw_large_in(const WideFrame& frame, uint32_t entry, uint32_t number,
                                const Rectangle& where, bool reject, const Depths& depths, Batch* batch) {
  constexpr bool kGray = kKeep != Keep::kNumbers;
  const F32 d;
  const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
  const uint32_t all_lanes = lanes == 32 ? UINT32_MAX : (uint32_t{1} << lanes) - 1;
  const PlacedBox place(frame, entry, *batch);
  LargeBox<kGray> box(entry, number, depths, batch);
  // A box that fits a vector gets one to itself in each row, unless that would reach into the next strip.
  const int32_t last_x = (where.x0 | 31) + 1 - lanes;
  const int32_t own_x = where.x0 < last_x ? where.x0 : last_x;
  const int32_t first_x = where.x1 - where.x0 <= lanes ? own_x : where.x0 & -lanes;
  for (int32_t y = where.y0; y < where.y1; ++y) {
    for (int32_t x = first_x; x < where.x1; x += lanes) {
      uint32_t wanted = all_lanes;
      wanted &= x < where.x0 ? UINT32_MAX << (where.x0 - x) : UINT32_MAX;
      wanted &= where.x1 - x < lanes ? (uint32_t{1} << (where.x1 - x)) - 1 : UINT32_MAX;
      RowTest test;
      test.shift = static_cast<uint32_t>(x) & 31U;
      test.word = depths.covered + depths.word(x, y);
      test.first = 32 * depths.word(x, y) + test.shift;
      if (reject) {
        wanted &= ~(*test.word >> test.shift);
      }
      if (wanted == 0) {
        continue;
      }
      batch->counts.candidates += static_cast<unsigned>(__builtin_popcount(wanted));
      const Aims aims = aims_of<kPerspective>(frame, place.origin, hn::Iota(d, static_cast<float>(x)),
                                              hn::Set(d, static_cast<float>(y)), place.low, place.half);
      const Verdict verdict = judge<kPerspective>(frame, aims, place.half);
      test.hits = bits_of(d, verdict.hit) & wanted;
      uint32_t unclear = bits_of(d, hn::Or(verdict.unclear, aims.unclear)) & wanted;
      HWY_ALIGN uint8_t grays[64];
      if (kGray) {
        auto no_gray = hn::Lt(place.half, hn::Zero(d));
        const hn::Rebind<uint8_t, I32> bytes;
        const auto found = codes_of<kPerspective, kKeep>(frame, *depths.gray_scale, aims, &no_gray);
        hn::Store(hn::DemoteTo(bytes, hn::BitCast(I32(), found)), bytes, grays);
        unclear |= bits_of(d, no_gray) & test.hits;
      }
      test.hits &= ~unclear;
      box.put_unclear(frame, x, y, unclear, test);
      if (test.hits == 0) {
        continue;
      }
      batch->counts.hits += static_cast<unsigned>(__builtin_popcount(test.hits));
      test.set_directions(aims);
      if (kGray) {
        box.put_grays(test, grays);
      } else {
        box.put_values(test);
      }
    }
  }
}

template <bool kPerspective>
void draw_large(const WideFrame& frame, uint32_t entry, uint32_t number, const Rectangle& where, bool reject,
                const Depths& depths, Batch* batch) {
  if (depths.is_touched != nullptr && where.x0 < where.x1 && where.y0 < where.y1) {
    touch_all(depths, where);
  }
  if (depths.gray_scale == nullptr) {
    draw_large_in<kPerspective, Keep::kNumbers>(frame, entry, number, where, reject, depths, batch);
  } else if (depths.gray_scale->code == GrayScale::Code::kGray) {
    draw_large_in<kPerspective, Keep::kGrays>(frame, entry, number, where, reject, depths, batch);
  } else {
    draw_large_in<kPerspective, Keep::kFaces>(frame, entry, number, where, reject, depths, batch);
  }
}

// Returns whether a box that crosses the eye's plane may be seen through the tile: not when it lies wholly outside one
// of the tile's four sides. Computes in doubles, since few boxes come here.
bool crosses_tile(const WideFrame& frame, const double (&center)[3], double side) {
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

// Draws the boxes of a vector that are in `mask`: large boxes, and boxes that cross the eye's plane.
template <bool kPerspective>
HWY_NOINLINE void draw_large_of(const WideFrame& frame, const Run& run, uint32_t at, const Projected& boxes,
                                hn::Mask<F32> mask, bool reject_all, bool* written, const Depths& depths,
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
      where = frame.tile;
    }
    draw_large<kPerspective>(frame, box, number, where, reject_all || (run.behind && !*written), depths,
                             batch);
    *written = true;
  }
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
