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
/// Rows start on whole bytes; unused bits at a row's end are 0. The grey of a colour is (77 r + 150 g + 29 b)
/// / 256 (Rec. 601 luma in 8 bits).
#ifndef THIMBLE_PICTURE_PIXEL_H
#define THIMBLE_PICTURE_PIXEL_H

#include <stddef.h>
#include <stdint.h>

namespace thimble {

enum class PixelFormat : uint8_t { kMono1, kGray4, kGray8, kRgb565, kRgb888 };

/// A colour, 8 bits a channel, display-referred (what a display is sent).
struct Rgb8 {
  uint8_t r = 0;
  uint8_t g = 0;
  uint8_t b = 0;
  friend constexpr bool operator==(const Rgb8& one, const Rgb8& other) {
    return one.r == other.r && one.g == other.g && one.b == other.b;
  }
};

constexpr int bits_per_pixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::kMono1:
      return 1;
    case PixelFormat::kGray4:
      return 4;
    case PixelFormat::kGray8:
      return 8;
    case PixelFormat::kRgb565:
      return 16;
    case PixelFormat::kRgb888:
      return 24;
  }
  return 0;
}

/// Bytes of one row of `width_px` pixels (at least 0).
constexpr size_t row_bytes(PixelFormat format, int32_t width_px) {
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

/// Stores the pixel of column `x` into its `row` (row_bytes(format, width) bytes). `y` is the row's number on
/// the picture, which only the dither looks at. For formats below a byte the row's bytes are cleared before
/// its first pixel is stored.
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
  }
}

}  // namespace thimble

#endif
