// What lit pictures find from directions, in lanes: the ray from a point of a face to a lamp and the light that it gives
// there (lit::light_ray); how high above the horizon a ray goes, as lit::sky_color wants it.
#include "wide/lit/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/lit/kernels/directions.cpp"
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

HWY_EXPORT(aim_at);
HWY_EXPORT(find_sky_shares);
HWY_EXPORT(round_along_row);

void aim_at(const LampRays& lamp, size_t count) {
  HWY_DYNAMIC_DISPATCH(aim_at)(lamp, count);
}

void find_sky_shares(const int32_t* x, const int32_t* y, const int32_t* z, size_t count, int32_t* shares) {
  HWY_DYNAMIC_DISPATCH(find_sky_shares)(x, y, z, count, shares);
}

void round_along_row(int64_t first, int64_t step, size_t count, int32_t* rounded) {
  HWY_DYNAMIC_DISPATCH(round_along_row)(first, step, count, rounded);
}

}  // namespace thimble::wide
#endif
