/// @file workspace.h
/// Lays out the workspace of one frame: pictures, patches and batches.
#ifndef THIMBLE_PLATFORM_WIDE_RASTER_WORKSPACE_H
#define THIMBLE_PLATFORM_WIDE_RASTER_WORKSPACE_H

#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "wide/raster/kernels.h"

namespace thimble::wide {

/// At most so many threads draw a picture of their own each: caches hold no more pictures.
inline constexpr int kMostCopies = 4;

class Workspace {
 public:
  struct Layout {
    int32_t width_px;
    int32_t first_row;
    int32_t rows;
    int threads;
    int copies;  ///< how many pictures there are: 1 .. kMostCopies
    bool by_blocks;
    bool is_sparse;               ///< whether codes are cleared where they are written (Depths::is_touched)
    const GrayScale* gray_scale;  ///< null: without greys
    const Shading* shading;
  };
  /// A picture of fewer words is never sparse, since there is nothing to gain.
  static constexpr size_t kLeastSparseWords = 64;
  /// The most bytes that a layout takes.
  static size_t bytes(int32_t width_px, int32_t rows, int threads);

  /// `memory` has room for bytes(). Batches are made empty; the caller clears pictures and patches.
  Workspace(Bytes memory, const Layout& layout);

  const Depths& depths(int copy) const { return depths_[copy]; }
  Batch* batch(int thread) const { return batches_ + thread; }
  /// See all_covered().
  uint8_t* full_patches() const { return full_patches_; }

  /// Clears `rows` rows of a picture from row `y` on.
  void clear(const Depths& depths, int32_t y, int32_t rows) const;
  /// Clears the patches of `rows` rows; `first` counts from the workspace's first row and is a multiple of kPatchRows.
  void clear_patches(int32_t first, int32_t rows) const;

 private:
  Depths make_depths(const Layout& layout, Arena* arena) const;

  size_t strips_;
  int32_t rows_;
  Depths depths_[kMostCopies];
  uint8_t* full_patches_;
  Batch* batches_;
};

}  // namespace thimble::wide

#endif
