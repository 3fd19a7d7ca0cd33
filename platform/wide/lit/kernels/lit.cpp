// The loops of lit pictures, in lanes.
#include "wide/lit/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/lit/kernels/lit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "thimble/light/host/slope_window.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// --- Directions: the ray from a point of a face to a lamp and the light that it gives there (lit::light_ray); how high above
// the horizon a ray goes, as lit::sky_color wants it.

using F64 = hn::CappedTag<double, 8>;
using U64 = hn::RebindToUnsigned<F64>;
using I32 = hn::Rebind<int32_t, F64>;
using VF = hn::Vec<F64>;

static_assert(hn::MaxLanes(F64()) <= kMostLightLanes);

HWY_INLINE VF number(double value) {
  return hn::Set(F64(), value);
}
// Rounds a number that is not below 0 to the nearest integer; halves go up.
HWY_INLINE VF rounded(VF value, VF scale) {
  return hn::Floor(hn::MulAdd(value, scale, number(0.5)));
}

// What the length and direction of a way are found from.
struct Way {
  VF size[3];    // the direction's components without signs, 15 bits
  VF stretched;  // a power of two that takes the largest component to 2^14 .. 2^15 - 1
  VF numerator;  // a power of two: so many times the direction reaches the lamp
};

// Does as ray_towards. `size` holds the way's components without signs, below 2^25.
HWY_INLINE Way shorten_way(const VF (&size)[3]) {
  const F64 d;
  const U64 du;
  const VF one = number(1.0);
  const VF largest = hn::Max(size[0], hn::Max(size[1], size[2]));
  // 2^14 over the largest power of two in the largest component. For a way of length 0 it means nothing.
  const auto power = hn::And(hn::BitCast(du, largest), hn::Set(du, uint64_t{0x7FF} << 52));
  const VF to_15_bits = hn::BitCast(d, hn::Sub(hn::Set(du, (uint64_t{2 * 1023 + 14}) << 52), power));
  VF scale = hn::Min(to_15_bits, one);
  const auto carries = hn::Gt(rounded(largest, scale), number(32767.0));
  scale = hn::IfThenElse(carries, hn::Mul(scale, number(0.5)), scale);
  Way way;
  for (int axis = 0; axis < 3; ++axis) {
    way.size[axis] = rounded(size[axis], scale);
  }
  way.stretched = hn::Max(to_15_bits, one);
  way.numerator = hn::Div(one, scale);
  return way;
}

// A way's length, of 15 bits, and the cosine in 1/16384 between it and an axis, both as whole numbers.
struct Slant {
  VF length;
  VF cosine;
};

// Doubles hold the integers: products stay below 2^34, and a quotient or root that is no integer differs from the next
// one, or half, by more than 2^-33.
HWY_INLINE Slant slant_of(const Way& way, int axis) {
  VF size[3];
  VF square = hn::Zero(F64());
  for (int a = 0; a < 3; ++a) {
    size[a] = hn::Mul(way.size[a], way.stretched);
    square = hn::MulAdd(size[a], size[a], square);
  }
  const VF length = hn::Floor(hn::Add(hn::Sqrt(square), number(0.5)));
  const VF half = hn::Floor(hn::Mul(length, number(0.5)));
  const VF cosine = hn::Floor(hn::Div(hn::MulAdd(size[axis], number(16384.0), half), length));
  return {length, hn::Min(cosine, number(16384.0))};
}

// Shares in 2^-16 of a lamp's light, by distance and by angle.
HWY_INLINE VF share_of_lamp(const Way& way, VF reach) {
  const Slant slant = slant_of(way, 0);
  const VF distance = rounded(slant.length, hn::Div(way.numerator, way.stretched));
  const VF ratio = hn::Add(number(256.0), hn::Floor(hn::Div(distance, reach)));
  const VF left = hn::Floor(hn::Div(number(4294967295.0), hn::Mul(ratio, ratio)));
  const VF falloff = hn::IfThenElseZero(hn::Le(ratio, number(65535.0)), left);
  return hn::Floor(hn::Mul(hn::Mul(falloff, slant.cosine), number(1.0 / 16384)));
}

HWY_INLINE VF share_of_sky(VF x, VF y, VF z) {
  const Slant slant = slant_of(shorten_way({hn::Abs(x), hn::Abs(y), hn::Abs(z)}), 2);
  const VF one = number(4096.0);
  const VF rest = hn::Sub(one, hn::Floor(hn::Mul(slant.cosine, number(0.25))));
  const auto squared = [&](VF of) { return hn::Floor(hn::Mul(hn::Mul(of, of), number(1.0 / 4096))); };
  const VF second = squared(rest);
  const VF eighth = squared(squared(second));
  return hn::Sub(one, hn::IfThenElse(hn::Ge(z, hn::Zero(F64())), second, eighth));
}

void aim_at(const LampRays& lamp, size_t count) {
  const F64 d;
  const I32 di;
  const VF zero = hn::Zero(d);
  const VF reach = number(lamp.reach);
  for (size_t at = 0; at < count; at += hn::Lanes(d)) {
    VF way[3];
    VF size[3];
    for (int axis = 0; axis < 3; ++axis) {
      way[axis] = hn::Sub(number(lamp.place[axis]), hn::PromoteTo(d, hn::LoadU(di, lamp.at[axis] + at)));
      size[axis] = hn::Abs(way[axis]);
    }
    const Way ray = shorten_way(size);
    const auto is_before = lamp.is_negative ? hn::Lt(way[0], zero) : hn::Gt(way[0], zero);
    const auto leaves = hn::And(is_before, hn::Gt(ray.size[0], zero));
    const VF share = share_of_lamp(ray, reach);
    const auto put = [&](int32_t* to, VF of) { hn::StoreU(hn::DemoteTo(di, of), di, to + at); };
    for (int i = 0; i < 3; ++i) {
      const VF color = number(lamp.color_q8[i]);
      const VF bright = hn::Floor(hn::Mul(hn::MulAdd(color, share, number(2048.0)), number(1.0 / 4096)));
      put(lamp.brightness[i], hn::IfThenElseZero(leaves, bright));
      put(lamp.direction[i], hn::CopySign(ray.size[i], way[i]));
    }
    put(lamp.numerator, ray.numerator);
  }
}

void find_sky_shares(const int32_t* x, const int32_t* y, const int32_t* z, size_t count, int32_t* shares) {
  const F64 d;
  const I32 di;
  const auto load = [&](const int32_t* from) { return hn::PromoteTo(d, hn::LoadU(di, from)); };
  for (size_t at = 0; at < count; at += hn::Lanes(d)) {
    hn::StoreU(hn::DemoteTo(di, share_of_sky(load(x + at), load(y + at), load(z + at))), di, shares + at);
  }
}

// --- The slope of a surface (slope_table.h): sums of R^2 - d^2 over the voxels of a window, and windows turned from one axis
// to another.

using W32 = hn::CappedTag<int32_t, 16>;
using U16 = hn::CappedTag<uint16_t, kTurnLanes>;

constexpr int kSide = lit::kSlopeSide;
constexpr int kReach = lit::kSlopeColumns;
constexpr int32_t kUnit = lit::kSlopeUnit;

// By the distance of a row from the point's: how many columns to each side may have a voxel within reach. A voxel's
// centre is at least so many less a half away from the point along either axis.
constexpr int kHalves[2 * kReach + 1] = {3, 4, 5, 5, 5, 5, 5, 5, 5, 4, 3};
static_assert(lit::kSlopeReachHalves == 11);

// Which lanes, from number `first` on, stand for voxels that a column has.
HWY_INLINE hn::Mask<W32> solid_lanes(const uint16_t* column, size_t first) {
  const W32 d;
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  static_assert(hn::MaxLanes(W32()) == 16);
  (void)first;
  return hn::Mask<W32>{*column};
#else
  const auto place = hn::Iota(d, static_cast<int32_t>(first));
  return hn::TestBit(hn::Set(d, int32_t{*column}), hn::Shl(hn::Set(d, 1), place));
#endif
}

// A lane is a voxel of the column: it has R^2 - d^2, or 0 where that is less or nothing is solid. Numbers of
// columns and rows times these come as sums of sums, from the last one down. Whatever a sum passes on its
// way, what it ends at fits 32 bits.
void find_gradient(const uint16_t* columns, const int32_t* point, int32_t* gradient) {
  const W32 d;
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

THIMBLE_KERNEL(aim_at);
THIMBLE_KERNEL(find_sky_shares);
THIMBLE_KERNEL(find_gradient);
THIMBLE_KERNEL(turn_words);

}  // namespace thimble::wide
#endif
