/// @file tiles.h
/// Cuts the picture into tiles of whole rows, one for each thread.
#ifndef THIMBLE_PLATFORM_WIDE_RASTER_TILES_H
#define THIMBLE_PLATFORM_WIDE_RASTER_TILES_H

#include "wide/raster/cost_model.h"
#include "wide/threads.h"

namespace thimble::wide {

/// Tiles that take about the same work. They are few, since both sides of a seam look at the boxes on it.
class Tiles {
 public:
  /// `work` is what equal parts of the rows take, from the first down.
  Tiles(int32_t rows, int threads, const float (&work)[CostEstimate::kParts]);

  int count() const { return count_; }
  int32_t begin(int tile) const { return tile == 0 ? 0 : end_[tile - 1]; }
  int32_t end(int tile) const { return end_[tile]; }

 private:
  int count_ = 1;
  int32_t end_[kMaxThreads];
};

}  // namespace thimble::wide

#endif
