// Finds the grey or face of each pixel from its nearest box; and holds what is done once for a block or a picture.
#include "wide/raster/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "wide/raster/kernels/pixels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "wide/raster/kernels/judge-inl.h"
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

using Codes = hn::CappedTag<uint8_t, 32>;

// One byte of pixels whose codes are greys: the grey itself, or its half of a 16-bit colour.
template <size_t kSize>
HWY_INLINE hn::Vec<Codes> gray_byte(const CodeBytes& bytes, int place, hn::Vec<Codes> gray) {
  const Codes d;
  if (kSize != 2) {
    return gray;
  }
  // A grey's red and blue have the same five bits, so RGB and BGR give the same bytes.
  const auto low =
      hn::Or(hn::And(hn::ShiftLeft<3>(gray), hn::Set(d, uint8_t{0xE0})), hn::ShiftRight<3>(gray));
  const auto high = hn::Or(hn::And(gray, hn::Set(d, uint8_t{0xF8})), hn::ShiftRight<5>(gray));
  return (place == 0) != bytes.high_first ? low : high;
}

HWY_INLINE hn::Vec<Codes> byte_of(const uint8_t (&table)[16], hn::Vec<Codes> code) {
  const Codes d;
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(d, table[hn::GetLane(code)]);
#else
  return hn::TableLookupBytes(hn::LoadDup128(d, table), code);
#endif
}

// Stores the pixels of 32 codes, without a branch for each: nobody can predict where a cloud has holes. Returns how
// many show something.
template <size_t kSize, bool kGray>
HWY_INLINE size_t put_strip(const uint8_t* codes, const CodeBytes& bytes, uint8_t* to) {
  const Codes d;
  const size_t lanes = hn::Lanes(d);
  size_t count = 0;
  for (size_t part = 0; part < 32; part += lanes) {
    const auto code = hn::LoadU(d, codes + part);
    const auto is_none = hn::Eq(code, hn::Zero(d));
    count += lanes - hn::CountTrue(d, is_none);
    const auto byte = [&](int place) {
      if (kGray) {
        return hn::IfThenElse(is_none, hn::Set(d, bytes.of[place][0]), gray_byte<kSize>(bytes, place, code));
      }
      return byte_of(bytes.of[place], code);
    };
    uint8_t* const place = to + kSize * part;
    if (kSize == 1) {
      hn::StoreU(byte(0), d, place);
    } else if (kSize == 2) {
      hn::StoreInterleaved2(byte(0), byte(1), d, place);
    } else {
      hn::StoreInterleaved3(byte(0), byte(1), byte(2), d, place);
    }
  }
  return count;
}

// Does the same for the last pixels of a row, which may be fewer than 32.
template <size_t kSize, bool kGray>
HWY_INLINE size_t put_some(const uint8_t* codes, size_t pixels, const CodeBytes& bytes, uint8_t* to) {
  if (pixels >= 32) {
    return put_strip<kSize, kGray>(codes, bytes, to);
  }
  HWY_ALIGN uint8_t last[32 * kSize];
  const size_t count = put_strip<kSize, kGray>(codes, bytes, last);  // codes right of the picture are 0
  __builtin_memcpy(to, last, kSize * pixels);
  return count;
}

// Whether 32 codes show nothing.
HWY_INLINE bool is_blank(const uint8_t* codes) {
  uint64_t words[4];
  __builtin_memcpy(words, codes, sizeof(words));
  return (words[0] | words[1] | words[2] | words[3]) == 0;
}

// Pixels of kSize bytes.
template <size_t kSize, bool kGray>
struct Put {
  static uint32_t row(const Depths& depths, int32_t y, int32_t width_px, const CodeBytes& bytes,
                      uint8_t* to) {
    const size_t stride = 32 * static_cast<size_t>(depths.rows);
    const size_t width = static_cast<size_t>(width_px);
    const uint8_t* from = depths.gray + 32 * depths.word(0, y);
    size_t count = 0;
    for (size_t left = 0; left < width; left += 32) {
      count += put_some<kSize, kGray>(from, width - left, bytes, to + kSize * left);
      from += stride;
    }
    return static_cast<uint32_t>(count);
  }

  static uint32_t touched(const Depths& depths, int32_t width_px, const CodeBytes& bytes, uint8_t* to,
                          size_t stride) {
    const size_t rows = static_cast<size_t>(depths.rows);
    const size_t width = static_cast<size_t>(width_px);
    size_t count = 0;
    for (uint32_t i = 1; i <= depths.touched[0]; ++i) {
      size_t word = size_t{kPieceWords} * depths.touched[i];
      size_t left = word / rows * 32;
      size_t row = word % rows;
      for (int n = 0; n < kPieceWords && left < width; ++n, ++word) {
        // The background is there already, and most of a piece is background. (Fewer bytes are stored before the branch is
        // decided.)
        const uint8_t* const codes = depths.gray + 32 * word;
        if (kSize < 3 || !is_blank(codes)) {
          count += put_some<kSize, kGray>(codes, width - left, bytes, to + stride * row + kSize * left);
        }
        if (++row == rows) {
          row = 0;
          left += 32;
        }
      }
    }
    return static_cast<uint32_t>(count);
  }
};

template <class Call>
HWY_INLINE uint32_t by_size(const CodeBytes& bytes, const Call& call) {
  switch (bytes.size) {
    case 1:
      return bytes.is_gray ? call(Put<1, true>()) : call(Put<1, false>());
    case 2:
      return bytes.is_gray ? call(Put<2, true>()) : call(Put<2, false>());
    default:
      return bytes.is_gray ? call(Put<3, true>()) : call(Put<3, false>());
  }
}

uint32_t put_colors(const Depths& depths, int32_t y, int32_t width_px, const CodeBytes& bytes, uint8_t* to) {
  return by_size(bytes, [&](auto put) { return put.row(depths, y, width_px, bytes, to); });
}
uint32_t put_touched(const Depths& depths, int32_t width_px, const CodeBytes& bytes, uint8_t* to,
                     size_t stride) {
  return by_size(bytes, [&](auto put) { return put.touched(depths, width_px, bytes, to, stride); });
}

// Stores the numbers of a word's set bits, each plus `first`, in `to`, which has room for 48. Returns how many bits are
// set.
HWY_INLINE uint32_t store_bits(uint32_t word, uint32_t first, uint32_t* to) {
  const U32 d;
  const uint32_t lanes = static_cast<uint32_t>(hn::Lanes(d));
  uint32_t count = 0;
  if (lanes < 8) {
    for (uint32_t bits = word; bits != 0; bits &= bits - 1) {
      to[count++] = first + static_cast<uint32_t>(__builtin_ctz(bits));
    }
    return count;
  }
  // No branch for each bit: how many are set cannot be predicted.
  uint8_t bytes[8] = {};
  __builtin_memcpy(bytes, &word, sizeof(word));
  for (uint32_t part = 0; part < 32; part += lanes) {
    const auto mask = hn::LoadMaskBits(d, bytes + part / 8);
    hn::StoreU(squeeze(hn::Iota(d, first + part), mask), d, to + count);
    count += static_cast<uint32_t>(hn::CountTrue(d, mask));
  }
  return count;
}

int32_t find_covered(const Depths& depths, int32_t left, int32_t row, int32_t end, Pixels* pixels) {
  const U32 d;
  const I32 di;
  const int32_t lanes = static_cast<int32_t>(hn::Lanes(d));
  const uint32_t before = pixels->count;
  uint32_t count = before;
  const uint32_t first_word = static_cast<uint32_t>(depths.word(left, depths.first_row));
  while (row < end && count <= kMostPixels - 32) {
    const uint32_t word = static_cast<uint32_t>(depths.word(left, row));
    const int32_t rows = end - row < lanes ? end - row : lanes;
    const auto some = load_some(depths.covered + word, rows);
    int32_t next = row + rows;
    for (uint32_t bits = bits_of(d, hn::Ne(some, hn::Zero(d))); bits != 0; bits &= bits - 1) {
      const uint32_t r = static_cast<uint32_t>(__builtin_ctz(bits));
      if (count > kMostPixels - 32) {
        next = row + static_cast<int32_t>(r);
        break;
      }
      count += store_bits(depths.covered[word + r], 32 * (word + r), pixels->at + count);
    }
    row = next;
  }
  for (uint32_t i = before; i < count; i += static_cast<uint32_t>(lanes)) {
    const auto at = hn::LoadU(d, pixels->at + i);
    const auto x = hn::Add(hn::And(at, hn::Set(d, 31U)), hn::Set(d, static_cast<uint32_t>(left)));
    const auto y =
        hn::Sub(hn::ShiftRight<5>(at), hn::Set(d, first_word - static_cast<uint32_t>(depths.first_row)));
    hn::StoreU(hn::BitCast(di, x), di, pixels->x + i);
    hn::StoreU(hn::BitCast(di, y), di, pixels->y + i);
  }
  pixels->count = count;
  return row;
}

void unpack(const Depths& depths, Pixels* pixels) {
  const U64 d;
  const HalfU32 d32;
  const uint32_t count = pixels->count;
  for (uint32_t i = count; i < count + hn::Lanes(U32()); ++i) {
    pixels->at[i] = pixels->at[0];
    pixels->x[i] = 0;
    pixels->y[i] = 0;
  }
  for (uint32_t i = 0; i < count + hn::Lanes(U32()); ++i) {
    pixels->value[i] = depths.nearest[pixels->at[i]];
  }
  for (uint32_t at = 0; at < count; at += static_cast<uint32_t>(hn::Lanes(d))) {
    const auto value = hn::LoadU(d, pixels->value + at);
    hn::StoreU(hn::TruncateTo(d32, hn::And(value, hn::Set(d, (uint64_t{1} << kEntryBits) - 1))), d32,
               pixels->number + at);
    const auto key = hn::And(hn::ShiftRight<kEntryBits>(value), hn::Set(d, 0x3FFFFFFFU));
    hn::StoreU(hn::TruncateTo(d32, key), d32, pixels->key + at);
    hn::StoreU(hn::TruncateTo(d32, hn::ShiftRight<kEntryBits + 30>(value)), d32, pixels->cube + at);
  }
}

// Finds exactly, in doubles, where rays enter the boxes that they hit, and the greys and faces of covered pixels.

// The exact rays of some pixels: integers, held in doubles.
struct Rays {
  hn::Vec<F64> origin[3];
  hn::Vec<F64> direction[3];
};

// Finds round(base + x * step_x + y * step_y) / 2^32, with halves away from zero. Each step is exact: high
// parts stay below 2^52, low parts below 2^36.
inline hn::Vec<F64> rounded(const WideFrame& frame, int axis, hn::Vec<F64> x, hn::Vec<F64> y) {
  const F64 d;
  const auto low =
      hn::MulAdd(x, hn::Set(d, frame.step_x_low[axis]),
                 hn::MulAdd(y, hn::Set(d, frame.step_y_low[axis]), hn::Set(d, frame.base_low[axis])));
  const auto high =
      hn::MulAdd(x, hn::Set(d, frame.step_x_high[axis]),
                 hn::MulAdd(y, hn::Set(d, frame.step_y_high[axis]), hn::Set(d, frame.base_high[axis])));
  const auto carry = hn::Floor(hn::Mul(low, hn::Set(d, 1.0 / (1 << 20))));
  const auto rest = hn::NegMulAdd(carry, hn::Set(d, 1 << 20), low);
  const auto whole = hn::Add(high, carry);
  // A negative number exactly half way between two integers goes down.
  const auto zero = hn::Zero(d);
  const auto half_way = hn::And(hn::Lt(whole, zero), hn::Eq(rest, zero));
  const auto moved = hn::Sub(hn::Add(whole, hn::Set(d, 2048)), hn::IfThenElseZero(half_way, hn::Set(d, 1)));
  return hn::Floor(hn::Mul(moved, hn::Set(d, 1.0 / 4096)));
}

template <bool kPerspective>
inline Rays rays_of(const WideFrame& frame, hn::Vec<F64> x, hn::Vec<F64> y) {
  const F64 d;
  Rays rays;
  for (int axis = 0; axis < 3; ++axis) {
    const auto varying = rounded(frame, axis, x, y);
    if (kPerspective) {
      rays.origin[axis] = hn::Set(d, static_cast<double>(frame.eye[axis]));
      rays.direction[axis] = varying;
    } else {
      rays.origin[axis] = hn::Add(hn::Set(d, static_cast<double>(frame.eye[axis])), varying);
      rays.direction[axis] = hn::Set(d, static_cast<double>(frame.direction[axis]));
    }
  }
  return rays;
}

// The mirrored corners that the keys of pixels stand for.
struct Corners {
  alignas(64) int32_t at[3][kMostPixels + 64];
};

void find_corners(const Pixels& pixels, Corners* corners) {
  const U32 d;
  static_assert(kEntryBits == 28 && kKeyBits == 36);
  for (size_t at = 0; at < pixels.count; at += hn::Lanes(d)) {
    const auto key = hn::LoadU(d, pixels.key + at);
    const auto cube = hn::LoadU(d, pixels.cube + at);
    const hn::Vec<U32> keys[3] = {key, hn::ShiftRight<1>(key), hn::ShiftRight<2>(key)};
    const hn::Vec<U32> cubes[3] = {cube, hn::ShiftRight<1>(cube), hn::ShiftRight<2>(cube)};
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const auto low = hn::And(cubes[axis], hn::Set(d, 1U));
      const auto high = hn::And(hn::ShiftRight<2>(cubes[axis]), hn::Set(d, 2U));
      const auto corner = hn::Or(gathered10(keys[axis]), hn::ShiftLeft<10>(hn::Or(low, high)));
      hn::StoreU(hn::BitCast(I32(), corner), I32(), corners->at[axis] + at);
    }
  }
}

// The planes through which rays enter the boxes that they hit: of the three axes' nearer planes the one that the ray
// passes last, on a tie that of the lowest axis. Times are compared as fractions, num_a |d_b| > num_b |d_a|, in
// integers below 2^44.
struct Entries {
  hn::Vec<F64> axis;       // -1: the ray starts inside
  hn::Vec<F64> numerator;  // t = numerator / (256 * speed)
  hn::Vec<F64> speed;      // |direction[axis]|
  hn::Vec<F64> direction[3];
};

template <bool kPerspective>
HWY_INLINE Entries entries_of(const WideFrame& frame, const Pixels& pixels, const Corners& corners,
                              size_t at) {
  const F64 d;
  const HalfI32 d32;
  const auto zero = hn::Zero(d);
  Entries found;
  const Rays rays = rays_of<kPerspective>(frame, hn::PromoteTo(d, hn::LoadU(d32, pixels.x + at)),
                                          hn::PromoteTo(d, hn::LoadU(d32, pixels.y + at)));
  auto side = hn::Set(d, 1);
  if (pixels.any_levels) {
    side = hn::PromoteTo(d, hn::Shl(hn::Set(d32, 1), hn::LoadU(d32, pixels.level + at)));
  }
  const auto size = hn::Mul(side, hn::Set(d, 256));
  // Corners are mirrored in a world of 4096 voxels.
  const auto last = hn::Sub(hn::Set(d, 4096), side);
  found.axis = hn::Set(d, -1);
  found.numerator = zero;
  found.speed = hn::Set(d, 1);
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    const auto downward = hn::Lt(rays.direction[axis], zero);
    const auto mirrored = hn::PromoteTo(d, hn::LoadU(d32, corners.at[axis] + at));
    const auto corner = hn::IfThenElse(downward, hn::Sub(last, mirrored), mirrored);
    const auto low = hn::Sub(hn::Mul(corner, hn::Set(d, 256)), rays.origin[axis]);
    const auto speed = hn::Abs(rays.direction[axis]);
    const auto distance = hn::IfThenElse(downward, hn::Neg(hn::Add(low, size)), low);
    // No ray enters through a plane at or behind its origin.
    const auto later = hn::And(hn::And(hn::Gt(distance, zero), hn::Gt(speed, zero)),
                               hn::Gt(hn::Mul(distance, found.speed), hn::Mul(found.numerator, speed)));
    found.axis = hn::IfThenElse(later, hn::Set(d, axis), found.axis);
    found.numerator = hn::IfThenElse(later, distance, found.numerator);
    found.speed = hn::IfThenElse(later, speed, found.speed);
    found.direction[axis] = rays.direction[axis];
  }
  if (!pixels.any_levels) {
    return found;
  }
  // The core names the face of the voxel by which a ray enters, also in a solid block. Where the ray passes from one
  // voxel to the next along a lower axis just as it enters the block, it enters the voxel by that axis' face, too, and
  // the lowest axis counts.
  const auto is_voxel = hn::Gt(hn::PromoteTo(d, hn::LoadU(d32, pixels.voxels + at)), zero);
  const auto block_axis = found.axis;
  const auto block_numerator = found.numerator;
  const auto block_speed = found.speed;
  for (int axis = 1; axis >= 0; --axis) {
    const auto speed = hn::Abs(rays.direction[axis]);
    const auto product = hn::Mul(block_numerator, speed);
    const auto way = hn::Round(hn::Div(product, block_speed));
    const auto place = hn::Add(rays.origin[axis], hn::CopySign(way, rays.direction[axis]));
    const auto voxel = hn::Mul(hn::Floor(hn::Mul(place, hn::Set(d, 1.0 / 256))), hn::Set(d, 256));
    auto passes = hn::And(is_voxel, hn::And(hn::Gt(block_axis, hn::Set(d, axis)), hn::Gt(speed, zero)));
    passes = hn::And(passes, hn::And(hn::Eq(hn::Mul(way, block_speed), product), hn::Eq(voxel, place)));
    found.axis = hn::IfThenElse(passes, hn::Set(d, axis), found.axis);
    found.numerator = hn::IfThenElse(passes, way, found.numerator);
    found.speed = hn::IfThenElse(passes, speed, found.speed);
  }
  return found;
}

HWY_INLINE void store_bytes(hn::Vec<HalfI32> values, uint8_t* to) {
  const HalfI32 d;
  HWY_ALIGN int32_t stored[64];
  hn::Store(values, d, stored);
  for (size_t i = 0; i < hn::Lanes(d); ++i) {
    to[i] = static_cast<uint8_t>(stored[i]);
  }
}

template <bool kPerspective>
void find_grays_of(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  Corners corners;
  find_corners(pixels, &corners);
  for (size_t at = 0; at < pixels.count; at += hn::Lanes(F64())) {
    const Entries found = entries_of<kPerspective>(frame, pixels, corners, at);
    store_bytes(grays_in_doubles(scale, found.numerator, found.speed), gray + at);
  }
}

void find_grays(const WideFrame& frame, const Pixels& pixels, const GrayScale& scale, uint8_t* gray) {
  frame.perspective ? find_grays_of<true>(frame, pixels, scale, gray)
                    : find_grays_of<false>(frame, pixels, scale, gray);
}

template <bool kPerspective>
void find_faces_of(const WideFrame& frame, const Pixels& pixels, uint8_t* face) {
  const F64 d;
  const HalfI32 d32;
  const size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  Corners corners;
  find_corners(pixels, &corners);
  for (size_t at = 0; at < pixels.count; at += lanes) {
    const Entries found = entries_of<kPerspective>(frame, pixels, corners, at);
    // A ray that starts inside has the face opposed to its largest component, on a tie that of the lowest axis.
    auto largest = hn::Abs(found.direction[0]);
    auto inside_axis = zero;
    for (int axis = 1; axis < 3; ++axis) {
      const auto size = hn::Abs(found.direction[axis]);
      inside_axis = hn::IfThenElse(hn::Gt(size, largest), hn::Set(d, axis), inside_axis);
      largest = hn::Max(size, largest);
    }
    const auto axis = hn::IfThenElse(hn::Lt(found.axis, zero), inside_axis, found.axis);
    auto component = found.direction[0];
    component = hn::IfThenElse(hn::Eq(axis, hn::Set(d, 1)), found.direction[1], component);
    component = hn::IfThenElse(hn::Eq(axis, hn::Set(d, 2)), found.direction[2], component);
    const auto upper = hn::IfThenElseZero(hn::Le(component, zero), hn::Set(d, 1));
    store_bytes(hn::DemoteTo(d32, hn::Add(hn::Add(axis, axis), upper)), face + at);
  }
}

void find_faces(const WideFrame& frame, const Pixels& pixels, uint8_t* face) {
  frame.perspective ? find_faces_of<true>(frame, pixels, face) : find_faces_of<false>(frame, pixels, face);
}

const char* instruction_set() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thimble::wide {

THIMBLE_KERNEL(find_children);
THIMBLE_KERNEL(find_covered);
THIMBLE_KERNEL(unpack);
THIMBLE_KERNEL(find_grays);
THIMBLE_KERNEL(put_colors);
THIMBLE_KERNEL(put_touched);
THIMBLE_KERNEL(find_faces);
THIMBLE_KERNEL(instruction_set);

int instruction_set_count() {
  hwy::SetSupportedTargetsForTest(0);
  return __builtin_popcountll(static_cast<uint64_t>(hwy::SupportedTargets() & HWY_TARGETS));
}
void use_instruction_set(int number) {
  hwy::SetSupportedTargetsForTest(0);
  if (number >= 0) {
    uint64_t targets = static_cast<uint64_t>(hwy::SupportedTargets() & HWY_TARGETS);
    for (; number > 0; --number) {
      targets &= targets - 1;
    }
    hwy::SetSupportedTargetsForTest(static_cast<int64_t>(targets & (0 - targets)));
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace thimble::wide
#endif
