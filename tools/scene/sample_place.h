/// @file sample_place.h
/// One sample of a picture.
#ifndef THIMBLE_TOOLS_SCENE_SAMPLE_PLACE_H
#define THIMBLE_TOOLS_SCENE_SAMPLE_PLACE_H

#include <cstdint>

namespace thimble::tools {

/// A pixel of the camera that samples, and the one of the picture that it is for.
struct SamplePlace {
  std::int32_t x, y;
  std::int32_t px, py;
};

}  // namespace thimble::tools

#endif
