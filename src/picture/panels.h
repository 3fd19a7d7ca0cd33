// What the formats behind kRgb888 make of a colour. Internal to src/.
#pragma once

#include "thimble/picture/pixel.h"

namespace thimble::panels {

/// The nearest of 16 levels, which are 17 apart: (value + 8) / 17.
constexpr unsigned level_of_16(unsigned value) {
  return ((value + 8) * 241) >> 12;
}

/// Halfwords as the bytes lie in memory, the first one lowest.
constexpr uint32_t rgb565_be(Rgb8 color) {
  return (color.r & 0xF8U) | color.g >> 5U | (color.g & 0x1CU) << 11 | (color.b & 0xF8U) << 5;
}
constexpr uint32_t bgr565(Rgb8 color) {
  return (color.b & 0xF8U) << 8 | (color.g & 0xFCU) << 3 | color.r >> 3U;
}

/// The nearest of 8, 8 and 4 levels. (value * 7 + 127) / 255 and (value * 3 + 127) / 255, without divisions:
/// n / 255 is (n + 1 + (n >> 8)) >> 8 for all n below 65,535.
constexpr uint32_t rgb332(Rgb8 color) {
  constexpr auto nearest = [](unsigned value, unsigned most) {
    const unsigned n = value * most + 127;
    return (n + 1 + (n >> 8)) >> 8;
  };
  return nearest(color.r, 7) << 5 | nearest(color.g, 7) << 2 | nearest(color.b, 3);
}

/// What `dithered` compares greys with: 2, 6, ... 254.
constexpr unsigned threshold_of(int32_t x, int32_t y) {
  return 2 + bayer_rank(x, y) * 4;
}

/// Of 4 greys: the one below, or the next where the rest is above the place's threshold.
constexpr unsigned gray2(uint8_t gray, unsigned threshold) {
  const unsigned thirds = gray * 3U;  // in 1/255 of a level
  const unsigned whole = (thirds + 1 + (thirds >> 8)) >> 8;
  return whole + (thirds - whole * 255 > threshold ? 1 : 0);
}

/// Black, white, red. A colour is taken for white, red and black side by side: as much red as r is above the
/// others, as much white as what is left is bright. The three fill the thresholds from below.
enum class Paper3 : uint8_t { kBlack, kWhite, kRed };
constexpr Paper3 paper3(Rgb8 color, unsigned threshold) {
  const uint8_t other = color.g > color.b ? color.g : color.b;
  const uint8_t rest = color.r < other ? color.r : other;
  const unsigned white = gray_of({rest, color.g, color.b});
  const unsigned red = color.r - rest;
  return threshold < white ? Paper3::kWhite : threshold < white + red ? Paper3::kRed : Paper3::kBlack;
}

/// One of the seven. Each channel is compared with the same threshold, so a colour is mixed from black, the
/// primary of its greatest channel, the secondary of its two greatest and white, in the shares that make it.
/// Orange stands for red and yellow in equal shares. There is no cyan and no magenta: their two
/// primaries take turns, in every range of 64 thresholds.
constexpr unsigned paper7(Rgb8 color, unsigned threshold) {
  enum : uint8_t { kBlack, kWhite, kGreen, kBlue, kRed, kYellow, kOrange };
  constexpr uint8_t kMixed[8] = {kBlack, kRed, kGreen, kYellow, kBlue, kRed, kGreen, kWhite};
  const bool r = color.r > threshold;
  const bool g = color.g > threshold;
  const bool b = color.b > threshold;
  const unsigned mixed = (r ? 1U : 0U) | (g ? 2U : 0U) | (b ? 4U : 0U);
  if ((mixed == 5 || mixed == 6) && (threshold & 32U) != 0) {
    return kBlue;
  }
  if ((mixed == 1 || mixed == 3) && color.g > color.b) {
    const int yellow = color.g - color.b;
    const int red = color.r - color.g;
    const int share = yellow < red ? yellow : red;
    const int above = static_cast<int>(threshold) - color.g;
    if (-share <= above && above < share) {
      return kOrange;
    }
  }
  return kMixed[mixed];
}

/// The paper's own colours, by the numbers of kPaper7.
inline constexpr Rgb8 kPaperColors[8] = {{0, 0, 0},   {255, 255, 255}, {0, 255, 0},   {0, 0, 255},
                                         {255, 0, 0}, {255, 255, 0},   {255, 128, 0}, {255, 255, 255}};

/// The one colour of a paper that a colour becomes without dither: by the middle threshold. Every threshold
/// leaves a paper's own colour as it is.
constexpr Rgb8 flat(Rgb8 color, PixelFormat format) {
  constexpr unsigned kMiddle = 126;
  if (is_format<PixelFormat::kPaper3>(format)) {
    const Paper3 ink = paper3(color, kMiddle);
    return kPaperColors[ink == Paper3::kWhite ? 1 : ink == Paper3::kRed ? 4 : 0];
  }
  if (is_format<PixelFormat::kPaper7>(format)) {
    return kPaperColors[paper7(color, kMiddle)];
  }
  return color;
}

}  // namespace thimble::panels
