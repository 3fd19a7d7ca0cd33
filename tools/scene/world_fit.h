/// @file world_fit.h
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
#ifndef THIMBLE_TOOLS_SCENE_WORLD_FIT_H
#define THIMBLE_TOOLS_SCENE_WORLD_FIT_H

#include <array>
#include <cstdint>

namespace thimble::tools {

/// Units a voxel: a coordinate of `WorldFit::units` has 8 bits behind the binary point.
inline constexpr int kUnitBits = 8;
inline constexpr std::int32_t kUnitsPerVoxel = std::int32_t{1} << kUnitBits;

/// The smallest axis-parallel box of the points added.
struct Bounds {
  std::array<double, 3> low{};
  std::array<double, 3> high{};
  bool empty = true;

  /// Grows the box; `position` is finite.
  void add(const std::array<double, 3>& position);
};

class WorldFit {
 public:
  /// `bounds` not empty, finite, of any magnitude a double has; `level` 1..12.
  WorldFit(const Bounds& bounds, int level);

  /// `position` (within the bounds) in 1/256 voxel, each 1 .. 2^(level + 8) - 1. Equal positions give equal
  /// units.
  std::array<std::int32_t, 3> units(const std::array<double, 3>& position) const;
  /// The voxel that holds `position`, each 0 .. 2^level - 1.
  std::array<std::int32_t, 3> voxel(const std::array<double, 3>& position) const;

 private:
  std::array<double, 3> center_;
  std::array<std::int32_t, 3> center_units_;
  double half_extent_;  ///< of the longest axis; 0 when all points are equal
  double half_units_;   ///< what `half_extent_` becomes
};

}  // namespace thimble::tools

#endif
