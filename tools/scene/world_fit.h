/// From a file's real coordinates to whole numbers of 1/256 voxel in a world of 2^level voxels a side.
///
/// One uniform scale and a shift, no turn. The largest extent of the bounds reaches from 1 unit to
/// 2^(level + 8) - 1 units: it fills the world, and no coordinate lies on the world's border, so that every
/// closed voxel box that touches a fitted point lies inside the world. The other two axes are centred. An
/// axis without extent goes to the centre of the middle voxel, not to the wall between two voxels.
///
/// Precision: the bounds' centre is subtracted first, in double, so map coordinates (6e5, 4e6) keep all the
/// detail that the file has. The arithmetic is IEEE `-`, `*`, `/` and rounding, one operation at a time
/// (nothing a compiler could fuse), so the units are the same on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "readers/source.h"
#include "scene/palette.h"

namespace thimble::tools {

/// Units a voxel: a coordinate of `WorldFit::units` has 8 bits behind the binary point.
inline constexpr int kUnitBits = 8;
inline constexpr std::int32_t kUnitsPerVoxel = std::int32_t{1} << kUnitBits;

using Bounds = Extent<double>;

class WorldFit {
 public:
  /// `bounds` not empty, finite, of any magnitude a double has; `level` 1..12.
  WorldFit(const Bounds& bounds, int level);

  /// `position` (within the bounds) in 1/256 voxel, each 1 .. 2^(level + 8) - 1. Equal positions give equal
  /// units.
  std::array<std::int32_t, 3> units(const std::array<double, 3>& position) const;

 private:
  std::array<double, 3> center_;
  std::array<std::int32_t, 3> center_units_;
  double half_extent_;  ///< of the longest axis; 0 when all points are equal
  double half_units_;   ///< what `half_extent_` becomes
};

// Point clouds to voxels, in two passes over the cloud and without a list of points.
//
// Pass 1, `survey_points`, finds the bounds and, when the cloud has colours, their histogram. Pass 2 streams
// voxels, either fitted to the world (world_fit.h: one scale, centred, recentred in double) or as they are.
// Points are never turned: z is up.

/// What the first pass learns. At most 3 MiB, whatever the cloud's size.
struct PointSurvey {
  std::uint64_t points = 0;  ///< at least 1
  Bounds bounds;
  Bounds world;                               ///< what is fitted: `bounds`, or what `choose_world` says
  std::uint64_t left_out = 0;                 ///< points that are not in there
  std::vector<std::array<double, 3>> sample;  ///< every nth point
  ColorHistogram colors;                      ///< empty when the cloud has no colours
};

/// Pass 1. InputError "no points" for an empty cloud.
PointSurvey survey_points(const PointCloud& cloud);

/// Which points the world is fitted to.
struct FitWishes {
  double percent = 99;         ///< that always lie in it; 100: all
  std::optional<Bounds> clip;  ///< instead: those in this box
};
/// Sets the survey's world. Points far out do not make all others small: where the least box that holds `percent` of
/// the points on each axis is less than an eighth as long as that of all of them, the world is the box of the points that
/// are at most that long away from it. One more pass over the cloud where something is left out.
/// @throws InputError  no point is in the clip
void choose_world(const PointCloud& cloud, const FitWishes& wishes, PointSurvey* survey);

/// The smallest level, 1..12, whose world holds every point as it is. InputError that names the first point
/// with a coordinate below 0 or at 4096 or above, by its line (its number, where points have no lines).
int smallest_level(const PointCloud& cloud, const PointSurvey& survey);

/// Pass 2: the survey's world scaled to that of 2^level voxels a side, level 1..12: the longest axis fills it,
/// the others are centred. Points outside are left out. A cloud without extent (one point, or all equal) is the one voxel in the middle.
/// One call of `sink` a point that is not, in the cloud's order. `colors` may be null: material 0.
void fit_points(const PointCloud& cloud, const PointSurvey& survey, int level, const PaletteMap* colors,
                const VoxelSink& sink);

/// Pass 2 for coordinates that are voxel indices: each is rounded down, nothing is scaled, turned or moved.
/// InputError naming the first point outside 0 .. 2^level - 1 (what came before it has reached the sink).
/// An empty cloud is no error here; `survey_points` reports it. `colors` may be null: material 0.
void place_points(const PointCloud& cloud, int level, const PaletteMap* colors, const VoxelSink& sink);

}  // namespace thimble::tools
