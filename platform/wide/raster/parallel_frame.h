/// Draws a frame with several threads.
#pragma once

#include "wide/raster/cost_model.h"
#include "wide/raster/painter.h"
#include "wide/raster/renderer.h"
#include "wide/raster/tile_drawer.h"
#include "wide/raster/workspace.h"

namespace thimble::wide {

/// Tiles of whole rows, one for each thread, that take about the same work. They are few, since both sides of a seam look at the boxes on it.
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

/// Draws and paints a frame, either tile by tile in one picture, or with a picture for each thread.
class ParallelFrame {
 public:
  /// `threads`: null where the calling thread draws alone.
  ParallelFrame(Threads* threads, const TileDrawer::Task& task, const TilePainter& painter,
                const Workspace& workspace)
      : threads_(threads), task_(task), painter_(painter), workspace_(workspace) {}

  /// Every thread draws and paints tiles, then parts of other threads' tiles, until none are left. Returns how many
  /// pixels show something. `splits` gets how many parts changed hands.
  uint64_t draw_tiles(const Tiles& tiles, uint32_t* splits) const;
  /// Every thread draws its share of the list in a picture of its own; then the pictures are merged and painted.
  /// Returns how many pixels show something.
  uint64_t draw_copies() const;
  /// What all threads counted.
  Counts counts() const;

 private:
  int thread_count() const { return threads_ == nullptr ? 1 : threads_->count(); }
  uint64_t draw_some(const Tiles& tiles, int thread, TileDrawer::Others* others) const;
  uint64_t merge_and_paint(int part) const;

  Threads* threads_;
  const TileDrawer::Task& task_;
  const TilePainter& painter_;
  const Workspace& workspace_;
};

}  // namespace thimble::wide
