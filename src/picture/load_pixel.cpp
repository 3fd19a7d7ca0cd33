// From stored pixels back to what a display shows.
#include "panels.h"

namespace thimble {
namespace {

constexpr Rgb8 gray(unsigned value) {
  const uint8_t channel = static_cast<uint8_t>(value);
  return {channel, channel, channel};
}

// Levels of 5 and 6 bits over 0 .. 255: their upper bits are repeated below.
constexpr uint8_t from_5(unsigned level) {
  return static_cast<uint8_t>(level << 3 | level >> 2);
}
constexpr uint8_t from_6(unsigned level) {
  return static_cast<uint8_t>(level << 2 | level >> 4);
}
constexpr uint8_t from_4(unsigned level) {
  return static_cast<uint8_t>(level * 17);
}

unsigned nibble(const uint8_t* row, size_t column, bool left_is_high) {
  return ((column & 1U) != 0) == left_is_high ? row[column >> 1] & 15U : row[column >> 1] >> 4U;
}

Rgb8 load_565(unsigned packed) {
  return {from_5(packed >> 11), from_6(packed >> 5 & 63U), from_5(packed & 31U)};
}

Rgb8 load_panel_pixel(const uint8_t* row, size_t column, int32_t y, PixelFormat format) {
  if (is_format<PixelFormat::kRgb565Be>(format)) {
    return load_565(static_cast<unsigned>(row[2 * column]) << 8 | row[2 * column + 1]);
  }
  if (is_format<PixelFormat::kBgr565>(format)) {
    const Rgb8 swapped = load_565(row[2 * column] | static_cast<unsigned>(row[2 * column + 1]) << 8);
    return {swapped.b, swapped.g, swapped.r};
  }
  if (is_format<PixelFormat::kRgb444>(format)) {
    const uint8_t* const pair = row + column / 2 * 3;
    if ((column & 1U) == 0) {
      return {from_4(pair[0] >> 4U), from_4(pair[0] & 15U), from_4(pair[1] >> 4U)};
    }
    return {from_4(pair[1] & 15U), from_4(pair[2] >> 4U), from_4(pair[2] & 15U)};
  }
  if (has_pages(format)) {
    return gray((row[column] >> (y & 7) & 1) != 0 ? 255 : 0);
  }
  if (is_format<PixelFormat::kGray4Low>(format)) {
    return gray(nibble(row, column, false) * 17);
  }
  if (is_format<PixelFormat::kGray2>(format)) {
    return gray((static_cast<unsigned>(row[column >> 2]) >> (6 - 2 * (column & 3U)) & 3U) * 85);
  }
  if (is_format<PixelFormat::kPaper3>(format)) {
    const unsigned bit = 0x80U >> (column & 7U);
    const uint8_t* const pair = row + 2 * (column >> 3);
    return (pair[1] & bit) != 0 ? Rgb8{255, 0, 0} : gray((pair[0] & bit) != 0 ? 255 : 0);
  }
  if (is_format<PixelFormat::kPaper7>(format)) {
    return panels::kPaperColors[nibble(row, column, true) & 7U];
  }
  if (is_format<PixelFormat::kRgb332>(format)) {
    const unsigned packed = row[column];
    const auto from_3 = [](unsigned level) {
      return static_cast<uint8_t>(level << 5 | level << 2 | level >> 1);
    };
    return {from_3(packed >> 5), from_3(packed >> 2 & 7U), static_cast<uint8_t>((packed & 3U) * 85)};
  }
  return {};
}

}  // namespace

Rgb8 load_pixel(const uint8_t* row, int32_t x, int32_t y, PixelFormat format) {
  const size_t column = static_cast<size_t>(x);
  switch (format) {
    case PixelFormat::kMono1:
      return gray((row[column >> 3] << (column & 7U) & 0x80) != 0 ? 255 : 0);
    case PixelFormat::kGray4:
      return gray(nibble(row, column, true) * 17);
    case PixelFormat::kGray8:
      return gray(row[column]);
    case PixelFormat::kRgb565:
      return load_565(row[2 * column] | static_cast<unsigned>(row[2 * column + 1]) << 8);
    case PixelFormat::kRgb888:
      return {row[3 * column], row[3 * column + 1], row[3 * column + 2]};
    default:
      return load_panel_pixel(row, column, y, format);
  }
}

}  // namespace thimble
