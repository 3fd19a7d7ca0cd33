// Finds the slope of a surface in lanes (slope_table.h): sums R^2 - d^2 over the voxels of a window, and turns windows
// from one axis to another.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/lit/kernels/slope.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "thimble/light/host/slope_window.h"
#include "wide/lit/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using I32 = hn::CappedTag<int32_t, 16>;
using U16 = hn::CappedTag<uint16_t, kTurnLanes>;

constexpr int kSide = lit::kSlopeSide;
constexpr int kReach = lit::kSlopeColumns;
constexpr int32_t kUnit = lit::kSlopeUnit;

// By the distance of a row from the point's: how many columns to each side may have a voxel within reach. A voxel's
// centre is at least so many less a half away from the point along either axis.
constexpr int kHalves[2 * kReach + 1] = {3, 4, 5, 5, 5, 5, 5, 5, 5, 4, 3};
static_assert(lit::kSlopeReachHalves == 11);

// Which lanes, from number `first` on, stand for voxels that a column has.
HWY_INLINE hn::Mask<I32> solid_lanes(const uint16_t* column, size_t first) {
  const I32 d;
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  static_assert(hn::MaxLanes(I32()) == 16);
  (void)first;
  return hn::Mask<I32>{*column};
#else
  const auto place = hn::Iota(d, static_cast<int32_t>(first));
  return hn::TestBit(hn::Set(d, int32_t{*column}), hn::Shl(hn::Set(d, 1), place));
#endif
}

// A lane is a voxel of the column: it has R^2 - d^2, or 0 where that is less or nothing is solid. Numbers of
// columns and rows times these come as sums of sums, from the last one down. Whatever a sum passes on its
// way, what it ends at fits 32 bits.
void find_gradient(const uint16_t* columns, const int32_t* point, int32_t* gradient) {
  const I32 d;
  const auto zero = hn::Zero(d);
  const int middle_u = point[1] / kUnit;
  const int middle_v = point[2] / kUnit;
  int32_t ways_u[2 * kReach + 1];  // squares
  for (int u = 0; u <= 2 * kReach; ++u) {
    const int32_t du = (middle_u + u - kReach) * kUnit + kUnit / 2 - point[1];
    ways_u[u] = du * du;
  }
  uint32_t sum = 0;
  uint32_t sum_w = 0;
  uint32_t sum_u = 0;
  uint32_t sum_v = 0;
  for (size_t first = 0; first < kSide; first += hn::Lanes(d)) {
    const auto place = hn::Iota(d, static_cast<int32_t>(first));
    const auto dw = hn::Add(hn::ShiftLeft<6>(place), hn::Set(d, kUnit / 2 - point[0]));
    const auto square = hn::Mul(dw, dw);
    auto all = zero;
    auto by_u = zero;
    auto by_v = zero;
    for (int v = middle_v + kReach; v >= middle_v - kReach; --v) {
      const int32_t dv = v * kUnit + kUnit / 2 - point[2];
      const auto of_row = hn::Sub(hn::Set(d, lit::kSlopeReachSquare - dv * dv), square);
      const int half = kHalves[v - middle_v + kReach];
      auto row = zero;
      auto row_by_u = zero;
      for (int u = middle_u + half; u >= middle_u - half; --u) {
        const auto rest = hn::Sub(of_row, hn::Set(d, ways_u[u - middle_u + kReach]));
        const auto solid = solid_lanes(columns + v * kSide + u, first);
        row = hn::Add(row, hn::IfThenElseZero(solid, hn::Max(rest, zero)));
        row_by_u = hn::Add(row_by_u, row);
      }
      by_u = hn::Add(by_u, hn::Add(row_by_u, hn::Mul(row, hn::Set(d, middle_u - half - 1))));
      all = hn::Add(all, row);
      by_v = hn::Add(by_v, all);
    }
    sum += static_cast<uint32_t>(hn::GetLane(hn::SumOfLanes(d, all)));
    sum_w += static_cast<uint32_t>(hn::GetLane(hn::SumOfLanes(d, hn::Mul(all, dw))));
    sum_u += static_cast<uint32_t>(hn::GetLane(hn::SumOfLanes(d, by_u)));
    sum_v += static_cast<uint32_t>(hn::GetLane(hn::SumOfLanes(d, by_v)));
  }
  // The centre of column u is at 64 u + 32.
  sum_v += static_cast<uint32_t>(middle_v - kReach - 1) * sum;
  gradient[0] = static_cast<int32_t>(0U - sum_w);
  gradient[1] = static_cast<int32_t>(static_cast<uint32_t>(point[1] - kUnit / 2) * sum - kUnit * sum_u);
  gradient[2] = static_cast<int32_t>(static_cast<uint32_t>(point[2] - kUnit / 2) * sum - kUnit * sum_v);
}

// Quarters of a square change places, then those of quarters.
template <int kStep>
HWY_INLINE void swap_squares(uint16_t mask, uint16_t (*words)[kTurnLanes]) {
  const U16 d;
  const auto low = hn::Set(d, mask);
  for (size_t k = 0; k < 16; ++k) {
    if ((k & kStep) != 0) {
      continue;
    }
    for (size_t lane = 0; lane < kTurnLanes; lane += hn::Lanes(d)) {
      const auto one = hn::LoadU(d, words[k] + lane);
      const auto other = hn::LoadU(d, words[k + kStep] + lane);
      const auto change = hn::And(hn::Xor(hn::ShiftRight<kStep>(one), other), low);
      hn::StoreU(hn::Xor(one, hn::ShiftLeft<kStep>(change)), d, words[k] + lane);
      hn::StoreU(hn::Xor(other, change), d, words[k + kStep] + lane);
    }
  }
}

void turn_words(uint16_t (*words)[kTurnLanes]) {
  swap_squares<8>(0x00FF, words);
  swap_squares<4>(0x0F0F, words);
  swap_squares<2>(0x3333, words);
  swap_squares<1>(0x5555, words);
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thimble::wide {

HWY_EXPORT(find_gradient);
HWY_EXPORT(turn_words);

void find_gradient(const uint16_t* columns, const int32_t* point, int32_t* gradient) {
  HWY_DYNAMIC_DISPATCH(find_gradient)(columns, point, gradient);
}
void turn_words(uint16_t (*words)[kTurnLanes]) {
  HWY_DYNAMIC_DISPATCH(turn_words)(words);
}

}  // namespace thimble::wide
#endif
