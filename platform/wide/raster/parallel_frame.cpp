#include "wide/raster/parallel_frame.h"

#include <algorithm>
#include <atomic>

namespace thimble::wide {

namespace {

// Some tiles hold more than others, and both sides of a seam look at the boxes on it.
constexpr int kTilesAThread = 4;
constexpr int32_t kLeastRows = 2 * kPatchRows;

}  // namespace

uint64_t draw_tiles(Threads* threads, const TileDrawer::Task& task, const TilePainter& painter,
                    const Workspace& workspace, Stats* stats) {
  const int count = threads == nullptr ? 1 : threads->count();
  const Tile& all = task.frame.tile;
  const int32_t rows = all.y1 - all.y0;
  // Threads that draw side by side share no patch of coverage.
  const int32_t patches = (rows + kPatchRows - 1) / kPatchRows;
  const int32_t tiles = count * kTilesAThread;
  const int32_t tile_rows =
      count == 1 ? rows : std::max((patches + tiles - 1) / tiles * kPatchRows, kLeastRows);
  std::atomic<int32_t> next_row{0};
  std::atomic<uint64_t> hits{0};
  const auto draw_some = [&](int thread) {
    TileDrawer drawer(task, workspace.depths(), workspace.full_patches(), workspace.batch(thread));
    for (int32_t begin; (begin = next_row.fetch_add(tile_rows)) < rows;) {
      const int32_t end = std::min(begin + tile_rows, rows);
      workspace.clear(begin, end - begin);
      drawer.draw(all.y0 + begin, all.y0 + end);
      hits += painter.paint_tile(drawer.frame(), workspace.depths());
    }
  };
  if (count == 1) {
    draw_some(0);
  } else {
    threads->each(count, draw_some);
  }
  for (int thread = 0; thread < count; ++thread) {
    stats->counts.add(workspace.batch(thread)->counts);
  }
  return hits;
}

}  // namespace thimble::wide
