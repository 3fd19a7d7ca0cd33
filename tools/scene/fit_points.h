/// @file fit_points.h
/// Point clouds to voxels, in two passes over the cloud and without a list of points.
///
/// Pass 1, `survey_points`, finds the bounds and, when the cloud has colours, their histogram. Pass 2 streams
/// voxels, either fitted to the world (world_fit.h: one scale, centred, recentred in double) or as they are.
/// Points are never turned: z is up.
#ifndef THIMBLE_TOOLS_SCENE_FIT_POINTS_H
#define THIMBLE_TOOLS_SCENE_FIT_POINTS_H

#include <array>
#include <cstdint>
#include <optional>

#include "readers/source.h"
#include "scene/palette.h"
#include "scene/voxel_sink.h"
#include "scene/world_fit.h"

namespace thimble::tools {

/// What the first pass learns. About 1 MiB, whatever the cloud's size.
struct PointSurvey {
  std::uint64_t points = 0;  ///< at least 1
  Bounds bounds;
  ColorHistogram colors;  ///< empty when the cloud has no colours
  /// The first point that no world holds as it is: its floor is outside 0 .. 2^12 - 1 on some axis.
  std::optional<CloudPoint> unplaceable;
  const char* counts_in = "point";  ///< of the cloud
};

/// Pass 1. InputError "no points" for an empty cloud.
PointSurvey survey_points(const PointCloud& cloud);

/// The smallest level, 1..12, whose world holds every point as it is. InputError that names the first point
/// with a coordinate below 0 or at 4096 or above, by its line (its number, where points have no lines).
int smallest_level(const PointSurvey& survey);

/// Pass 2: the cloud scaled to the world of 2^level voxels a side, level 1..12: the longest axis fills it,
/// the others are centred. A cloud without extent (one point, or all equal) is the one voxel in the middle.
/// One call of `sink` a point, in the cloud's order. `colors` may be null: material 0.
void fit_points(const PointCloud& cloud, const PointSurvey& survey, int level, const PaletteMap* colors,
                const VoxelSink& sink);

/// Pass 2 for coordinates that are voxel indices: each is rounded down, nothing is scaled, turned or moved.
/// InputError naming the first point outside 0 .. 2^level - 1 (what came before it has reached the sink).
/// An empty cloud is no error here; `survey_points` reports it. `colors` may be null: material 0.
void place_points(const PointCloud& cloud, int level, const PaletteMap* colors, const VoxelSink& sink);

}  // namespace thimble::tools

#endif
