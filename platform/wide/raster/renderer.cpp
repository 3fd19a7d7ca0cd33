#include "wide/raster/renderer.h"

#include <algorithm>
#include <atomic>

#include "thimble/light/host/asked.h"
#include "wide/raster/cost_model.h"
#include "wide/raster/painter.h"
#include "wide/raster/tile_drawer.h"
#include "wide/raster/workspace.h"

namespace thimble::wide {

static_assert(kMaxPicturePx <= 1 << kPlaceBits);

namespace {

// Some tiles hold more than others, and both sides of a seam look at the boxes on it.
constexpr int kTilesAThread = 4;
constexpr int32_t kLeastRows = 2 * kPatchRows;

// A picture that shows fewer boxes than it has pieces (Depths::is_touched) is mostly empty.
bool is_sparse(const VoxelLists& lists, const Camera& camera, const Band& band, bool by_blocks, int threads,
               const TilePainter& painter) {
  const size_t words = strips_of(camera.width_px()) * static_cast<size_t>(band.rows);
  // Not with surfaces: the pixels that the core decides (hidden_voxels.h) are written without clearing their pieces.
  return threads == 1 && !by_blocks && !lists.is_surface() && painter.takes_sparse() &&
         words >= Workspace::kLeastSparseWords && lists.size() < words / kPieceWords;
}

// Whether a pixel has room for the numbers of all entries: where these are told apart (TileDrawer::draw_block), else for
// those of a cube.
bool numbers_fit(const VoxelLists& lists) {
  constexpr size_t kMost = size_t{1} << kEntryBits;
  if (lists.size() <= kMost) {
    return true;
  }
  if (lists.has_blocks() || !lists.materials().empty()) {
    return false;
  }
  uint32_t first = 0;  // of the nodes of a level
  uint32_t end = 1;
  for (int level = lists.tree().level(); level > kCubeLevel; --level) {
    uint32_t children = 0;
    for (; first < end; ++first) {
      children += static_cast<uint32_t>(__builtin_popcount(lists.children(first)));
    }
    end += children;
  }
  while (first < end && lists.nodes()[first].entries <= kMost) {
    ++first;
  }
  return first == end;
}

// Refuses the bands that `render_band` refuses.
Status check(const VoxelLists& lists, const Camera& camera, const Band& band, Bytes workspace, int threads) {
  size_t stride = 0;
  const lit::Frame unlit{lists.tree(), camera, Shading(), LitScene(), LitOptions(), Effect::kNone};
  const Status status = lit::check_frame(unlit, band, &stride);
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  if (workspace.size < workspace_bytes(camera.width_px(), band.rows, threads)) {
    return Status::kOutOfMemory;
  }
  return numbers_fit(lists) ? Status::kOk : Status::kTooFine;
}

// Draws and paints a frame: every thread (null: the calling one alone) draws one tile after another, until none is left.
// Returns how many pixels show something. `stats` gets what all threads counted.
uint64_t draw_tiles(Threads* threads, const TileDrawer::Task& task, const TilePainter& painter,
                    const Workspace& workspace, Stats* stats) {
  const int count = threads == nullptr ? 1 : threads->count();
  const Rectangle& all = task.frame.tile;
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

}  // namespace

size_t workspace_bytes(int32_t width_px, int32_t rows, int threads) {
  return Workspace::bytes(width_px, rows, threads);
}

Status render(const VoxelLists& lists, const Camera& camera, const Shading& shading, const Band& band,
              Bytes workspace, RenderCounts* counts, const Options& options, Stats* stats) {
  const int threads = options.threads == nullptr ? 1 : options.threads->count();
  const Status status = check(lists, camera, band, workspace, threads);
  if (status != Status::kOk || band.rows == 0) {
    return status;
  }
  WideFrame frame;
  if (!make_frame(camera, {0, band.first_row, camera.width_px(), band.first_row + band.rows}, &frame)) {
    return Status::kTooFine;
  }
  const bool by_blocks =
      options.order == Order::kAuto ? blocks_pay(lists, frame) : options.order == Order::kBlocks;
  SolidStarts starts;
  if (lists.is_surface()) {
    frame.hidden_in = &lists.tree();
    frame.first_hidden = static_cast<uint32_t>(lists.size());
    starts = find_solid_starts(lists.tree(), frame);
  }
  const TilePainter painter(lists, camera, shading, band);
  const Workspace space(workspace, {camera.width_px(), band.first_row, band.rows, threads, by_blocks,
                                    is_sparse(lists, camera, band, by_blocks, threads, painter),
                                    painter.gray_scale(), &shading});
  const TileDrawer::Task task{lists, frame, by_blocks, lists.is_surface() ? &starts : nullptr};
  Stats done{{}, by_blocks ? Order::kBlocks : Order::kFlat};
  const uint64_t hits = draw_tiles(options.threads, task, painter, space, &done);
  if (counts != nullptr) {
    counts->rays += static_cast<uint64_t>(camera.width_px()) * static_cast<uint64_t>(band.rows);
    counts->hits += hits;
    counts->node_visits += done.counts.nodes;
  }
  if (stats != nullptr) {
    *stats = done;
  }
  return Status::kOk;
}

}  // namespace thimble::wide
