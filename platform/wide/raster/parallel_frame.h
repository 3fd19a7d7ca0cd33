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

/// Draws and paints a frame: every thread (null: the calling one alone) draws tiles, then parts of other threads' tiles,
/// until none are left. Returns how many pixels show something. `stats` gets what all threads counted, and how many
/// parts changed hands.
uint64_t draw_tiles(Threads* threads, const Tiles& tiles, const TileDrawer::Task& task,
                    const TilePainter& painter, const Workspace& workspace, Stats* stats);

}  // namespace thimble::wide
