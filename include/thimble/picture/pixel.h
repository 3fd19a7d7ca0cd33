/// @file pixel.h
/// The pixel formats of small displays, and how a colour is stored in them.
///
/// A picture is rows from the top, pixels from the left:
///
///   kMono1   1 bit, the leftmost pixel in the highest bit of a byte, 1 = lit (white); thresholded by an
///            8 x 8 ordered dither, so greys show as patterns
///   kGray4   4 bits, the left pixel in the high nibble, 15 = white
///   kGray8   1 byte, 255 = white
///   kRgb565  2 bytes, little-endian: rrrrrggg gggbbbbb
///   kRgb888  3 bytes: r, g, b
///
/// and as panels want them over a wire:
///
///   kRgb565Be    2 bytes, big-endian: ST7735, ST7789, ILI9341 in 16 bits
///   kBgr565      2 bytes, little-endian: bbbbbggg gggrrrrr
///   kRgb444      two pixels in 3 bytes, rrrrgggg bbbbrrrr ggggbbbb: ST7735, ST7789 in 12 bits; rounded to the
///                nearest of 16
///   kMono1Pages  1 bit in pages of 8 rows: a byte is a column of 8 pixels, the topmost in the lowest bit, 1 =
///                lit; dithered as kMono1. SSD1306, SH1106, ST7567. The page takes the place of a row: 8 rows
///                share the same bytes, and a band starts at a multiple of 8 (`band_row_multiple`)
///   kGray4Low    kGray4 with the left pixel in the low nibble
///   kGray2       2 bits, the leftmost pixel in the highest two, 3 = white; dithered between its 4 greys
///   kPaper3      black, white and red e-paper (SSD1680 and its like, which take two planes of 1 bit): for each
///                8 pixels a byte as kMono1, 1 = white, and behind it one with 1 = red; dithered. Both 0: black
///   kPaper7      4 bits, the left pixel in the high nibble, the colours of 7-colour e-paper (ACeP): 0 black, 1
///                white, 2 green, 3 blue, 4 red, 5 yellow, 6 orange; dithered
///   kRgb332      1 byte, rrrgggbb; rounded to the nearest
///
/// Rows start on whole bytes; unused bits at a row's end are 0. The grey of a colour is (77 r + 150 g + 29 b)
/// / 256 (Rec. 601 luma in 8 bits). All dithers are ordered ones in cells of 8 x 8 pixels.
///
/// What the core is compiled with chooses what an image has: THIMBLE_PANEL_FORMATS, a bit for each format by
/// its number (0x20 kRgb565Be ... 0x2000 kRgb332; without it all are there). One that was left out takes no
/// flash and no instruction; its bands are refused with kOutOfMemory. The first five are always there.
#ifndef THIMBLE_PICTURE_PIXEL_H
#define THIMBLE_PICTURE_PIXEL_H

#include <stddef.h>
#include <stdint.h>

#include "../base/status.h"  // refuses processors that are too small

namespace thimble {

enum class PixelFormat : uint8_t {
  kMono1,
  kGray4,
  kGray8,
  kRgb565,
  kRgb888,
  kRgb565Be,
  kBgr565,
  kRgb444,
  kMono1Pages,
  kGray4Low,
  kGray2,
  kPaper3,
  kPaper7,
  kRgb332,
};
inline constexpr int kPixelFormats = 14;

#ifndef THIMBLE_PANEL_FORMATS
#define THIMBLE_PANEL_FORMATS 0x3FE0U
#endif

/// Whether the core was compiled with that format.
constexpr bool has_format(PixelFormat format) {
  const unsigned number = static_cast<unsigned>(format);
  return ((0x1FU | (THIMBLE_PANEL_FORMATS & 0x3FE0U)) >> number & 1U) != 0;
}
/// Whether it was compiled with any of those behind kRgb888.
inline constexpr bool kHasPanelFormats = (THIMBLE_PANEL_FORMATS & 0x3FE0U) != 0;

/// A colour, 8 bits a channel, display-referred (what a display is sent).
struct Rgb8 {
  uint8_t r = 0;
  uint8_t g = 0;
  uint8_t b = 0;
  friend constexpr bool operator==(const Rgb8& one, const Rgb8& other) {
    return one.r == other.r && one.g == other.g && one.b == other.b;
  }
};

/// Whether it is one of those behind kRgb888, and any of them is there.
constexpr bool is_panel(PixelFormat format) {
  return kHasPanelFormats && format > PixelFormat::kRgb888;
}
/// Whether it is `kFormat`, and that is there: where it was left out nothing is compared.
template <PixelFormat kFormat>
constexpr bool is_format(PixelFormat format) {
  return has_format(kFormat) && format == kFormat;
}

/// What `bits_per_pixel` says of a format that was left out: more than anybody has bytes for.
inline constexpr int kAbsentFormatBits = 1 << 16;

namespace detail {
inline constexpr uint8_t kFormatBits[kPixelFormats] = {1, 4, 8, 16, 24, 16, 16, 12, 1, 4, 2, 2, 4, 8};
}  // namespace detail

constexpr int bits_per_pixel(PixelFormat format) {
  const unsigned number = static_cast<unsigned>(format);
  return number < kPixelFormats && has_format(format) ? detail::kFormatBits[number] : kAbsentFormatBits;
}

/// Whether the format shows greys only.
constexpr bool is_gray(PixelFormat format) {
  return format == PixelFormat::kMono1 || format == PixelFormat::kGray4 || format == PixelFormat::kGray8 ||
         is_format<PixelFormat::kMono1Pages>(format) || is_format<PixelFormat::kGray4Low>(format) ||
         is_format<PixelFormat::kGray2>(format);
}

/// Whether 8 rows share the bytes of one, the page.
constexpr bool has_pages(PixelFormat format) {
  return is_format<PixelFormat::kMono1Pages>(format);
}
/// Rows that a format keeps together: a band starts at a multiple of them and holds one, unless it ends with
/// the picture. 8 for kMono1Pages, else 1.
constexpr int32_t band_row_multiple(PixelFormat format) {
  return has_pages(format) ? 8 : 1;
}
/// `rows` (0 .. 2^31 - 8), rounded up to that multiple.
constexpr int32_t whole_rows(PixelFormat format, int32_t rows) {
  return has_pages(format) ? (rows + 7) & ~7 : rows;
}
/// Where the bytes of a row lie, counted in `row_bytes`: its number, or that of its page.
constexpr size_t row_place(PixelFormat format, int32_t row) {
  return static_cast<size_t>(has_pages(format) ? row >> 3 : row);
}
/// Whether a row is the first of those that share its bytes, and so is to clear them.
constexpr bool begins_bytes(PixelFormat format, int32_t row) {
  return !has_pages(format) || (row & 7) == 0;
}

/// Bytes of one row of `width_px` pixels (at least 0), or of one page: a byte a column.
constexpr size_t row_bytes(PixelFormat format, int32_t width_px) {
  if (has_pages(format)) {
    return static_cast<size_t>(width_px);
  }
  if (is_format<PixelFormat::kPaper3>(format)) {
    return (static_cast<size_t>(width_px) + 7) / 8 * 2;  // pairs of bytes
  }
  return (static_cast<size_t>(width_px) * static_cast<size_t>(bits_per_pixel(format)) + 7) / 8;
}

/// Bound on `gray_of` against Rec. 601's 0.299 r + 0.587 g + 0.114 b: coefficients of 8 bits, rounded down.
inline constexpr int kGrayError = 2;
/// What kRgb565 loses of a channel of 5 bits.
inline constexpr int kRgb565Error = 7;

constexpr uint8_t gray_of(Rgb8 color) {
  return static_cast<uint8_t>((77U * color.r + 150U * color.g + 29U * color.b) >> 8);
}

/// Place of a pixel in Bayer's 8 x 8 matrix, 0 .. 63 (B. E. Bayer, "An optimum method for two-level rendition
/// of continuous-tone pictures", ICC 1973).
constexpr unsigned bayer_rank(int32_t x, int32_t y) {
  const unsigned column = static_cast<unsigned>(x);
  const unsigned across = column ^ static_cast<unsigned>(y);
  unsigned rank = 0;
  for (unsigned bit = 0; bit < 3; ++bit) {
    rank = rank << 2 | ((across >> bit) & 1U) << 1 | ((column >> bit) & 1U);
  }
  return rank;
}

/// Whether a pixel of that grey at column `x`, row `y` is lit in 1 bit. 0 is never lit, 255 always.
constexpr bool dithered(uint8_t gray, int32_t x, int32_t y) {
  return gray > 2 + bayer_rank(x, y) * 4;
}

/// Stores the pixel in one of the formats behind kRgb888, as `store_pixel` does: that is what calls it.
void store_panel_pixel(uint8_t* row, int32_t x, int32_t y, PixelFormat format, Rgb8 color);

/// Clears a pixel of these formats, so that another one may be stored over it.
void clear_panel_pixel(uint8_t* row, int32_t x, int32_t y, PixelFormat format);

/// Stores the pixel of column `x` into its `row` (row_bytes(format, width) bytes). `y` is the row's number on
/// the picture, which tells the dither its place and a page the bit. For formats whose pixels share bytes
/// (all below 8 bits, and kRgb444) the row's bytes are cleared before its first pixel is stored.
constexpr void store_pixel(uint8_t* row, int32_t x, int32_t y, PixelFormat format, Rgb8 color) {
  const size_t column = static_cast<size_t>(x);
  switch (format) {
    case PixelFormat::kMono1:
      if (dithered(gray_of(color), x, y)) {
        row[column >> 3] = static_cast<uint8_t>(row[column >> 3] | 0x80U >> (column & 7U));
      }
      return;
    case PixelFormat::kGray4: {
      // Rounded to the nearest of 16 greys, which are 17 apart: (g + 8) / 17.
      const unsigned level = ((gray_of(color) + 8U) * 241U) >> 12;
      row[column >> 1] = static_cast<uint8_t>(row[column >> 1] | level << ((column & 1U) != 0 ? 0 : 4));
      return;
    }
    case PixelFormat::kGray8:
      row[column] = gray_of(color);
      return;
    case PixelFormat::kRgb565: {
      const unsigned packed = (color.r & 0xF8U) << 8 | (color.g & 0xFCU) << 3 | color.b >> 3U;
      row[2 * column] = static_cast<uint8_t>(packed);
      row[2 * column + 1] = static_cast<uint8_t>(packed >> 8);
      return;
    }
    case PixelFormat::kRgb888:
      row[3 * column] = color.r;
      row[3 * column + 1] = color.g;
      row[3 * column + 2] = color.b;
      return;
    default:
      if constexpr (kHasPanelFormats) {
        store_panel_pixel(row, x, y, format, color);
      }
      return;
  }
}

/// What a display shows of a stored pixel, 0 .. 255 a channel: the darkest and the lightest value of a format
/// become 0 and 255, and what lies between is spread evenly (16 greys are 17 apart). Of kPaper7 the colours
/// by their names: orange is 255, 128, 0.
Rgb8 load_pixel(const uint8_t* row, int32_t x, int32_t y, PixelFormat format);

}  // namespace thimble

#endif
