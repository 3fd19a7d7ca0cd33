/// Projects boxes to the rectangles of pixels that they might cover.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_PROJECT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_PROJECT_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_PROJECT_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_PROJECT_INL_H_
#endif

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/lanes-inl.h"

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

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
