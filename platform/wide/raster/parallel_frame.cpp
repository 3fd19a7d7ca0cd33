#include "wide/raster/parallel_frame.h"

#include <algorithm>
#include <atomic>

namespace thimble::wide {

Tiles::Tiles(int32_t rows, int threads, const float (&work)[CostEstimate::kParts]) : end_{rows} {
  if (threads == 1) {
    return;
  }
  float all = 0;
  for (const float part : work) {
    all += part;
  }
  // Rows take some time by themselves: they are cleared and painted.
  const float each = 0.03F * all / CostEstimate::kParts + 1e-6F;
  all += each * CostEstimate::kParts;
  count_ = 0;
  float done = 0;
  int part = 0;
  for (int32_t last = 0; last < rows;) {
    const float wanted = all * static_cast<float>(count_ + 1) / static_cast<float>(threads);
    while (part < CostEstimate::kParts && done + work[part] + each <= wanted) {
      done += work[part] + each;
      ++part;
    }
    float at = static_cast<float>(part);
    if (part < CostEstimate::kParts) {
      at += (wanted - done) / (work[part] + each);
    }
    // If the sums are not numbers, one tile takes all rows that are left.
    at = at >= 0 && at < CostEstimate::kParts ? at : CostEstimate::kParts;
    const int32_t row = static_cast<int32_t>(at * static_cast<float>(rows) / CostEstimate::kParts);
    int32_t end = (row + kPatchRows / 2) / kPatchRows * kPatchRows;
    end = end <= last ? last + kPatchRows : end;
    last = end < rows && count_ + 1 < threads ? end : rows;
    end_[count_++] = last;
  }
}

uint64_t draw_tiles(Threads* threads, const Tiles& tiles, const TileDrawer::Task& task,
                    const TilePainter& painter, const Workspace& workspace, Stats* stats) {
  const int count = threads == nullptr ? 1 : threads->count();
  TileDrawer::Others others(tiles.count());
  std::atomic<uint64_t> hits{0};
  const auto draw_some = [&](int thread) {
    TileDrawer drawer(task, workspace.depths(), workspace.full_patches(), workspace.batch(thread),
                      count > 1 ? &others : nullptr);
    for (int number; (number = others.next(&drawer)) != TileDrawer::Others::kNothing; others.finish()) {
      if (number != TileDrawer::Others::kGiven) {
        const int32_t top = task.frame.tile.y0;
        workspace.clear(tiles.begin(number), tiles.end(number) - tiles.begin(number));
        drawer.start(top + tiles.begin(number), top + tiles.end(number));
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
