#include "wide/renderer.h"

#include "wide/choice.h"
#include "wide/crew.h"

namespace thimble::wide {
namespace {

// From so many boxes on, in the order of the list, up to kMostCopies threads draw a picture each. Fewer are
// drawn in the time that merging the pictures takes.
constexpr size_t kCopyBoxes = 150000;

Status check(const VoxelLists& lists, const Camera& camera, const Band& band, Bytes workspace, int threads) {
  const int32_t width = camera.width_px();
  if (width == 0 || camera.level() != lists.tree().level() || band.first_row < 0 || band.rows < 0 ||
      band.rows > camera.height_px() - band.first_row) {
    return Status::kBadArgument;
  }
  const int32_t multiple = band_row_multiple(band.format);
  const bool ends = band.first_row + band.rows == camera.height_px();
  if (band.first_row % multiple != 0 || (!ends && band.rows % multiple != 0)) {
    return Status::kBadArgument;
  }
  const size_t line_bytes = row_bytes(band.format, width);
  const size_t stride = band.stride_bytes == 0 ? line_bytes : band.stride_bytes;
  if (stride < line_bytes) {
    return Status::kBadArgument;
  }
  if (band.rows == 0) {
    return Status::kOk;
  }
  if (line_bytes > band.pixels.size ||
      row_place(band.format, whole_rows(band.format, band.rows)) - 1 >
          (band.pixels.size - line_bytes) / stride ||
      workspace.size < workspace_bytes(width, band.rows, threads)) {
    return Status::kOutOfMemory;
  }
  return lists.entries().size > size_t{1} << kEntryBits ? Status::kTooFine : Status::kOk;
}

// How a frame is drawn.
struct Plan {
  Order order;
  bool copies;  // whether each thread draws a picture of its own
  Outlook outlook;
};

Plan plan_of(const VoxelLists& lists, const WideFrame& frame, Order wanted, int threads) {
  Plan plan{wanted, false, {}};
  if (wanted == Order::kAuto || threads > 1) {
    plan.outlook = outlook_of(lists, frame, threads > 1);
  }
  if (wanted == Order::kAuto) {
    plan.order = plan.outlook.blocks_pay ? Order::kBlocks : Order::kFlat;
  }
  plan.copies = threads > 1 && threads <= kMostCopies && plan.order != Order::kBlocks &&
                lists.entries().size >= kCopyBoxes;
  return plan;
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
  const Plan plan = plan_of(lists, frame, options.order, threads);
  const bool by_blocks = plan.order == Order::kBlocks;
  const TilePainter painter(lists, camera, shading, band);
  const Workspace space(workspace, {camera.width_px(), band.first_row, band.rows, threads,
                                    plan.copies ? threads : 1, by_blocks, painter.gray_scale(), &shading});
  const TileDrawer::Task task{lists, frame, by_blocks};
  const Crew crew(options.threads, task, painter, space);
  uint64_t hits = 0;
  uint32_t splits = 0;
  if (plan.copies) {
    hits = crew.draw_copies();
  } else {
    hits = crew.draw_tiles(Tiles(band.rows, threads, by_blocks ? plan.outlook.blocks : plan.outlook.flat),
                           &splits);
  }
  const Counts done = crew.counts();
  if (counts != nullptr) {
    counts->rays += static_cast<uint64_t>(camera.width_px()) * static_cast<uint64_t>(band.rows);
    counts->hits += hits;
    counts->node_visits += done.nodes;
  }
  if (stats != nullptr) {
    *stats = {done, plan.order, splits};
  }
  return Status::kOk;
}

}  // namespace thimble::wide
