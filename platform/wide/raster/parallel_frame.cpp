#include "wide/raster/parallel_frame.h"

#include <algorithm>
#include <atomic>

namespace thimble::wide {
namespace {

// Pictures are merged so many rows at a time.
constexpr int32_t kMergedRows = 32;

}  // namespace

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

uint64_t ParallelFrame::draw_tiles(const Tiles& tiles, uint32_t* splits) const {
  TileDrawer::Others others(tiles.count());
  if (thread_count() == 1) {
    return draw_some(tiles, 0, &others);
  }
  std::atomic<uint64_t> hits{0};
  threads_->each(thread_count(), [&](int thread) { hits += draw_some(tiles, thread, &others); });
  *splits = others.splits();
  return hits;
}

// Draws and paints until nothing is left for this thread.
uint64_t ParallelFrame::draw_some(const Tiles& tiles, int thread, TileDrawer::Others* others) const {
  const Depths& depths = workspace_.depths(0);
  const int32_t top = task_.frame.tile.y0;
  uint64_t hits = 0;
  TileDrawer drawer(task_, depths, workspace_.full_patches(), workspace_.batch(thread),
                    thread_count() > 1 ? others : nullptr);
  for (;;) {
    const int number = others->next(&drawer);
    if (number == TileDrawer::Others::kNothing) {
      return hits;
    }
    if (number != TileDrawer::Others::kGiven) {
      const int32_t first = tiles.begin(number);
      const int32_t rows = tiles.end(number) - first;
      workspace_.clear(depths, top + first, rows);
      workspace_.clear_patches(first, rows);
      drawer.start(top + first, top + first + rows);
    }
    drawer.draw();
    hits += painter_.paint_tile(drawer.frame(), depths);
    others->finish();
  }
}

uint64_t ParallelFrame::draw_copies() const {
  const Tile& tile = task_.frame.tile;
  const int32_t rows = tile.y1 - tile.y0;
  std::atomic<uint32_t> next_share{0};
  threads_->each(thread_count(), [&](int thread) {
    const Depths& depths = workspace_.depths(thread);
    workspace_.clear(depths, tile.y0, rows);
    TileDrawer drawer(task_, depths, nullptr, workspace_.batch(thread), nullptr, &next_share);
    drawer.start(tile.y0, tile.y1);
    drawer.draw();
  });
  std::atomic<uint64_t> hits{0};
  threads_->each((rows - 1) / kMergedRows + 1, [&](int part) { hits += merge_and_paint(part); });
  return hits;
}

uint64_t ParallelFrame::merge_and_paint(int part) const {
  WideFrame frame = task_.frame;
  Tile& tile = frame.tile;
  const int32_t end = tile.y1;
  tile.y0 += part * kMergedRows;
  tile.y1 = std::min(tile.y0 + kMergedRows, end);
  for (int thread = 1; thread < thread_count(); ++thread) {
    merge_rows(workspace_.depths(thread), tile.x1, tile.y0, tile.y1, workspace_.depths(0));
  }
  return painter_.paint_tile(frame, workspace_.depths(0));
}

Counts ParallelFrame::counts() const {
  Counts all;
  for (int thread = 0; thread < thread_count(); ++thread) {
    all.add(workspace_.batch(thread)->counts);
  }
  return all;
}

}  // namespace thimble::wide
