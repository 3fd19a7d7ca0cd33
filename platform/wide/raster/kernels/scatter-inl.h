/// Draws blocks of single voxels in no order.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_SCATTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_SCATTER_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_SCATTER_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_SCATTER_INL_H_
#endif

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/project-inl.h"
#include "wide/raster/kernels/queue-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// Maps the single voxels of a block that lies wholly in front of the eye to the picture. On each axis of the picture,
// with a = (row of the projection).v + `from`, a voxel covers the pixels from a / depth + low to
// (a + across) / depth + high, counted from the block's first pixel.
struct Scatter {
  float from_x, from_y;
  float across_x, across_y;
  float low_x, low_y, high_x, high_y;
  int32_t last_x, last_y;  // the block's last pixels
  float across, besides;

  // The sum and its constant are each rounded. Constants above 4096 are less exact, as such columns are; Reach covers
  // that.
  static constexpr double kError = 2 * static_cast<double>(FixedPoint::kRounding);
  static constexpr int32_t kMostPx = 1000;  // pixels of a block's side: so all sums are below 4096

  Scatter(const WideFrame& frame, const Run& run, const Batch& batch) {
    const Rectangle& where = run.place.where;
    const Reach reach(frame, where);
    const double half_x = static_cast<double>(reach.x) + static_cast<double>(frame.rounding_x);
    const double half_y = static_cast<double>(reach.y) + static_cast<double>(frame.rounding_y);
    from_x = static_cast<float>(static_cast<double>(batch.constant[0]) - half_x);
    from_y = static_cast<float>(static_cast<double>(batch.constant[1]) - half_y);
    across_x = static_cast<float>(2 * half_x);
    across_y = static_cast<float>(2 * half_y);
    // Adds so much that cutting off rounds the first pixel up and the last one down.
    const auto low = [](float slack, int32_t first) {
      return static_cast<float>(FixedPoint::kBase + 1 - 1.0 / FixedPoint::kOne - kError -
                                static_cast<double>(slack) - first);
    };
    const auto high = [](float slack, int32_t first) {
      return static_cast<float>(FixedPoint::kBase + kError + static_cast<double>(slack) - first);
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

  // The most pixels that a box measures at this depth or farther away.
  float widest(float per_depth) const { return across * per_depth + besides; }
};

// Scatters boxes from number `at` on until none is left or the room is full. Returns the number at which it stopped.
// With kMany boxes may cover several pixels.
template <bool kPerspective, bool kMany, bool kGray>
HWY_NOINLINE uint32_t scatter_some(const WideFrame& frame, const Run& run, const Scatter& scatter,
                                   uint32_t at, Batch* batch) {
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
    const Points<F32> voxel{hn::ConvertTo(d, hn::BitCast(di, hn::And(entry, within))),
                            hn::ConvertTo(d, hn::BitCast(di, hn::And(hn::ShiftRight<10>(entry), within))),
                            hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<20>(entry)))};
    auto per_depth = hn::Set(d, 1.0F);
    if (kPerspective) {
      per_depth = hn::Div(per_depth, affine(frame.w, voxel, hn::Set(d, batch->constant[2])));
    }
    const auto from_x = affine(frame.u, voxel, hn::Set(d, scatter.from_x));
    const auto from_y = affine(frame.v, voxel, hn::Set(d, scatter.from_y));
    // A place beside the block's pixels becomes some number on the same side of them.
    const auto whole = [&](hn::Vec<F32> a, float last) {
      const auto sum = hn::BitCast(di, hn::MulAdd(a, per_depth, hn::Set(d, last)));
      return hn::Sub(hn::ShiftRight<FixedPoint::kFraction>(sum), hn::Set(di, FixedPoint::kFirst));
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
      append_boxes(hn::RebindMask(du, are_many), entry, number, place, hn::BitCast(du, wide_x),
                   hn::BitCast(du, wide_y), &queue);
    }
  }
  return at;
}

// Draws, in no order, a block of single voxels that does not reach the eye's plane. Returns false, with nothing done,
// for other blocks.
template <bool kPerspective>
bool scatter_boxes(const WideFrame& frame, const Run& run, const Depths& depths, Batch* batch) {
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
  batch->counts.boxes += run.count;
  batch->all_behind = batch->all_behind && !are_many;
  bool written = false;
  in_rooms(
      run.count, are_many, depths.gray_scale != nullptr,
      [&](auto many, auto is_gray, uint32_t at) {
        return scatter_some<kPerspective, many.value, is_gray.value>(frame, run, scatter, at, batch);
      },
      [&] {
        if (batch->boxes.count + hn::Lanes(F32()) > Boxes::kSize) {
          pair_boxes<kPerspective, true>(frame, depths, &written, batch);
          batch->all_behind = false;
        } else {
          test_waiting<kPerspective, true>(frame, depths, &written, batch);
        }
      });
  return true;
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
