/// What each statement of a `.scene` file says. `line` stands behind the statement's word, which stands at
/// `place`; each reads what belongs to it and throws as `read_scene_text` does.
#pragma once

#include "readers/scene_text.h"
#include "readers/text_line.h"

namespace thimble::tools::statements {

using Read = void(TextLine& line, TextPlace place, SceneText* scene);

/// What stands in the world (scene_things.cpp).
Read model, box, ball, material, water;
/// How it is seen and lit (scene_lighting.cpp).
Read camera, sun, lamp, ambient, sky, fog, occlusion, effects;

inline constexpr double kMostDensity = 200;
/// Components of a direction as it is written.
inline constexpr double kMostDirection = 65535;
/// No world has anything farther away; the world's own limit is checked later.
inline constexpr double kFar = 9.0 * 4096;

}  // namespace thimble::tools::statements
