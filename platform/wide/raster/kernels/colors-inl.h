/// Turns the codes of a finished picture into pixels of whole bytes.
#if defined(THIMBLE_WIDE_RASTER_KERNELS_COLORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef THIMBLE_WIDE_RASTER_KERNELS_COLORS_INL_H_
#undef THIMBLE_WIDE_RASTER_KERNELS_COLORS_INL_H_
#else
#define THIMBLE_WIDE_RASTER_KERNELS_COLORS_INL_H_
#endif

#include "wide/raster/kernels.h"
#include "wide/raster/kernels/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace thimble::wide::HWY_NAMESPACE {
namespace {

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

}  // namespace
}  // namespace thimble::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
