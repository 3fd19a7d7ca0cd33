/// Vectors of numbers, and functions on them that all kernels use.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_LANES_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_LANES_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_LANES_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using F32 = hn::ScalableTag<float>;
using I32 = hn::RebindToSigned<F32>;
using U32 = hn::RebindToUnsigned<F32>;
using F64 = hn::ScalableTag<double>;
using U64 = hn::RebindToUnsigned<F64>;
using HalfI32 = hn::Rebind<int32_t, F64>;  // as many lanes as F64
using HalfU32 = hn::Rebind<uint32_t, F64>;

// One bit a lane, the first lane in the lowest.
template <class D>
inline uint32_t bits_of(D d, hn::Mask<D> mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return uint32_t{bytes[0]} | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[3]} << 24;
}

// Moves the lanes in `mask` to the front. Highway 1.0 does this for AVX2 with a table inside the function,
// which gcc 12 copies onto the stack at each call: that took three quarters of a frame. So AVX2 has a table
// of its own here.
#if HWY_TARGET == HWY_AVX2
// The numbers of the lanes in a mask, four bits each.
struct LaneTable {
  uint32_t of[256];
  constexpr LaneTable() : of{} {
    for (uint32_t mask = 0; mask < 256; ++mask) {
      uint32_t shift = 0;
      for (uint32_t lane = 0; lane < 8; ++lane) {
        of[mask] |= (mask >> lane & 1U) * lane << shift;
        shift += 4 * (mask >> lane & 1U);
      }
    }
  }
};
constexpr LaneTable kLanesIn;

HWY_INLINE hn::Vec<U32> squeeze(hn::Vec<U32> v, hn::Mask<U32> mask) {
  const U32 d;
  const int bits = _mm256_movemask_ps(_mm256_castsi256_ps(hn::VecFromMask(d, mask).raw));
  const auto packed = hn::Set(d, kLanesIn.of[bits]);
  const auto shifts = hn::ShiftLeft<2>(hn::Iota(d, 0));
  return hn::Vec<U32>{_mm256_permutevar8x32_epi32(v.raw, hn::Shr(packed, shifts).raw)};
}
#else
HWY_INLINE hn::Vec<U32> squeeze(hn::Vec<U32> v, hn::Mask<U32> mask) {
  return hn::Compress(v, mask);
}
#endif

// Keeps a constant of a loop in a register, or as a whole vector on the stack: gcc 12 would broadcast it from a number
// again for each vector.
template <class V>
HWY_INLINE V held(V v) {
#if HWY_ARCH_X86
  __asm__("" : "+v"(v.raw));
#endif
  return v;
}

constexpr uint32_t kWithin = 1023;  // masks a coordinate within a cube of entries

// Points, one a lane.
template <class D>
struct Points {
  hn::Vec<D> x, y, z;
};

// The products of the row's first three numbers with the points, and `last`.
template <class D>
HWY_INLINE hn::Vec<D> affine(const float (&row)[4], const Points<D>& points, hn::Vec<D> last) {
  const D d;
  return hn::MulAdd(hn::Set(d, row[0]), points.x,
                    hn::MulAdd(hn::Set(d, row[1]), points.y, hn::MulAdd(hn::Set(d, row[2]), points.z, last)));
}

// Loads the first `count` numbers, and zeros behind them. Reads no further: what follows may belong to another thread.
HWY_INLINE hn::Vec<U32> load_some(const uint32_t* from, int32_t count) {
  const U32 d;
  const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
  if (count >= lanes) {
    return hn::LoadU(d, from);
  }
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_AVX2
  return hn::MaskedLoad(hn::FirstN(d, static_cast<size_t>(count)), d, from);
#else
  HWY_ALIGN uint32_t some[64] = {};
  for (int32_t i = 0; i < count; ++i) {
    some[i] = from[i];
  }
  return hn::Load(d, some);
#endif
}

// Moves bits 0..9 to every third bit.
inline hn::Vec<U32> spread10(hn::Vec<U32> v) {
  const U32 d;
  v = hn::And(hn::Or(v, hn::ShiftLeft<16>(v)), hn::Set(d, 0x030000FFU));
  v = hn::And(hn::Or(v, hn::ShiftLeft<8>(v)), hn::Set(d, 0x0300F00FU));
  v = hn::And(hn::Or(v, hn::ShiftLeft<4>(v)), hn::Set(d, 0x030C30C3U));
  return hn::And(hn::Or(v, hn::ShiftLeft<2>(v)), hn::Set(d, 0x09249249U));
}

// Moves every third bit to bits 0..9.
inline hn::Vec<U32> gathered10(hn::Vec<U32> v) {
  const U32 d;
  v = hn::And(v, hn::Set(d, 0x09249249U));
  v = hn::And(hn::Or(v, hn::ShiftRight<2>(v)), hn::Set(d, 0x030C30C3U));
  v = hn::And(hn::Or(v, hn::ShiftRight<4>(v)), hn::Set(d, 0x0300F00FU));
  v = hn::And(hn::Or(v, hn::ShiftRight<8>(v)), hn::Set(d, 0x030000FFU));
  return hn::And(hn::Or(v, hn::ShiftRight<16>(v)), hn::Set(d, 0x3FFU));
}

// Finds the logarithms of boxes' sides (level_of), and their x without the bits that hold the side (x_of).
template <class D>
inline void unpack_side(D d, hn::Vec<D> entry, bool unit, hn::Vec<D>* level, hn::Vec<D>* x) {
  *x = hn::And(entry, hn::Set(d, 1023U));
  *level = hn::Zero(d);
  if (!unit) {
    const auto code = hn::ShiftRight<30>(entry);
    const auto is_large = hn::Eq(code, hn::Set(d, 3U));
    const auto more = hn::IfThenElseZero(is_large, hn::And(entry, hn::Set(d, 7U)));
    *x = hn::Sub(*x, more);
    *level = hn::Add(code, more);
  }
}

// Converts whole numbers 0 .. 65535. Cheaper than ConvertTo, which also handles floats beyond any integer.
HWY_INLINE hn::Vec<U32> small_number(hn::Vec<F32> value) {
  const F32 d;
  const U32 du;
  return hn::And(hn::BitCast(du, hn::Add(value, hn::Set(d, 8388608.0F))), hn::Set(du, 0xFFFFU));
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
