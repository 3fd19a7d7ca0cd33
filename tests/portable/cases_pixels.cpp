// Pixels in every format, and the dither.
#include "portable/groups.h"

namespace thimble::portable {
namespace {

constexpr PixelFormat kFormats[] = {PixelFormat::kMono1, PixelFormat::kGray4, PixelFormat::kGray8,
                                    PixelFormat::kRgb565, PixelFormat::kRgb888};
constexpr Rgb8 kBlack{0, 0, 0};
constexpr Rgb8 kWhite{255, 255, 255};

constexpr Rgb8 gray(int value) {
  const uint8_t channel = static_cast<uint8_t>(value);
  return {channel, channel, channel};
}

// Stores one row of `colors` and compares its bytes.
void expect_row(Check& check, PixelFormat format, Span<const Rgb8> colors, ConstBytes wanted, What what) {
  uint8_t row[16] = {};
  for (size_t x = 0; x < colors.size; ++x) {
    store_pixel(row, static_cast<int32_t>(x), 0, format, colors[x]);
  }
  const size_t size = row_bytes(format, static_cast<int32_t>(colors.size));
  check.equal(ConstBytes(row, size), wanted, what);
}

// Bayer's matrix of side 8 by its definition: four copies of the one half as large, times 4, plus 0, 3, 2, 1
// (left to right, top to bottom).
int bayer(int x, int y) {
  constexpr int kOffset[2][2] = {{0, 3}, {2, 1}};
  int value = 0;
  int weight = 1;
  for (int half = 4; half > 0; half /= 2) {
    value += weight * kOffset[y / half % 2][x / half % 2];
    weight *= 4;
  }
  return value;
}
// The least grey that lights the pixel: 256 when none does.
int threshold_at(int x, int y) {
  int value = 0;
  while (value < 256 && !dithered(static_cast<uint8_t>(value), x, y)) {
    ++value;
  }
  return value;
}
int lit_of_64(int value) {
  int lit = 0;
  for (int i = 0; i < 64; ++i) {
    lit += dithered(static_cast<uint8_t>(value), i % 8, i / 8) ? 1 : 0;
  }
  return lit;
}

// A white row of every width up to 19 between two guard bytes: all of its bits, and no other.
void white_rows(Check& check, int format_index) {
  const PixelFormat format = kFormats[format_index];
  for (int width = 1; width < 20; ++width) {
    uint8_t row[60] = {};
    const size_t bytes = row_bytes(format, width);
    row[0] = row[bytes + 1] = 0xA5;
    for (int x = 0; x < width; ++x) {
      store_pixel(row + 1, x, 5, format, kWhite);
    }
    THIMBLE_EQUAL(row[0], 0xA5);
    THIMBLE_EQUAL(row[bytes + 1], 0xA5);
    bool right = true;
    for (size_t bit = 0; bit < 8 * bytes; ++bit) {
      const bool one = (static_cast<unsigned>(row[1 + bit / 8]) >> (7 - bit % 8) & 1U) != 0;
      right = right && one == (bit < static_cast<size_t>(width * bits_per_pixel(format)));
    }
    THIMBLE_CHECK(right);
    check.note_bytes({row + 1, bytes});
  }
}

constexpr Case kCases[] = {
    {"bits_per_pixel: every format -> 1, 4, 8, 16, 24", 0,
     [](Check& check, int) {
       constexpr int kBits[] = {1, 4, 8, 16, 24};
       for (int i = 0; i < 5; ++i) {
         THIMBLE_EQUAL(bits_per_pixel(kFormats[i]), kBits[i]);
       }
     }},
    {"row_bytes: every format and width up to 99 -> bits rounded up to whole bytes", 0,
     [](Check& check, int) {
       for (const PixelFormat format : kFormats) {
         for (int width = 0; width < 100; ++width) {
           const int bits = width * bits_per_pixel(format);
           THIMBLE_EQUAL(row_bytes(format, width), static_cast<uint32_t>(bits / 8 + (bits % 8 != 0 ? 1 : 0)));
         }
       }
     }},
    {"gray_of: white, black and primaries -> Rec. 601 luma in 8 bits", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(gray_of(kWhite), 255);
       THIMBLE_EQUAL(gray_of(kBlack), 0);
       THIMBLE_EQUAL(gray_of({255, 0, 0}), 76);
       THIMBLE_EQUAL(gray_of({0, 255, 0}), 149);
       THIMBLE_EQUAL(gray_of({0, 0, 255}), 28);
     }},
    {"mono1: leftmost pixel -> highest bit", 0,
     [](Check& check, int) {
       const Rgb8 one[] = {kWhite};
       const uint8_t first[] = {0x80};
       expect_row(check, PixelFormat::kMono1, one, first, THIMBLE_HERE);
       const Rgb8 five[] = {kBlack, kWhite, kBlack, kBlack, kWhite};
       const uint8_t second[] = {0x48};
       expect_row(check, PixelFormat::kMono1, five, second, THIMBLE_HERE);
     }},
    {"mono1: eleven pixels -> two bytes, unused bits 0", 0,
     [](Check& check, int) {
       Rgb8 eleven[11];
       for (Rgb8& color : eleven) {
         color = kWhite;
       }
       const uint8_t all[] = {0xFF, 0xE0};
       expect_row(check, PixelFormat::kMono1, eleven, all, THIMBLE_HERE);
       eleven[8] = kBlack;
       const uint8_t gap[] = {0xFF, 0x60};
       expect_row(check, PixelFormat::kMono1, eleven, gap, THIMBLE_HERE);
     }},
    {"gray4: left pixel -> high nibble, unused nibble 0", 0,
     [](Check& check, int) {
       const Rgb8 colors[] = {gray(17), gray(34), gray(170)};
       const uint8_t wanted[] = {0x12, 0xA0};
       expect_row(check, PixelFormat::kGray4, colors, wanted, THIMBLE_HERE);
     }},
    {"gray4: every grey -> the nearest of 16", 0,
     [](Check& check, int) {
       for (int value = 0; value < 256; ++value) {
         uint8_t row[1] = {};
         store_pixel(row, 0, 0, PixelFormat::kGray4, gray(value));
         const int level = row[0] >> 4;
         THIMBLE_CHECK(value - 17 * level <= 8 && 17 * level - value <= 8);
         store_pixel(row, 1, 0, PixelFormat::kGray4, gray(value));
         THIMBLE_EQUAL(row[0], level * 17);
       }
     }},
    {"gray8: a colour -> its grey", 0,
     [](Check& check, int) {
       const Rgb8 colors[] = {gray(1), {255, 0, 0}, gray(254)};
       const uint8_t wanted[] = {1, 76, 254};
       expect_row(check, PixelFormat::kGray8, colors, wanted, THIMBLE_HERE);
     }},
    {"rgb888: channels in order", 0,
     [](Check& check, int) {
       const Rgb8 colors[] = {{1, 2, 3}, {250, 251, 252}};
       const uint8_t wanted[] = {1, 2, 3, 250, 251, 252};
       expect_row(check, PixelFormat::kRgb888, colors, wanted, THIMBLE_HERE);
     }},
    {"rgb565: 5 red, 6 green, 5 blue bits -> little-endian, red highest", 0,
     [](Check& check, int) {
       const Rgb8 colors[] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}};
       const uint8_t wanted[] = {0x00, 0xF8, 0xE0, 0x07, 0x1F, 0x00};
       expect_row(check, PixelFormat::kRgb565, colors, wanted, THIMBLE_HERE);
     }},
    {"rgb565: the lower bits -> cut off", 0,
     [](Check& check, int) {
       const Rgb8 colors[] = {{7, 3, 7}, {8, 4, 8}};
       const uint8_t wanted[] = {0x00, 0x00, 0x21, 0x08};
       expect_row(check, PixelFormat::kRgb565, colors, wanted, THIMBLE_HERE);
     }},
    {"white rows of any width -> all their bits and no other", 0, white_rows, 0, "format", 5},
    {"dithered: thresholds of a cell -> Bayer's matrix by its definition", 0,
     [](Check& check, int) {
       for (int y = 0; y < 8; ++y) {
         for (int x = 0; x < 8; ++x) {
           THIMBLE_EQUAL(threshold_at(x, y), 3 + 4 * bayer(x, y));
         }
       }
     }},
    {"dithered: far cells -> the same as the first", 0,
     [](Check& check, int) {
       for (int i = 0; i < 64; ++i) {
         THIMBLE_EQUAL(threshold_at(i % 8 + 16376, i / 8 + 8), threshold_at(i % 8, i / 8));
       }
     }},
    {"dithered: black, white -> never lit, always lit", 0,
     [](Check& check, int) {
       THIMBLE_EQUAL(lit_of_64(0), 0);
       THIMBLE_EQUAL(lit_of_64(255), 64);
     }},
    {"dithered: every grey -> as much of a cell as it is bright, within a 64th", 0,
     [](Check& check, int) {
       int before = 0;
       for (int value = 0; value < 256; ++value) {
         const int lit = lit_of_64(value);
         THIMBLE_CHECK(lit >= before && lit * 255 >= value * 64 - 255 && lit * 255 <= value * 64 + 255);
         before = lit;
       }
     }},
};

}  // namespace

const Group kPixelGroup = group_of<kCases>("pixel", "cases_pixels.cpp");

}  // namespace thimble::portable
