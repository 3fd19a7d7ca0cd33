/// Paints the pixels of a tile by their nearest boxes, as the core would shade them.
#pragma once

#include "thimble/picture/render.h"
#include "wide/raster/kernels.h"
#include "wide/raster/voxel_lists.h"

namespace thimble::wide {

/// Made once a frame; holds what painting any of its tiles takes.
class TilePainter {
 public:
  TilePainter(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band);

  /// The scale with which greys, or faces, are found as rays hit voxels (Depths); null where they are found at the end.
  const GrayScale* gray_scale() const;

  /// Whether this painter takes pictures of which only parts were written (Depths::is_touched).
  bool takes_sparse() const { return gray_scale() != nullptr && has_bytes_; }

  /// Paints the rows of the frame's tile. Returns how many pixels show something.
  uint64_t paint_tile(const WideFrame& frame, const Depths& depths) const;

 private:
  uint64_t paint_codes(const WideFrame& frame, const Depths& depths) const;
  bool find_bytes();
  Rgb8 color_of_code(unsigned code) const;
  void fill_piece(uint8_t* to, size_t size) const;
  void fill_background(const WideFrame& frame, const Depths& depths) const;
  void store_colors(const Pixels& pixels, const Rgb8* colors) const;
  void paint_grays(const WideFrame& frame, const Pixels& pixels) const;
  void find_colors(const WideFrame& frame, const Pixels& pixels, Rgb8* colors) const;
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
  bool has_bytes_;  ///< whether a code alone decides a pixel's bytes; then `bytes_` says which
  CodeBytes bytes_{};
  uint32_t material_count_ = 1;  ///< materials that look different; 1 where a voxel's material does not count
  Rgb8 colors_[256][6];          ///< by material and face, where faces are shown
};

}  // namespace thimble::wide
