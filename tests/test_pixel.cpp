#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "thimble/pixel.h"

namespace {

using namespace thimble;

constexpr PixelFormat kFormats[] = {PixelFormat::kMono1, PixelFormat::kGray4, PixelFormat::kGray8,
                                    PixelFormat::kRgb565, PixelFormat::kRgb888};
constexpr Rgb8 kBlack{0, 0, 0};
constexpr Rgb8 kWhite{255, 255, 255};

Rgb8 gray(int value) {
  const auto channel = static_cast<std::uint8_t>(value);
  return {channel, channel, channel};
}

/// One row, cleared and stored.
std::vector<std::uint8_t> row_of(PixelFormat format, const std::vector<Rgb8>& colors, int y = 0) {
  std::vector<std::uint8_t> row(row_bytes(format, static_cast<int>(colors.size())));
  for (std::size_t x = 0; x < colors.size(); ++x) {
    store_pixel(row.data(), static_cast<int>(x), y, format, colors[x]);
  }
  return row;
}

/// Bayer's matrix of side 2^order by its definition: four copies of the smaller one, times 4, plus 0, 3, 2, 1
/// (left to right, top to bottom).
std::vector<std::vector<int>> bayer(int order) {
  if (order == 0) {
    return {{0}};
  }
  const auto smaller = bayer(order - 1);
  const std::size_t half = smaller.size();
  std::vector<std::vector<int>> matrix(2 * half, std::vector<int>(2 * half));
  constexpr int kOffset[2][2] = {{0, 3}, {2, 1}};
  for (std::size_t y = 0; y < 2 * half; ++y) {
    for (std::size_t x = 0; x < 2 * half; ++x) {
      matrix[y][x] = 4 * smaller[y % half][x % half] + kOffset[y / half][x / half];
    }
  }
  return matrix;
}

/// The least grey that lights the pixel: 256 when none does.
int threshold_at(int x, int y) {
  int value = 0;
  while (value < 256 && !dithered(static_cast<std::uint8_t>(value), x, y)) {
    ++value;
  }
  return value;
}

}  // namespace

TEST_CASE("row_bytes: every format and width -> bits rounded up to whole bytes") {
  CHECK(row_bytes(PixelFormat::kMono1, 0) == 0);
  CHECK(row_bytes(PixelFormat::kMono1, 1) == 1);
  CHECK(row_bytes(PixelFormat::kMono1, 8) == 1);
  CHECK(row_bytes(PixelFormat::kMono1, 9) == 2);
  CHECK(row_bytes(PixelFormat::kGray4, 1) == 1);
  CHECK(row_bytes(PixelFormat::kGray4, 2) == 1);
  CHECK(row_bytes(PixelFormat::kGray4, 61) == 31);
  CHECK(row_bytes(PixelFormat::kGray8, 61) == 61);
  CHECK(row_bytes(PixelFormat::kRgb565, 61) == 122);
  CHECK(row_bytes(PixelFormat::kRgb888, 16384) == 49152);
  for (const PixelFormat format : kFormats) {
    for (int width = 0; width < 100; ++width) {
      const std::size_t bits = static_cast<std::size_t>(width * bits_per_pixel(format));
      CHECK(row_bytes(format, width) == bits / 8 + (bits % 8 != 0 ? 1 : 0));
    }
  }
}

TEST_CASE("gray_of: white, black and primaries -> Rec. 601 luma in 8 bits") {
  CHECK(gray_of(kWhite) == 255);
  CHECK(gray_of(kBlack) == 0);
  CHECK(gray_of({255, 0, 0}) == 76);
  CHECK(gray_of({0, 255, 0}) == 149);
  CHECK(gray_of({0, 0, 255}) == 28);
  for (int value = 0; value < 256; ++value) {
    CHECK(gray_of(gray(value)) == value);
  }
}

TEST_CASE("store_pixel mono1: leftmost pixel -> highest bit, unused bits 0") {
  CHECK(row_of(PixelFormat::kMono1, {kWhite}) == std::vector<std::uint8_t>{0x80});
  CHECK(row_of(PixelFormat::kMono1, {kBlack, kWhite, kBlack, kBlack, kWhite}) ==
        std::vector<std::uint8_t>{0x48});
  std::vector<Rgb8> eleven(11, kWhite);
  CHECK(row_of(PixelFormat::kMono1, eleven) == std::vector<std::uint8_t>{0xFF, 0xE0});
  eleven[8] = kBlack;
  CHECK(row_of(PixelFormat::kMono1, eleven) == std::vector<std::uint8_t>{0xFF, 0x60});
}

TEST_CASE("store_pixel gray4: left pixel -> high nibble, unused nibble 0") {
  CHECK(row_of(PixelFormat::kGray4, {kWhite}) == std::vector<std::uint8_t>{0xF0});
  CHECK(row_of(PixelFormat::kGray4, {gray(17), gray(34), gray(170)}) ==
        std::vector<std::uint8_t>{0x12, 0xA0});
}

TEST_CASE("store_pixel gray4: every grey -> rounded to the nearest of 16") {
  for (int value = 0; value < 256; ++value) {
    const int level = (value + 8) / 17;
    CHECK(row_of(PixelFormat::kGray4, {gray(value)})[0] == level << 4);
    CHECK(row_of(PixelFormat::kGray4, {kBlack, gray(value)})[0] == level);
    // The nearest indeed.
    CHECK(level <= 15);
    CHECK(value - 17 * level <= 8);
    CHECK(17 * level - value <= 8);
  }
}

TEST_CASE("store_pixel gray8, rgb888: channels in order") {
  CHECK(row_of(PixelFormat::kGray8, {gray(1), {255, 0, 0}, gray(254)}) ==
        std::vector<std::uint8_t>{1, 76, 254});
  CHECK(row_of(PixelFormat::kRgb888, {{1, 2, 3}, {250, 251, 252}}) ==
        std::vector<std::uint8_t>{1, 2, 3, 250, 251, 252});
}

TEST_CASE("store_pixel rgb565: 5 red, 6 green and 5 blue bits -> little-endian, red highest") {
  CHECK(row_of(PixelFormat::kRgb565, {{255, 0, 0}}) == std::vector<std::uint8_t>{0x00, 0xF8});
  CHECK(row_of(PixelFormat::kRgb565, {{0, 255, 0}}) == std::vector<std::uint8_t>{0xE0, 0x07});
  CHECK(row_of(PixelFormat::kRgb565, {{0, 0, 255}}) == std::vector<std::uint8_t>{0x1F, 0x00});
  // The lower bits are cut off; the second pixel lies behind the first.
  CHECK(row_of(PixelFormat::kRgb565, {{7, 3, 7}, {8, 4, 8}}) ==
        std::vector<std::uint8_t>{0x00, 0x00, 0x21, 0x08});
}

TEST_CASE("store_pixel: every format and odd width -> nothing beyond the row, all its bits used") {
  for (const PixelFormat format : kFormats) {
    for (int width = 1; width < 20; ++width) {
      CAPTURE(bits_per_pixel(format));
      CAPTURE(width);
      const std::size_t bytes = row_bytes(format, width);
      std::vector<std::uint8_t> row(bytes + 2, 0);
      row[0] = row[bytes + 1] = 0xA5;
      for (int x = 0; x < width; ++x) {
        store_pixel(row.data() + 1, x, 5, format, kWhite);
      }
      CHECK(row[0] == 0xA5);
      CHECK(row[bytes + 1] == 0xA5);
      std::size_t lit = 0;
      for (std::size_t bit = 0; bit < 8 * bytes; ++bit) {
        const bool one = ((row[1 + bit / 8] >> (7 - bit % 8)) & 1) != 0;
        lit += one ? 1 : 0;
        CHECK(one == (bit < static_cast<std::size_t>(width * bits_per_pixel(format))));
      }
      CHECK(lit == static_cast<std::size_t>(width * bits_per_pixel(format)));
    }
  }
}

TEST_CASE("dithered: thresholds of a cell -> Bayer's matrix by its recursive definition") {
  const auto matrix = bayer(3);
  std::set<int> thresholds;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const int threshold = threshold_at(x, y);
      thresholds.insert(threshold);
      CAPTURE(x);
      CAPTURE(y);
      CHECK(threshold == 3 + 4 * matrix[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]);
      CHECK(threshold == threshold_at(x + 8, y));
      CHECK(threshold == threshold_at(x + 16376, y + 16376));
    }
  }
  CHECK(thresholds.size() == 64);
}

TEST_CASE("dithered: every grey -> more of a cell is lit than for a darker one, from none to all") {
  int before = 0;
  for (int value = 0; value < 256; ++value) {
    int lit = 0;
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 8; ++x) {
        lit += dithered(static_cast<std::uint8_t>(value), x, y) ? 1 : 0;
      }
    }
    CHECK(lit >= before);
    // As bright as the grey: within a 64th.
    CHECK(lit * 255 >= value * 64 - 255);
    CHECK(lit * 255 <= value * 64 + 255);
    before = lit;
    if (value == 0) {
      CHECK(lit == 0);
    }
  }
  CHECK(before == 64);
}
