/// @file painter.h
/// From the nearest boxes of a row to its pixels, as the core would shade them.
#ifndef THIMBLE_PLATFORM_HOST_WIDE_PAINTER_H
#define THIMBLE_PLATFORM_HOST_WIDE_PAINTER_H

#include "host/wide/kernels.h"
#include "host/wide/voxel_lists.h"
#include "thimble/render.h"

namespace thimble::wide {

/// Made once a frame: tables of all colours that there can be.
class Painter {
 public:
  Painter(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band);

  /// Paints row `y` of the picture, whose nearest boxes are `nearest[width]` where `covered` (a bit a pixel)
  /// says so. Returns how many there are.
  uint64_t paint_row(const Frame& frame, int32_t y, const uint32_t* covered, const uint64_t* nearest) const;

 private:
  void fill_background(uint8_t* line, int32_t y, const uint32_t* covered) const;
  void paint(const Frame& frame, Pixels* pixels, uint8_t* line) const;

  const VoxelLists& lists_;
  const Camera& camera_;
  const Shading& shading_;
  const Band& band_;
  size_t stride_;
  Rgb8 background_;
  Rgb8 white_;
  Rgb8 faces_[6];  ///< where there is one material
};

}  // namespace thimble::wide

#endif
