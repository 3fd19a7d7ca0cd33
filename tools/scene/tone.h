/// @file tone.h
/// From the core's brightness to a finished picture: exposure and a shoulder, in integers.
///
/// Light is drawn at two thirds, so that what is half again as bright as white is still told apart. A table
/// of 256 entries then brightens it by the exposure, straight up to a knee and gently on towards white, so
/// that no colour is cut off.
#ifndef THIMBLE_TOOLS_SCENE_TONE_H
#define THIMBLE_TOOLS_SCENE_TONE_H

#include <cstdint>

#include "scene/lit_description.h"
#include "scene/tone_table.h"

namespace thimble::tools {

/// All that shines, at two thirds: lights, ambient, what glows, sky, fog and clouds.
void dim(LitDescription* lighting, const UsedMaterials* used);

/// All that shines, so many 256ths as bright: what `dim` dims.
void expose_light(std::uint32_t exposure_q8, const UsedMaterials& used, LitDescription* lighting);

}  // namespace thimble::tools

#endif
