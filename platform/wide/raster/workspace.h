/// Lays out the workspace of one frame, the picture, patches and batches, and says which parts of a picture are covered.
#pragma once

#include "thimble/base/memory.h"
#include "thimble/picture/render.h"
#include "wide/raster/kernels.h"

namespace thimble::wide {

/// How many strips of 32 columns a picture has.
inline size_t strips_of(int32_t width_px) {
  return static_cast<size_t>(width_px + 31) / 32;
}
/// Words of Depths::covered. There is one strip more than the picture has, since pixels are looked up together with
/// those to their right.
inline size_t covered_words(int32_t width_px, int32_t rows) {
  return (strips_of(width_px) + 1) * static_cast<size_t>(rows);
}

/// A patch is as wide as a strip, and so many rows high.
inline constexpr int32_t kPatchRows = 16;
inline size_t patches_of(int32_t rows) {
  return static_cast<size_t>(rows + kPatchRows - 1) / kPatchRows;
}

/// Whether all pixels of `where` are covered. `full` remembers which patches were seen full (a byte each, strip by
/// strip), so that large rectangles cost little.
bool all_covered(const Depths& depths, const Rectangle& where, uint8_t* full);

class Workspace {
 public:
  struct Layout {
    int32_t width_px;
    int32_t first_row;
    int32_t rows;
    int threads;
    bool by_blocks;
    bool is_sparse;               ///< whether codes are cleared where they are written (Depths::is_touched)
    const GrayScale* gray_scale;  ///< null: without greys
    const Shading* shading;
  };
  /// A picture of fewer words is never sparse, since there is nothing to gain.
  static constexpr size_t kLeastSparseWords = 64;
  /// The most bytes that a layout takes.
  static size_t bytes(int32_t width_px, int32_t rows, int threads);

  /// `memory` has room for bytes(). Batches are made empty; the caller clears the picture and its patches.
  Workspace(Bytes memory, const Layout& layout);

  const Depths& depths() const { return depths_; }
  Batch* batch(int thread) const { return batches_ + thread; }
  /// See all_covered().
  uint8_t* full_patches() const { return full_patches_; }

  /// Clears `rows` rows of the picture and their patches; `first` counts from the workspace's first row and is a
  /// multiple of kPatchRows.
  void clear(int32_t first, int32_t rows) const;

 private:
  Depths make_depths(const Layout& layout, Arena* arena) const;

  size_t strips_;
  int32_t rows_;
  Depths depths_;
  uint8_t* full_patches_;
  Batch* batches_;
};

}  // namespace thimble::wide
