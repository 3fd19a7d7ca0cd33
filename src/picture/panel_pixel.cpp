// The formats behind kRgb888, pixel by pixel. One copy of them, which an image without such formats does not
// have.
#include "panels.h"

namespace thimble {
namespace {

using namespace panels;

void set_bits(uint8_t* bytes, size_t place, unsigned bits) {
  bytes[place] = static_cast<uint8_t>(bytes[place] | bits);
}

void store_halfword(uint8_t* bytes, size_t column, uint32_t packed) {
  bytes[2 * column] = static_cast<uint8_t>(packed);
  bytes[2 * column + 1] = static_cast<uint8_t>(packed >> 8);
}

// Two pixels take three bytes: the left one the first byte and the high half of the second.
void store_rgb444(uint8_t* row, size_t column, Rgb8 color) {
  const unsigned r = level_of_16(color.r);
  const unsigned g = level_of_16(color.g);
  const unsigned b = level_of_16(color.b);
  uint8_t* const pair = row + column / 2 * 3;
  if ((column & 1U) == 0) {
    set_bits(pair, 0, r << 4 | g);
    set_bits(pair, 1, b << 4);
  } else {
    set_bits(pair, 1, r);
    set_bits(pair, 2, g << 4 | b);
  }
}

// Clears the bits `mask` of a byte.
void drop(uint8_t* bytes, size_t place, unsigned mask) {
  bytes[place] = static_cast<uint8_t>(bytes[place] & ~mask);
}

}  // namespace

void clear_panel_pixel(uint8_t* row, int32_t x, int32_t y, PixelFormat format) {
  const size_t column = static_cast<size_t>(x);
  const bool left = (column & 1U) == 0;
  if (is_format<PixelFormat::kRgb444>(format)) {
    drop(row, column / 2 * 3 + (left ? 0 : 2), 0xFFU);
    drop(row, column / 2 * 3 + 1, left ? 0xF0U : 0x0FU);
  } else if (has_pages(format)) {
    drop(row, column, 1U << (y & 7));
  } else if (is_format<PixelFormat::kGray4Low>(format)) {
    drop(row, column >> 1, left ? 0x0FU : 0xF0U);
  } else if (is_format<PixelFormat::kGray2>(format)) {
    drop(row, column >> 2, 0xC0U >> 2 * (column & 3U));
  } else if (is_format<PixelFormat::kPaper3>(format)) {
    drop(row, 2 * (column >> 3), 0x80U >> (column & 7U));
    drop(row, 2 * (column >> 3) + 1, 0x80U >> (column & 7U));
  } else if (is_format<PixelFormat::kPaper7>(format)) {
    drop(row, column >> 1, left ? 0xF0U : 0x0FU);
  }
}

void store_panel_pixel(uint8_t* row, int32_t x, int32_t y, PixelFormat format, Rgb8 color) {
  const size_t column = static_cast<size_t>(x);
  const unsigned threshold = threshold_of(x, y);
  if (is_format<PixelFormat::kRgb565Be>(format)) {
    store_halfword(row, column, rgb565_be(color));
  } else if (is_format<PixelFormat::kBgr565>(format)) {
    store_halfword(row, column, bgr565(color));
  } else if (is_format<PixelFormat::kRgb444>(format)) {
    store_rgb444(row, column, color);
  } else if (is_format<PixelFormat::kMono1Pages>(format)) {
    set_bits(row, column, gray_of(color) > threshold ? 1U << (y & 7) : 0);
  } else if (is_format<PixelFormat::kGray4Low>(format)) {
    set_bits(row, column >> 1, level_of_16(gray_of(color)) << ((column & 1U) != 0 ? 4 : 0));
  } else if (is_format<PixelFormat::kGray2>(format)) {
    set_bits(row, column >> 2, gray2(gray_of(color), threshold) << (6 - 2 * (column & 3U)));
  } else if (is_format<PixelFormat::kPaper3>(format)) {
    const Paper3 ink = paper3(color, threshold);
    const unsigned bit = 0x80U >> (column & 7U);
    set_bits(row, 2 * (column >> 3), ink == Paper3::kWhite ? bit : 0);
    set_bits(row, 2 * (column >> 3) + 1, ink == Paper3::kRed ? bit : 0);
  } else if (is_format<PixelFormat::kPaper7>(format)) {
    set_bits(row, column >> 1, paper7(color, threshold) << ((column & 1U) != 0 ? 0 : 4));
  } else if (is_format<PixelFormat::kRgb332>(format)) {
    row[column] = static_cast<uint8_t>(rgb332(color));
  }
}

}  // namespace thimble
