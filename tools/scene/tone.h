/// @file tone.h
/// From the core's brightness to a finished picture: exposure and a shoulder, in integers.
///
/// Light is drawn at two thirds, so that what is half again as bright as white is still told apart. A table
/// of 256 entries then brightens it by the exposure, straight up to a knee and gently on towards white, so
/// that no colour is cut off.
#ifndef THIMBLE_TOOLS_SCENE_TONE_H
#define THIMBLE_TOOLS_SCENE_TONE_H

#include <array>
#include <cstdint>

#include "scene/lit_description.h"

namespace thimble::tools {

/// All that shines, at two thirds: lights, ambient, what glows, sky, fog and clouds.
void dim(LitDescription* lighting, const UsedMaterials* used);

/// All that shines, so many 256ths as bright: what `dim` dims.
void expose_light(std::uint32_t exposure_q8, const UsedMaterials& used, LitDescription* lighting);

using ToneTable = std::array<std::uint8_t, 256>;

/// The brightest tenth of a picture is brought to this grey, within the limits of an exposure.
inline constexpr std::uint32_t kExposedGray = 208;
inline constexpr std::uint32_t kLeastExposureQ8 = 208;
inline constexpr std::uint32_t kMostExposureQ8 = 416;

/// How much to brighten a picture of which `counts[g]` pixels have the grey g, drawn at two thirds: 256 is
/// not at all. A picture of nothing is not.
std::uint32_t exposure_q8(const std::array<std::uint32_t, 256>& counts);

/// What becomes of each value of a channel drawn at two thirds. Never falls; 0 stays 0.
ToneTable tone_table(std::uint32_t exposure_q8);

}  // namespace thimble::tools

#endif
