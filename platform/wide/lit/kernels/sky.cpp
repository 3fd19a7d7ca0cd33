// Finds how high above the horizon rays go: lit::sky_color's share of the zenith or the ground, in lanes.
#include "wide/lit/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/lit/kernels/sky.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F64 = hn::CappedTag<double, 8>;
using U64 = hn::RebindToUnsigned<F64>;
using I32 = hn::Rebind<int32_t, F64>;
using VF = hn::Vec<F64>;

static_assert(hn::MaxLanes(F64()) <= kMostLightLanes);

// Doubles that hold integers: products stay below 2^34, and whole parts of quotients and roots are the
// integers', since those differ from the next whole number, or half, by more than 2^-19.
HWY_INLINE VF share_of_sky(VF x, VF y, VF z) {
  const F64 d;
  const U64 du;
  const VF half = hn::Set(d, 0.5);
  const VF ax = hn::Abs(x);
  const VF ay = hn::Abs(y);
  const VF az = hn::Abs(z);
  const VF largest = hn::Max(ax, hn::Max(ay, az));
  // 2^-exponent, which takes the largest component to 2^14 .. 2^15 - 1, rounded.
  const auto power = hn::And(hn::BitCast(du, largest), hn::Set(du, uint64_t{0x7FF} << 52));
  VF scale = hn::BitCast(d, hn::Sub(hn::Set(du, (uint64_t{2 * 1023 + 14}) << 52), power));
  const auto carries = hn::Gt(hn::Floor(hn::MulAdd(largest, scale, half)), hn::Set(d, 32767.0));
  scale = hn::IfThenElse(carries, hn::Mul(scale, half), scale);
  const VF sx = hn::Floor(hn::MulAdd(ax, scale, half));
  const VF sy = hn::Floor(hn::MulAdd(ay, scale, half));
  const VF sz = hn::Floor(hn::MulAdd(az, scale, half));
  const VF square = hn::MulAdd(sx, sx, hn::MulAdd(sy, sy, hn::Mul(sz, sz)));
  const VF length = hn::Floor(hn::Add(hn::Sqrt(square), half));
  const VF cosine =
      hn::Floor(hn::Div(hn::MulAdd(sz, hn::Set(d, 16384.0), hn::Floor(hn::Mul(length, half))), length));
  const VF one = hn::Set(d, 4096.0);
  const VF part = hn::Set(d, 1.0 / 4096);
  const VF rest = hn::Sub(one, hn::Floor(hn::Mul(hn::Min(cosine, hn::Set(d, 16384.0)), hn::Set(d, 0.25))));
  const auto squared = [&](VF of) { return hn::Floor(hn::Mul(hn::Mul(of, of), part)); };
  const VF second = squared(rest);
  const VF eighth = squared(squared(second));
  return hn::Sub(one, hn::IfThenElse(hn::Ge(z, hn::Zero(d)), second, eighth));
}

void find_sky_shares(const int32_t* x, const int32_t* y, const int32_t* z, size_t count, int32_t* shares) {
  const F64 d;
  const I32 di;
  const auto load = [&](const int32_t* from) { return hn::PromoteTo(d, hn::LoadU(di, from)); };
  for (size_t at = 0; at < count; at += hn::Lanes(d)) {
    hn::StoreU(hn::DemoteTo(di, share_of_sky(load(x + at), load(y + at), load(z + at))), di, shares + at);
  }
}

// Camera::rounded, of numbers a step apart.
void round_along_row(int64_t first, int64_t step, size_t count, int32_t* rounded) {
  const hn::RebindToSigned<F64> d;
  const U64 du;
  const I32 di;
  alignas(64) int64_t values[hn::MaxLanes(d)];
  for (size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    values[lane] = first + static_cast<int64_t>(lane) * step;
  }
  auto value = hn::Load(d, values);
  const auto on = hn::Set(d, static_cast<int64_t>(hn::Lanes(d)) * step);
  const auto half = hn::Set(d, int64_t{1} << 31);
  for (size_t at = 0; at < count; at += hn::Lanes(d)) {
    const auto sum = hn::Add(hn::Add(value, half), hn::BroadcastSignBit(value));
    const auto high = hn::TruncateTo(hn::RebindToUnsigned<I32>(), hn::ShiftRight<32>(hn::BitCast(du, sum)));
    hn::StoreU(hn::BitCast(di, high), di, rounded + at);
    value = hn::Add(value, on);
  }
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thimble::wide {

HWY_EXPORT(find_sky_shares);
HWY_EXPORT(round_along_row);

void find_sky_shares(const int32_t* x, const int32_t* y, const int32_t* z, size_t count, int32_t* shares) {
  HWY_DYNAMIC_DISPATCH(find_sky_shares)(x, y, z, count, shares);
}

void round_along_row(int64_t first, int64_t step, size_t count, int32_t* rounded) {
  HWY_DYNAMIC_DISPATCH(round_along_row)(first, step, count, rounded);
}

}  // namespace thimble::wide
#endif
