/// @file sorted_run.h
/// Orders the boxes of a small block from front to back.
#ifndef THIMBLE_PLATFORM_WIDE_RASTER_SORTED_RUN_H
#define THIMBLE_PLATFORM_WIDE_RASTER_SORTED_RUN_H

#include "wide/raster/kernels.h"

namespace thimble::wide {

/// The entries of a run that cull_run() kept, and the same entries from front to back.
class SortedRun {
 public:
  static constexpr uint32_t kMostBoxes = 512;

  /// Culls the run of a block, which has at most kMostBoxes boxes, and sorts those that are left; `run` then reads them
  /// from here. Returns whether any are left. `eye_cell` is the voxel that the eye is in.
  bool cull_and_sort(const WideFrame& frame, const Block& block, const int32_t (&eye_cell)[3],
                     const Depths& depths, Batch* batch, Run* run);

 private:
  void sort(const Block& block, const int32_t (&eye_cell)[3], uint32_t count);

  uint32_t entries_[kMostBoxes + kReadAhead];
  uint32_t numbers_[kMostBoxes + kReadAhead];
  uint32_t sorted_entries_[kMostBoxes + kReadAhead];
  uint32_t sorted_numbers_[kMostBoxes + kReadAhead];
};

}  // namespace thimble::wide

#endif
