/// What a ball of the particle world looks like, on boards and on desktops alike.
#pragma once

#include <stdint.h>

#include "thimble/picture/pixel.h"

namespace thimble::apps {

/// Walls and whatever else is set and belongs to no ball.
inline constexpr Rgb8 kWallColor{120, 126, 138};

/// `color` of a ball at rest: two thirds as bright.
constexpr Rgb8 resting(Rgb8 color) {
  const auto part = [](uint8_t value) { return static_cast<uint8_t>((value * 41U) >> 6); };
  return {part(color.r), part(color.g), part(color.b)};
}

/// From pale blue for the smallest to orange for those of 12 cells and more; all about as bright.
constexpr Rgb8 ball_color(int32_t diameter, bool asleep) {
  constexpr Rgb8 kColors[] = {{150, 215, 255}, {104, 204, 240}, {92, 214, 190},
                              {160, 222, 120}, {240, 208, 96},  {255, 164, 92}};
  const int32_t step = diameter < 2 ? 0 : (diameter - 2) / 2;
  const Rgb8 color = kColors[step > 5 ? 5 : step];
  return asleep ? resting(color) : color;
}

/// The same for displays of greys, where neighbours are told apart by their numbers: 255, 221 or 187, at rest
/// half of it.
constexpr Rgb8 ball_gray(uint32_t id, bool asleep) {
  const uint8_t bright = static_cast<uint8_t>(255 - 34 * (id % 3));
  const uint8_t gray = asleep ? static_cast<uint8_t>(bright / 2) : bright;
  return {gray, gray, gray};
}

}  // namespace thimble::apps
