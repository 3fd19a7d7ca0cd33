/// A picture's exposure and its shoulder as a table, in integers and without anything of a system: the page draws
/// by it, too. lit_description.h says how it belongs together.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "thimble/light/scene.h"
#include "thimble/picture/pixel.h"

namespace thimble::tools {

/// Greys of a picture: how many pixels have each.
struct GrayCounts {
  uint32_t of[256] = {};
};

/// The brightest tenth of a picture is brought to this grey, within the limits of an exposure.
inline constexpr uint32_t kExposedGray = 208;
inline constexpr uint32_t kLeastExposureQ8 = 208;
inline constexpr uint32_t kMostExposureQ8 = 416;
/// A picture of at most so many pixels each way, of every so manyth, tells the exposure, and the rays of them all.
inline constexpr int32_t kExposurePx = 96;
/// A pixel has four samples where those of the picture take at most so many rays, else one.
inline constexpr uint64_t kMostLookRays = 100'000'000;

/// The grey, 1 at least, that one pixel in `part` has or exceeds; 0 of a picture of nothing.
uint32_t bright_gray(const GrayCounts& counts, uint64_t part);
/// How much to brighten a picture of these greys, drawn at two thirds: 256 is not at all. A picture of nothing is
/// not.
uint32_t exposure_q8(const GrayCounts& counts);
/// The exposure of a picture whose colours are those that are to be seen: none, and no shoulder.
inline constexpr uint32_t kOwnColorsQ8 = 512;
/// Nothing but what glows gives light: its colours are its own.
inline bool is_dark_but_for_glow(const LitScene& scene) {
  return scene.lights.empty() && scene.ambient_q8[0] + scene.ambient_q8[1] + scene.ambient_q8[2] == 0;
}

/// What becomes of each value of a channel drawn at two thirds. Never falls; 0 stays 0.
struct ToneTable {
  uint8_t of[256] = {};
  uint8_t operator[](size_t value) const { return of[value]; }
  Rgb8 operator()(Rgb8 color) const { return {of[color.r], of[color.g], of[color.b]}; }
};
ToneTable tone_table(uint32_t exposure_q8);

}  // namespace thimble::tools
