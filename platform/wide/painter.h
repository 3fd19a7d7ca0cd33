/// @file painter.h
/// Paints the pixels of a tile from their nearest boxes, as the core would shade them.
#ifndef THIMBLE_PLATFORM_WIDE_PAINTER_H
#define THIMBLE_PLATFORM_WIDE_PAINTER_H

#include "thimble/picture/render.h"
#include "wide/kernels.h"
#include "wide/voxel_lists.h"

namespace thimble::wide {

/// Made once a frame; holds what all its tiles are painted with.
class TilePainter {
 public:
  TilePainter(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band);

  /// The scale for greys that are found as voxels are hit (Depths); null where they are found at the end.
  const GrayScale* gray_scale() const;

  /// Paints the rows of the frame's tile. Returns how many pixels hold anything.
  uint64_t paint_tile(const WideFrame& frame, const Depths& depths) const;

 private:
  uint64_t paint_grays(const WideFrame& frame, const Depths& depths) const;
  void fill_background(uint8_t* line, int32_t y, const Depths& depths) const;
  void paint(const WideFrame& frame, const Depths& depths, Pixels* pixels) const;
  uint8_t* line(int32_t y) const {
    return band_.pixels.data + stride_ * row_place(band_.format, y - band_.first_row);
  }

  const VoxelLists& lists_;
  const Camera& camera_;
  const Shading& shading_;
  const Band& band_;
  size_t stride_;
  Rgb8 background_;
  GrayScale gray_scale_;
  Rgb8 faces_[6];  ///< where there is one material
};

}  // namespace thimble::wide

#endif
