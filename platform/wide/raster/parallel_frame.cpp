#include "wide/raster/parallel_frame.h"

#include <algorithm>
#include <atomic>

namespace thimble::wide {

uint64_t draw_tiles(Threads* threads, const TileDrawer::Task& task, const TilePainter& painter,
                    const Workspace& workspace, Stats* stats) {
  const int count = threads == nullptr ? 1 : threads->count();
  const Tile& all = task.frame.tile;
  const int32_t rows = all.y1 - all.y0;
  // Threads that draw side by side share no patch of coverage.
  const int32_t tile_rows = (rows + count * kPatchRows - 1) / (count * kPatchRows) * kPatchRows;
  TileDrawer::Others others((rows + tile_rows - 1) / tile_rows);
  std::atomic<uint64_t> hits{0};
  const auto draw_some = [&](int thread) {
    TileDrawer drawer(task, workspace.depths(), workspace.full_patches(), workspace.batch(thread),
                      count > 1 ? &others : nullptr);
    for (int number; (number = others.next(&drawer)) != TileDrawer::Others::kNothing; others.finish()) {
      if (number != TileDrawer::Others::kGiven) {
        const int32_t begin = number * tile_rows;
        const int32_t end = std::min(begin + tile_rows, rows);
        workspace.clear(begin, end - begin);
        drawer.start(all.y0 + begin, all.y0 + end);
      }
      drawer.draw();
      hits += painter.paint_tile(drawer.frame(), workspace.depths());
    }
  };
  if (count == 1) {
    draw_some(0);
  } else {
    threads->each(count, draw_some);
  }
  stats->splits = others.splits();
  for (int thread = 0; thread < count; ++thread) {
    stats->counts.add(workspace.batch(thread)->counts);
  }
  return hits;
}

}  // namespace thimble::wide
