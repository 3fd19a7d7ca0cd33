/// How a display's pixels look: what turns an exact picture into one that resembles the glass on the desk.
///
/// Only what a person sees goes through a look; pictures that are saved or compared never do.
#pragma once

#include <cstdint>

#include "thimble/picture/pixel.h"

namespace thimble::host {

enum class Theme : std::uint8_t {
  kPlain,  ///< pixels as they are, without gaps
  kOled,   ///< pale blue-white light on black, with gaps
  kLcd,    ///< a lit pixel is dark, on a light ground of grey green; a colour display keeps its colours
};

/// The colour of a pixel on the screen goes straight from `unlit` to `lit` with its grey, or is kept.
struct Look {
  bool keeps_color = true;
  Rgb8 unlit{0, 0, 0};
  Rgb8 lit{255, 255, 255};
  Rgb8 gap{0, 0, 0};     ///< between the pixels
  Rgb8 ground{0, 0, 0};  ///< around the picture
  bool has_gaps = false;
};

/// Of a display of that format.
constexpr Look look_of(Theme theme, PixelFormat format) {
  const bool is_color = !is_gray(format);
  switch (theme) {
    case Theme::kOled:
      return {is_color, {7, 8, 11}, {226, 242, 255}, {0, 0, 0}, {3, 3, 5}, true};
    case Theme::kLcd:
      return is_color ? Look{.gap = {12, 12, 14}, .ground = {18, 18, 20}, .has_gaps = true}
                      : Look{false, {167, 180, 133}, {34, 44, 30}, {177, 190, 143}, {177, 190, 143}, true};
    default:
      return {.ground = {24, 24, 26}};
  }
}

/// The colour on the screen of a pixel of the picture.
constexpr Rgb8 looks(const Look& look, Rgb8 pixel) {
  if (look.keeps_color) {
    return pixel;
  }
  const int level = gray_of(pixel);
  const auto mix = [level](int from, int to) {
    return static_cast<std::uint8_t>(from + (to - from) * level / 255);
  };
  return {mix(look.unlit.r, look.lit.r), mix(look.unlit.g, look.lit.g), mix(look.unlit.b, look.lit.b)};
}

/// How many of the `scale` screen pixels of a picture pixel are gap, at its right and at its bottom.
constexpr std::int32_t gap_px(const Look& look, std::int32_t scale) {
  if (!look.has_gaps || scale < 3) {
    return 0;
  }
  return scale < 8 ? 1 : scale / 6;
}

}  // namespace thimble::host
