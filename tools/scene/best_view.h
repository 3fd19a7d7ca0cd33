/// @file best_view.h
/// From which side a scene shows most.
#ifndef THIMBLE_TOOLS_SCENE_BEST_VIEW_H
#define THIMBLE_TOOLS_SCENE_BEST_VIEW_H

#include "scene/framing.h"

namespace thimble::tools {

/// Of a fixed set of three-quarter views from above (from the front and the back, the left and the right, at
/// two heights) the one that shows the most distinct faces and colours: each is drawn at 96 x 72 pixels, and
/// what is counted is the different planes of faces (axis, side and coordinate, with the material) among the
/// hits. People model with the front in front, so a view from behind must show half again as much as the best
/// from there; ties go to the earlier one.
/// Integers decide, so it is the same on every machine. 55,296 rays; without a compact tree, the first view.
ViewAngles best_angles(const SceneShape& shape);

}  // namespace thimble::tools

#endif
