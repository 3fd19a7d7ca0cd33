/// Finds which children of a block may be seen.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_BLOCKS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_BLOCKS_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_BLOCKS_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_BLOCKS_INL_H_
#endif

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

// How far boxes reach from the pixels of their centres (frame.h).
template <class D>
struct Extent {
  hn::Vec<D> x;
  hn::Vec<D> y;
};

// Finds the extent of boxes of `side` voxels with centres at (column, row).
template <bool kPerspective, class D>
HWY_INLINE Extent<D> extent(D d, const WideFrame& frame, hn::Vec<D> side, hn::Vec<D> column, hn::Vec<D> row,
                            hn::Vec<D> per_depth) {
  const auto one = hn::Set(d, 1.0F);
  auto half_x = hn::MulAdd(hn::Set(d, frame.reach_x), side, hn::Set(d, frame.rounding_x));
  auto half_y = hn::MulAdd(hn::Set(d, frame.reach_y), side, hn::Set(d, frame.rounding_y));
  half_x = hn::MulAdd(half_x, per_depth, hn::Set(d, frame.slack_x));
  half_y = hn::MulAdd(half_y, per_depth, hn::Set(d, frame.slack_y));
  if (kPerspective) {
    const auto nearness = hn::Mul(hn::Mul(hn::Set(d, frame.half_w), side), per_depth);
    const auto k = hn::MulAdd(hn::Mul(hn::Set(d, 0.5F), side), per_depth,
                              hn::Mul(hn::Set(d, frame.per_direction), hn::Add(one, nearness)));
    const auto r = hn::Mul(k, hn::Set(d, frame.norm_w));
    const auto factor = hn::Mul(k, hn::MulAdd(r, hn::Set(d, 1.152F), hn::Set(d, 1.001F)));
    const auto reach = [&](const float(&of)[4], auto place) {
      auto sum = hn::Abs(hn::NegMulAdd(place, hn::Set(d, frame.w[0]), hn::Set(d, of[0])));
      sum = hn::Add(sum, hn::Abs(hn::NegMulAdd(place, hn::Set(d, frame.w[1]), hn::Set(d, of[1]))));
      return hn::Add(sum, hn::Abs(hn::NegMulAdd(place, hn::Set(d, frame.w[2]), hn::Set(d, of[2]))));
    };
    const auto is_far = hn::Le(r, hn::Set(d, 0.125F));
    const auto near_x = hn::MulAdd(hn::Set(d, frame.rounding_x), per_depth, hn::Set(d, frame.spread_x));
    const auto near_y = hn::MulAdd(hn::Set(d, frame.rounding_y), per_depth, hn::Set(d, frame.spread_y));
    half_x = hn::IfThenElse(is_far, hn::MulAdd(reach(frame.u, column), factor, near_x), half_x);
    half_y = hn::IfThenElse(is_far, hn::MulAdd(reach(frame.v, row), factor, near_y), half_y);
  }
  return {half_x, half_y};
}

int find_children(const WideFrame& frame, const Block& block, unsigned mask, uint32_t first_child,
                  unsigned nearest, Block* children) {
  const hn::CappedTag<float, 8> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<uint8_t, decltype(d)> bytes;
  const size_t lanes = hn::Lanes(d);
  const uint32_t level = uint32_t{block.level} - 1;
  const uint32_t int_side = uint32_t{1} << level;
  const float side = static_cast<float>(int_side);
  // Counts how many octants of the mask come before each, a byte for each of eight, by sums of bytes.
  constexpr uint64_t kOnes = 0x0101010101010101U;
  const uint64_t set = ((mask * kOnes & 0x8040201008040201U) + 0x7F7F7F7F7F7F7F7FU) >> 7 & kOnes;
  const uint64_t before = set * kOnes << 8;
  uint8_t numbers[8];
  __builtin_memcpy(numbers, &before, sizeof(before));
  struct alignas(16) Part {
    uint32_t words[4];
  };
  Part parts[3][8];
  uint32_t seen = 0;
  for (size_t at = 0; at < 8; at += lanes) {
    const auto octant = hn::Iota(du, static_cast<uint32_t>(at));
    const auto corner = [&](uint32_t low, uint32_t bit) {
      const auto is_high = hn::TestBit(octant, hn::Set(du, bit));
      return hn::Add(hn::Set(du, low), hn::IfThenElseZero(is_high, hn::Set(du, int_side)));
    };
    const auto corner_x = corner(block.corner[0], 1);
    const auto corner_y = corner(block.corner[1], 2);
    const auto corner_z = corner(block.corner[2], 4);
    const auto middle = hn::Set(d, side * 0.5F);
    const auto center_of = [&](auto low) { return hn::Add(hn::ConvertTo(d, hn::BitCast(di, low)), middle); };
    const Points<decltype(d)> center{center_of(corner_x), center_of(corner_y), center_of(corner_z)};
    auto column = affine(frame.u, center, hn::Set(d, frame.u[3]));
    auto row = affine(frame.v, center, hn::Set(d, frame.v[3]));
    const auto zero = hn::Zero(d);
    auto per_depth = hn::Set(d, 1.0F);
    auto crossing = hn::Lt(per_depth, zero);
    auto hidden = crossing;
    if (frame.perspective) {
      const auto depth = affine(frame.w, center, hn::Set(d, frame.w[3]));
      const float reach = frame.half_w * side + frame.rounding_w;
      crossing = hn::Le(depth, hn::Set(d, reach));
      hidden = hn::Le(depth, hn::Set(d, -reach));
      per_depth = hn::Div(per_depth, hn::IfThenElse(crossing, per_depth, depth));
      column = hn::Mul(column, per_depth);
      row = hn::Mul(row, per_depth);
    }
    const auto half = frame.perspective ? extent<true>(d, frame, hn::Set(d, side), column, row, per_depth)
                                        : extent<false>(d, frame, hn::Set(d, side), column, row, per_depth);
    const auto half_x = half.x;
    const auto half_y = half.y;
    const auto first_x = hn::Set(d, static_cast<float>(frame.tile.x0));
    const auto end_x = hn::Set(d, static_cast<float>(frame.tile.x1));
    const auto first_y = hn::Set(d, static_cast<float>(frame.tile.y0));
    const auto end_y = hn::Set(d, static_cast<float>(frame.tile.y1));
    // A block that reaches the eye's plane may be anywhere in the tile.
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
    seen |= bits_of(d, hn::And(hn::Lt(x0, x1), hn::Lt(y0, y1))) << at;
    const auto whole = [&](auto value) { return hn::BitCast(du, hn::ConvertTo(di, value)); };
    const auto raw = [&](auto value) { return hn::BitCast(du, value); };
    hn::StoreInterleaved4(whole(x0), whole(y0), whole(x1), whole(y1), du, parts[0][at].words);
    hn::StoreInterleaved4(raw(column), raw(row), raw(hn::IfThenElse(crossing, zero, per_depth)), raw(zero),
                          du, parts[1][at].words);
    const auto node = hn::Add(hn::Set(du, first_child), hn::PromoteTo(du, hn::LoadU(bytes, numbers + at)));
    hn::StoreInterleaved4(node, hn::Or(hn::ShiftLeft<16>(corner_y), corner_x),
                          hn::Or(hn::Set(du, level << 16), corner_z), hn::Zero(du), du, parts[2][at].words);
  }
  seen &= mask;
  int count = 0;
  for (unsigned turn = 8; turn-- > 0;) {
    const unsigned octant = turn ^ nearest;
    for (unsigned part = 0; part < 3; ++part) {
      __builtin_memcpy(reinterpret_cast<Part*>(children + count) + part, &parts[part][octant], sizeof(Part));
    }
    count += static_cast<int>(seen >> octant & 1U);
  }
  return count;
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
