/// @file picture_error.h
/// How far one picture is from another of the same rays.
#ifndef THIMBLE_TOOLS_INSTRUMENTS_PICTURE_ERROR_H
#define THIMBLE_TOOLS_INSTRUMENTS_PICTURE_ERROR_H

#include <cstdint>
#include <vector>

#include "thimble/picture/camera.h"
#include "thimble/picture/shading.h"
#include "thimble/tree/compact_tree.h"

namespace thimble::tools {

/// What each pixel's ray met: its colour, and the distance in voxels along the unit ray, negative for a miss.
struct TracedPicture {
  std::vector<Rgb8> colors;
  std::vector<double> distances;
};

/// Traces every pixel. The camera is one for the tree's level.
TracedPicture trace_picture(const CompactTree& tree, const Camera& camera, const Shading& shading);

struct PictureError {
  std::uint64_t wrong_px = 0;       ///< of another colour
  std::uint64_t silhouette_px = 0;  ///< hit in one and missed in the other
  double depth_mean_voxels = 0;  ///< distances' difference, over pixels hit in both; 0 where there are none
  double depth_max_voxels = 0;
};

PictureError picture_error(const TracedPicture& picture, const TracedPicture& reference);

}  // namespace thimble::tools

#endif
