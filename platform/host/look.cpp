#include "host/look.h"

namespace thimble::host {

Look look_of(Theme theme, PixelFormat format) {
  const bool is_color = !is_gray(format);
  Look look;
  switch (theme) {
    case Theme::kPlain:
      look.ground = {24, 24, 26};
      return look;
    case Theme::kOled:
      look.keeps_color = is_color;
      look.unlit = {7, 8, 11};
      look.lit = {226, 242, 255};
      look.gap = {0, 0, 0};
      look.ground = {3, 3, 5};
      look.has_gaps = true;
      return look;
    case Theme::kLcd:
      look.keeps_color = is_color;
      look.has_gaps = true;
      if (is_color) {
        look.gap = {12, 12, 14};
        look.ground = {18, 18, 20};
        return look;
      }
      look.unlit = {167, 180, 133};
      look.lit = {34, 44, 30};
      look.gap = {177, 190, 143};
      look.ground = {177, 190, 143};
      return look;
  }
  return look;
}

}  // namespace thimble::host
