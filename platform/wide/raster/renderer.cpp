#include "wide/raster/renderer.h"

#include "thimble/light/host/asked.h"
#include "wide/raster/cost_model.h"
#include "wide/raster/parallel_frame.h"

namespace thimble::wide {

static_assert(kMaxPicturePx <= 1 << kPlaceBits);

namespace {

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
