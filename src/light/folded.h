// The effects that are in every lit renderer which the library holds (dispatch.cpp, asked.cpp): they trace no rays of their
// own, and cost a test a ray where they are off. Internal to src/.
#ifndef THIMBLE_SRC_LIGHT_FOLDED_H
#define THIMBLE_SRC_LIGHT_FOLDED_H

#include "thimble/light/scene.h"

namespace thimble::lit {

inline constexpr EffectSet kFolded = Effect::kDirectLight | Effect::kEmission | Effect::kFog | Effect::kSky |
                                     Effect::kDepthCue | Effect::kSmoothNormals | Effect::kEdges |
                                     Effect::kRipples;

}  // namespace thimble::lit

#endif
